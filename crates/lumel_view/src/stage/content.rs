//! What the renderer's light buffers hold.

use super::points::PointContent;
use crate::prefs::{ViewMode, ViewPrefs};
use crate::selection::{Illumination, Selection};
use crate::session::Session;
use crate::values;
use glam::Vec3;
use lumel::Moment;
use lumel_basis::Coefficients;
use std::borrow::Cow;
use std::sync::Arc;

/// Which light is on one side of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// That of the session.
    Current,
    /// One that was kept, by its id.
    Kept(u64),
    /// That of the session, on surfaces as smooth as their meshes.
    Smooth,
}

/// What the values in a buffer are: equal ones need no new upload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Content {
    document: u64,
    mesh: u64,
    paint: u64,
    light: Version,
    side: Side,
    values: Values,
    selection: Selection,
    /// Whether the ambient term is added.
    ambient: bool,
    /// Whether light at scattered points, which is shown there, is left out.
    beside_points: bool,
}

/// Which light the values come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    /// Bounces that are done: they stay as they are while others are measured.
    Finished(u64),
    /// Light that may still change, by its generation.
    Generation(u64),
}

/// Modes whose buffers hold the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Values {
    Light,
    /// Before there is light: some to see what is there.
    Preview,
    Mode(ViewMode),
}

impl Content {
    /// The picture of a part of the light: what the preferences want to see of it.
    pub(super) fn new(session: &Session, side: Side, view: &ViewPrefs, selection: Selection) -> Self {
        // Colours with a legend are numbers: they have what was computed.
        let ambient = side == Side::Current
            && view.ambient
            && view.mode.is_exposed()
            && selection.contains_tail()
            && session.to_come().is_some();
        Self { ambient, ..Self::of_mode(session, side, view.mode, selection) }
    }

    /// What a mode shows of a part of the light.
    pub(super) fn of_mode(session: &Session, side: Side, mode: ViewMode, selection: Selection) -> Self {
        let light = light_of(session, side);
        let unlit = light.as_ref().is_none_or(|light| light.is_empty()) && side == Side::Current;
        let values = match mode {
            ViewMode::Final | ViewMode::Irradiance if unlit => Values::Preview,
            mode if mode.is_light() => Values::Light,
            mode => Values::Mode(mode),
        };
        let is_done = |last: u32| light.as_ref().is_some_and(|l| (last as usize) < l.bounces.len());
        let version = match (side, selection) {
            (Side::Kept(_), _) | (_, Selection::NONE) => Version::Finished(0),
            // The same until there is light.
            _ if values == Values::Preview => Version::Finished(0),
            (Side::Current, Selection::Range(_, last)) if is_done(last) && values == Values::Light => {
                Version::Finished(session.light.id)
            }
            (Side::Current | Side::Smooth, _) => Version::Generation(session.light_generation),
        };
        let (document, mesh) = (session.document_generation, session.mesh_generation);
        let paint = session.paint_generation;
        Self {
            document,
            mesh,
            paint,
            light: version,
            side,
            values,
            selection,
            ambient: false,
            beside_points: false,
        }
    }

    /// The same without what scattered points show, if they do.
    pub(super) fn beside(self, points: Option<&PointContent>) -> Self {
        Self { beside_points: points.is_some() && self.is_light(), ..self }
    }

    /// Whether it is light, of which there can be two side by side.
    pub(super) fn is_light(&self) -> bool {
        self.values == Values::Light
    }

    /// Whether it stands in for light that is not there yet.
    pub(super) fn is_preview(&self) -> bool {
        self.values == Values::Preview
    }

    /// Whether both are the same part of a light, which may have grown or changed with the materials meanwhile.
    pub(super) fn shows_the_same_as(&self, other: &Self) -> bool {
        *self == Self { light: self.light, mesh: self.mesh, paint: self.paint, ..*other }
    }

    /// Whether it can no longer change.
    pub(super) fn is_finished(&self) -> bool {
        matches!(self.light, Version::Finished(_))
    }

    /// The values, one for each vertex; `None` when nothing is open.
    pub(super) fn values(&self, session: &Session) -> Option<Vec<Vec3>> {
        let scene = &session.document.as_ref()?.scene;
        let light = light_of(session, self.side).unwrap_or_default();
        let light = &*light;
        let values = match self.values {
            Values::Light => {
                let n = scene.vertex_count();
                let mut sum = match self.beside_points {
                    true => light.select_beside_points(self.selection, n),
                    false => light.select(self.selection, n),
                };
                if let Some(unshot) = session.to_come().filter(|_| self.ambient) {
                    unshot.add_to(&mut sum);
                }
                Some(sum)
            }
            Values::Preview => Some(values::preview(scene)),
            Values::Mode(ViewMode::Unshot) => session.unshot().map(|unshot| unshot.radiosity.to_vec()),
            Values::Mode(ViewMode::Bends) => {
                session.document.as_ref()?.indicator.as_ref().map(|indicator| indicator.to_vec())
            }
            Values::Mode(mode) => values::of_vertices(mode, scene, light, self.selection),
        };
        // What is not known is dark.
        Some(values.unwrap_or_else(|| vec![Vec3::splat(0.05); scene.vertex_count()]))
    }

    /// Whether a moment of the light is known at the vertices.
    pub(super) fn knows(&self, moment: Moment, session: &Session) -> bool {
        let n = session.document.as_ref().map_or(0, |document| document.scene.vertex_count());
        let light = light_of(session, self.side);
        light.is_some_and(|light| {
            light.select_directional(self.selection, n).is_some_and(|known| moment.is_in(known.kind()))
        })
    }

    /// The light by direction, where light is shown and that is known: it lights normal maps.
    pub(super) fn directional(&self, session: &Session) -> Option<Arc<Coefficients>> {
        let n = session.document.as_ref()?.scene.vertex_count();
        let light = light_of(session, self.side).filter(|_| self.is_light())?;
        light.select_directional(self.selection, n).cloned()
    }
}

fn light_of(session: &Session, side: Side) -> Option<Cow<'_, Illumination>> {
    match side {
        Side::Current | Side::Smooth => Some(Cow::Borrowed(&session.light)),
        Side::Kept(id) => {
            let kept = session.kept.iter().find(|kept| kept.id == id)?;
            Some(kept.light_on(&session.document.as_ref()?.scene))
        }
    }
}
