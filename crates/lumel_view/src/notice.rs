//! Messages to the user.

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Something was done.
    Info,
    /// Something was left out, or is not possible now.
    Warning,
    /// Something failed.
    Error,
}

/// A message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// How bad it is.
    pub level: Level,
    /// The message: what, where, what to do.
    pub text: String,
}

/// All messages, and those that have not been shown yet.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    log: Vec<Notice>,
    fresh: Vec<Notice>,
}

/// More lines than this are forgotten, oldest first: a broken file can have one for each of its faces.
const MAX_LOG: usize = 2000;

impl Notices {
    /// Shows a message and keeps it in the log.
    pub fn push(&mut self, level: Level, text: impl Into<String>) {
        let notice = Notice { level, text: text.into() };
        self.fresh.push(notice.clone());
        self.keep(notice);
    }

    /// Keeps a message in the log only.
    pub fn log(&mut self, level: Level, text: impl Into<String>) {
        self.keep(Notice { level, text: text.into() });
    }

    fn keep(&mut self, notice: Notice) {
        self.log.push(notice);
        if self.log.len() > MAX_LOG {
            self.log.remove(0);
        }
    }

    /// All messages, oldest first.
    pub fn all(&self) -> &[Notice] {
        &self.log
    }

    /// The messages since the last call.
    pub fn take_fresh(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.fresh)
    }

    /// Empties the log.
    pub fn clear(&mut self) {
        self.log.clear();
    }
}
