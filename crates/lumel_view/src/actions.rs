//! The queue of actions that panels and dialogs request.
//!
//! They change the session and the preferences directly. What concerns the window as a whole goes into this queue, which
//! the app empties after drawing: so no part needs to know the app.

use crate::dock::Pane;
use crate::document::OpenRequest;
use crate::input::Command;

/// Something for the app to do.
#[derive(Clone, Debug)]
pub enum Action {
    /// A command of the table of keys.
    Run(Command),
    /// Open a scene, after asking if work would be lost.
    Open(OpenRequest),
    /// Bring a panel to the front.
    ShowPanel(Pane),
    /// Arrange the panels as they were at first.
    ArrangePanels,
}

impl From<Command> for Action {
    fn from(command: Command) -> Self {
        Self::Run(command)
    }
}

/// The requested actions, in order.
#[derive(Debug, Default)]
pub struct Actions(Vec<Action>);

impl Actions {
    /// Requests an action.
    pub fn push(&mut self, action: impl Into<Action>) {
        self.0.push(action.into());
    }

    /// Takes all actions requested since the last call.
    pub fn take(&mut self) -> Vec<Action> {
        std::mem::take(&mut self.0)
    }
}
