//! What the lumels of the picture hold: light, or numbers about the lightmap.

use crate::layout::Layout;
use crate::prefs::ViewMode;
use crate::selection::Selection;
use crate::session::Session;
use crate::values::{INVALID, UNKNOWN, VALID};
use glam::Vec3;
use lumel_export::chart_color;
use lumel_uv::{Atlas, Coverage};

/// Colour of lumels that are read along seams, linear.
const SEAM: Vec3 = Vec3::new(1.0, 0.3, 0.02);

/// Colours of the squares of a chequerboard, linear.
const CHEQUERS: [f32; 2] = [0.16, 0.6];

/// Lumels along a side of its squares; each lumel is told from the next by a shade.
const SQUARE: u32 = 8;

/// One value for each lumel of all pages, for a way of looking at the scene; `None` where there is nothing to show, and then
/// for each of which nothing is known.
pub fn of_lumels(session: &Session, mode: ViewMode, selection: Selection) -> Option<Vec<Option<Vec3>>> {
    let layout = session.layout()?;
    match mode {
        ViewMode::Final | ViewMode::Irradiance | ViewMode::FalseColor => {
            session.lumel_light().map(|light| light.select(selection))
        }
        ViewMode::StandardError => session.lumel_light()?.errors(),
        ViewMode::Moment(moment) => {
            let light = session.lumel_light()?.by_direction(selection)?;
            Some(light.iter().map(|light| Some(moment.of(light))).collect())
        }
        ViewMode::Albedo
        | ViewMode::Normals
        | ViewMode::Unshot
        | ViewMode::TriangleSize
        | ViewMode::Bends => None,
        ViewMode::Validity => {
            let light = session.lumel_light();
            Some(covered(layout, |place, _| {
                let color = match light.and_then(|light| light.validity(place)) {
                    None => UNKNOWN,
                    Some(true) => VALID,
                    Some(false) => INVALID,
                };
                // What is only read beside the surface is darker.
                let is_beside = layout.lumels.coverage.shares(place)[0].area == 0.0;
                if is_beside { color * 0.5 } else { color }
            }))
        }
        ViewMode::Charts => Some(covered(layout, |place, _| chart_color(chart_of(layout, place)))),
        ViewMode::Chequerboard => {
            let atlas = &layout.lumels.atlas;
            Some(covered(layout, |_, lumel| {
                let (_, [x, y]) = atlas.column_and_row(lumel);
                let is_odd = |side: u32| (x / side + y / side) % 2 == 1;
                Vec3::splat(CHEQUERS[usize::from(is_odd(SQUARE))] * if is_odd(1) { 1.0 } else { 0.8 })
            }))
        }
        ViewMode::LumelDensity => {
            let densities = densities(layout);
            let tri = |place: usize| layout.lumels.coverage.shares(place)[0].tri;
            Some(covered(layout, |place, _| Vec3::splat(densities[tri(place).index()])))
        }
        ViewMode::Seams => {
            let mut values = covered(layout, |_, _| VALID);
            layout.along_seams.iter().for_each(|&lumel| values[lumel as usize] = Some(SEAM));
            Some(values)
        }
    }
}

/// A value for each lumel that is read, by its place in the coverage and by its number.
fn covered(layout: &Layout, value: impl Fn(usize, usize) -> Vec3) -> Vec<Option<Vec3>> {
    let mut values = vec![None; layout.lumels.atlas.lumel_count()];
    for (place, &lumel) in layout.lumels.coverage.lumels().iter().enumerate() {
        values[lumel as usize] = Some(value(place, lumel as usize));
    }
    values
}

fn chart_of(layout: &Layout, place: usize) -> usize {
    let (atlas, coverage): (&Atlas, &Coverage) = (&layout.lumels.atlas, &layout.lumels.coverage);
    atlas.chart(coverage.shares(place)[0].tri)
}

/// Lumels per metre of each triangle: the root of its area on its page over that in the scene.
fn densities(layout: &Layout) -> Vec<f32> {
    let (scene, atlas) = (&layout.lumels.scene, &layout.lumels.atlas);
    let density = |tri| {
        let [a, b, c] = atlas.corners(tri);
        let lumels = 0.5 * (b - a).perp_dot(c - a);
        (lumels / scene.area(tri).max(f32::MIN_POSITIVE)).sqrt()
    };
    (0..scene.triangle_count() as u32).map(|tri| density(lumel_scene::TriId(tri))).collect()
}
