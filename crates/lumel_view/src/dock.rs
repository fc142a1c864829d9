//! The layout of the panels, which can be dragged.

use eframe::egui::Id;
use egui_tiles::{Container, Linear, LinearDir, SimplificationOptions, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pane {
    /// The picture.
    View,
    /// Settings and progress of the solve.
    Solve,
    /// The lights.
    Lights,
    /// How the picture is drawn.
    Display,
    /// The camera and the slots.
    Camera,
    /// Two solutions side by side.
    Compare,
    /// What the scene consists of.
    Scene,
    /// The terms of the series, bounce by bounce, as pictures.
    Operator,
    /// The pages of the lightmap.
    Atlas,
    /// Energy by bounce.
    Convergence,
    /// Messages.
    Log,
}

impl Pane {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::View,
        Self::Solve,
        Self::Lights,
        Self::Display,
        Self::Camera,
        Self::Compare,
        Self::Scene,
        Self::Operator,
        Self::Atlas,
        Self::Convergence,
        Self::Log,
    ];

    /// The text on its tab.
    pub fn title(self) -> &'static str {
        match self {
            Self::View => "View",
            Self::Solve => "Solve",
            Self::Lights => "Lights",
            Self::Display => "Display",
            Self::Camera => "Camera",
            Self::Compare => "Compare",
            Self::Scene => "Scene",
            Self::Operator => "Bounces",
            Self::Atlas => "Atlas",
            Self::Convergence => "Convergence",
            Self::Log => "Log",
        }
    }
}

/// Tells the dock from other widgets.
pub fn id() -> Id {
    Id::unique("dock")
}

/// The arrangement one starts with: the picture, tools right of it, what the solve does below.
pub fn default_tree() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let view = tiles.insert_pane(Pane::View);
    let mut tabs = |panes: &[Pane]| {
        let children = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
        tiles.insert_tab_tile(children)
    };
    let bottom = tabs(&[Pane::Operator, Pane::Atlas, Pane::Convergence, Pane::Log]);
    // Together, so that each has the whole height: half of it cuts settings off in a small window.
    let right = tabs(&[Pane::Solve, Pane::Lights, Pane::Display, Pane::Camera, Pane::Scene, Pane::Compare]);
    let linear = |tiles: &mut Tiles<Pane>, dir, parts: &[(TileId, f32)]| {
        let mut linear = Linear::new(dir, parts.iter().map(|(id, _)| *id).collect());
        parts.iter().for_each(|(id, share)| linear.shares.set_share(*id, *share));
        tiles.insert_new(Tile::Container(Container::Linear(linear)))
    };
    let left = linear(&mut tiles, LinearDir::Vertical, &[(view, 4.0), (bottom, 1.15)]);
    let root = linear(&mut tiles, LinearDir::Horizontal, &[(left, 2.4), (right, 1.0)]);
    Tree::new(id(), root, tiles)
}

/// Whether a stored layout has every panel; one of a different version may not.
pub fn is_whole(tree: &Tree<Pane>) -> bool {
    let has = |pane: &Pane| tree.tiles.find_pane(pane).is_some();
    tree.root.is_some() && Pane::ALL.iter().all(has)
}

/// Brings a panel to the front of its tabs.
pub fn focus(tree: &mut Tree<Pane>, pane: Pane) {
    tree.make_active(|_, tile| matches!(tile, Tile::Pane(p) if *p == pane));
}

/// Panels without neighbours need no tabs, and nothing else is tidied away.
pub fn simplification() -> SimplificationOptions {
    SimplificationOptions { all_panes_must_have_tabs: false, ..SimplificationOptions::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_has_every_panel_and_survives_storage() {
        let tree = default_tree();
        assert!(is_whole(&tree));
        let text = serde_json::to_string(&tree).unwrap();
        assert!(is_whole(&serde_json::from_str(&text).unwrap()));
        assert!(!is_whole(&Tree::empty(id())));
    }
}
