//! What the renderer's lumels hold.

use crate::document::Document;
use crate::layout::{Layout, LayoutKey};
use crate::lumel_light::LumelIllumination;
use crate::lumel_values::of_lumels;
use crate::prefs::ViewMode;
use crate::relief::has_normal_maps;
use crate::selection::Selection;
use crate::session::Session;
use glam::Vec3;
use lumel::Directional;
use lumel_render_gpu::{LumelBuffer, RenderError, Renderer, Tile};
use std::sync::Arc;

/// What the lumels are: equal ones need no new upload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LumelContent {
    layout: LayoutKey,
    /// Changes with the light; 0 for what does not depend on it.
    generation: u64,
    mode: ViewMode,
    selection: Selection,
}

impl LumelContent {
    /// What a mode shows of a part of the light; `None` where it shows vertices.
    pub(super) fn new(session: &Session, mode: ViewMode, selection: Selection) -> Option<Self> {
        let layout = session.layout()?.key;
        let generation = session.lumel_generation;
        match mode {
            ViewMode::Moment(moment) => {
                let known = session.lumel_light()?.directional();
                let is_known = selection.is_all() && moment.is_in(known);
                is_known.then_some(Self { layout, generation, mode, selection })
            }
            ViewMode::Albedo
            | ViewMode::Normals
            | ViewMode::Unshot
            | ViewMode::TriangleSize
            | ViewMode::Bends => None,
            ViewMode::Final | ViewMode::Irradiance | ViewMode::FalseColor => {
                session.lumel_light()?;
                // They differ in how they show the same.
                Some(Self { layout, generation, mode: ViewMode::Final, selection })
            }
            ViewMode::StandardError => {
                session.lumel_light()?.lightmap()?;
                Some(Self { layout, generation, mode, selection: Selection::All })
            }
            ViewMode::Validity => Some(Self { layout, generation, mode, selection: Selection::All }),
            ViewMode::LumelDensity | ViewMode::Chequerboard | ViewMode::Charts | ViewMode::Seams => {
                Some(Self { layout, generation: 0, mode, selection: Selection::All })
            }
        }
    }

    /// Whether it is light, or an error of it, which changes smoothly from lumel to lumel.
    pub(super) fn is_smooth(&self) -> bool {
        matches!(self.mode, ViewMode::Final | ViewMode::StandardError | ViewMode::Moment(_))
    }
}

/// Lumels on the device.
pub(super) struct ShownLumels {
    layout: Arc<Layout>,
    pub(super) buffer: LumelBuffer,
    content: Option<LumelContent>,
    /// By lumel of all pages.
    values: Vec<Option<Vec3>>,
    /// The generation of the lumels whose light by direction the buffer has, if it was asked for.
    directions: Option<u64>,
}

/// Columns and rows of the tiles that are uploaded at once.
const TILE: usize = 64;

impl ShownLumels {
    pub(super) fn new(renderer: &Renderer, layout: &Arc<Layout>) -> Result<Self, RenderError> {
        let atlas = &layout.lumels.atlas;
        let buffer = renderer.lumels(atlas)?;
        let values = vec![None; atlas.lumel_count()];
        Ok(Self { layout: Arc::clone(layout), buffer, content: None, values, directions: None })
    }

    /// Where its lumels lie.
    pub(super) fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// The values that are known.
    pub(super) fn known(&self) -> Vec<Vec3> {
        self.values.iter().flatten().copied().collect()
    }

    /// Uploads what has changed. Returns the number of tiles.
    pub(super) fn fill(&mut self, renderer: &Renderer, session: &Session, content: &LumelContent) -> u64 {
        if self.content.as_ref() == Some(content) {
            return 0;
        }
        self.content = Some(*content);
        let n = self.values.len();
        let values = of_lumels(session, content.mode, content.selection).unwrap_or_else(|| vec![None; n]);
        let tiles = changed_tiles(self.layout.lumels.atlas.pages(), &self.values, &values);
        for (tile, lumels) in &tiles {
            renderer.set_lumels(&self.buffer, tile, lumels.iter().map(|&lumel| values[lumel]));
        }
        self.values = values;
        tiles.len() as u64
    }
}

impl ShownLumels {
    /// Uploads light by direction where it lights something, once the lumels know it. Where the device has no room for
    /// it, that of the vertices is shown.
    pub(super) fn fill_directions(
        &mut self,
        renderer: &Renderer,
        session: &Session,
        content: &LumelContent,
        is_on: bool,
    ) {
        let is_tilted = |document: &Document| has_normal_maps(&document.scene) || !session.rippled.is_empty();
        let is_wanted = is_on && content.mode.is_light() && session.document.as_ref().is_some_and(is_tilted);
        let wanted = is_wanted.then_some(content.generation);
        // Away from light, what is there stays for when one comes back.
        if self.directions == wanted || !content.mode.is_light() {
            return;
        }
        self.directions = wanted;
        let light = session.lumel_light().filter(|_| is_wanted);
        let kind = light.map_or(Directional::Off, LumelIllumination::directional);
        if kind != self.buffer.directional() && renderer.begin_lumel_moments(&mut self.buffer, kind).is_err()
        {
            return;
        }
        let Some(values) = light.and_then(|light| light.by_direction(Selection::All)) else { return };
        let mut first = 0;
        for (page, &size) in self.layout.lumels.atlas.pages().iter().enumerate() {
            let count = size[0] as usize * size[1] as usize;
            let tile = Tile { page, min: [0, 0], size };
            renderer.set_lumel_moments(&self.buffer, &tile, values[first..first + count].iter().copied());
            first += count;
        }
    }

    /// Bytes that light by direction takes on the device, if it is there.
    pub(super) fn bytes_of_directions(&self) -> Option<u64> {
        let kind = self.buffer.directional();
        (kind != Directional::Off).then(|| self.buffer.bytes_of_moments(kind))
    }
}

/// The tiles of pages that differ, with their lumels row by row.
fn changed_tiles<T: PartialEq>(pages: &[[u32; 2]], old: &[T], new: &[T]) -> Vec<(Tile, Vec<usize>)> {
    let mut changed = Vec::new();
    let mut first = 0;
    for (page, &[width, height]) in pages.iter().enumerate() {
        let [columns, rows] = [width, height].map(|length| length as usize);
        for top in (0..rows).step_by(TILE) {
            for left in (0..columns).step_by(TILE) {
                let (right, bottom) = ((left + TILE).min(columns), (top + TILE).min(rows));
                let row = |y: usize| first + y * columns + left..first + y * columns + right;
                if (top..bottom).any(|y| old[row(y)] != new[row(y)]) {
                    let size = [right - left, bottom - top].map(|length| length as u32);
                    let tile = Tile { page, min: [left as u32, top as u32], size };
                    changed.push((tile, (top..bottom).flat_map(row).collect()));
                }
            }
        }
        first += columns * rows;
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::changed_tiles;

    #[test]
    fn only_tiles_that_differ_are_uploaded() {
        let pages = [[100, 70], [64, 64]];
        let old = vec![0; 100 * 70 + 64 * 64];
        assert!(changed_tiles(&pages, &old, &old).is_empty());
        let mut new = old.clone();
        new[69 * 100 + 99] = 1;
        new[7000] = 2;
        let tiles = changed_tiles(&pages, &old, &new);
        let places: Vec<_> = tiles.iter().map(|(tile, _)| (tile.page, tile.min, tile.size)).collect();
        assert_eq!(places, [(0, [64, 64], [36, 6]), (1, [0, 0], [64, 64])]);
        assert_eq!(tiles[0].1.last(), Some(&(69 * 100 + 99)));
        assert_eq!(tiles[1].1[..3], [7000, 7001, 7002]);
    }
}
