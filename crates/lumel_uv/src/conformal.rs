//! Charts by `uvunwrap`: the only file that knows it.

use crate::chart::{Chart, signed_area};
use crate::patches::{is_flat, patches};
use crate::planar::{self, lies_on_itself};
use crate::topology::{NONE, Topology};
use crate::{Pace, UvError};
use glam::{DVec2, Vec3};
use lumel_scene::{Scene, TriId};
use std::collections::BTreeMap;
use uvunwrap::{Density, Error, MeshInput, Options, Packing, generate_with_progress};

/// Above this many triangles, or parts that no edge connects, its time grows faster than the mesh.
const MOST_TRIANGLES: usize = 2_000_000;
const MOST_PARTS: usize = 20_000;

/// Curved surfaces are flattened in patches of up to this many triangles. Bathroom, 380,280 triangles in 851 objects:
/// 61 s without patches, 15 s with them, for 3 % more charts.
const MOST_AT_ONCE: usize = 1500;

/// It places charts on a page of about this many units, which leaves coordinates of 32 bits enough digits.
const PAGE_AREA: f64 = 1e6;

/// How far the normals of a chart may turn from their mean, degrees. More makes fewer charts that are less true.
const MOST_TURNED_DEG: f32 = 60.0;

/// By which factor areas in a chart may differ from the mean.
const MOST_STRETCHED: f32 = 1.5;

/// What became of an object.
pub(crate) enum Result {
    /// Charts, and the triangles that have none because they are too thin.
    Charts(Vec<Chart>, Vec<u32>),
    /// Why there are no charts.
    Refused(String),
}

/// Charts of an object, on curved surfaces fewer than those that are projected.
///
/// Nothing is taken on trust: a chart with a triangle that is mirrored, not finite or on top of another one refuses all.
pub(crate) fn charts(
    scene: &Scene,
    topology: &Topology,
    pace: &(dyn Fn() -> Pace + Sync),
) -> std::result::Result<Result, UvError> {
    if topology.len() > MOST_TRIANGLES {
        return Ok(Result::Refused(format!("it has more than {MOST_TRIANGLES} triangles")));
    }
    let parts = topology.parts();
    if parts.len() > MOST_PARTS {
        return Ok(Result::Refused(format!("it has more than {MOST_PARTS} parts")));
    }
    let area: f64 = (0..topology.len() as u32).map(|face| f64::from(scene.area(topology.tri(face)))).sum();
    let density = (PAGE_AREA / area.max(f64::MIN_POSITIVE)).sqrt() as f32;
    if !(density > 0.0 && density.is_finite()) {
        return Ok(Result::Refused("it has no area".to_owned()));
    }
    let positions: Vec<[f32; 3]> = topology.positions.iter().map(Vec3::to_array).collect();
    let mut is_free = vec![true; topology.len()];
    let flat: Vec<u32> = parts.into_iter().filter(|part| is_flat(scene, topology, part)).flatten().collect();
    flat.iter().for_each(|&face| is_free[face as usize] = false);
    let flat = planar::charts(scene, topology, &flat);
    if !is_free.contains(&true) {
        return Ok(Result::Charts(flat, Vec::new()));
    }
    let patch = patches(topology, &is_free, MOST_AT_ONCE);
    let ignored: Vec<bool> = is_free.iter().map(|is| !is).collect();
    let ends = |from: u32, other: u32| other == NONE || patch[other as usize] != from;
    let seams: Vec<[bool; 3]> =
        topology.across.iter().zip(&patch).map(|(a, &from)| a.map(|other| ends(from, other))).collect();
    let mesh = MeshInput {
        seams: Some(&seams),
        ignored_faces: Some(&ignored),
        ..MeshInput::new(&positions, topology.corners.as_flattened())
    };
    let options = Options {
        max_chart_angle: MOST_TURNED_DEG,
        max_area_distortion: MOST_STRETCHED,
        density: Density::Fixed { texels_per_unit: density, page_size: None },
        padding: 0,
        packing: Packing::Fast,
        ..Options::default()
    };
    match generate_with_progress(&[mesh], &options, |_| pace() == Pace::Go) {
        Ok(atlas) => Ok(take(topology, &atlas, density, &is_free, flat)),
        Err(Error::Cancelled) if pace() == Pace::Stop => Err(UvError::Stopped),
        Err(Error::Cancelled) => Ok(Result::Refused("time was up".to_owned())),
        Err(error) => Ok(Result::Refused(error.to_string())),
    }
}

fn take(
    topology: &Topology,
    atlas: &uvunwrap::Atlas,
    density: f32,
    is_free: &[bool],
    mut found: Vec<Chart>,
) -> Result {
    let Some(mesh) = atlas.meshes.first().filter(|mesh| mesh.indices.len() == 3 * topology.len()) else {
        return Result::Refused("it was returned with other triangles".to_owned());
    };
    let size = DVec2::new(f64::from(atlas.width), f64::from(atlas.height)) / f64::from(density);
    let mut charts: BTreeMap<u32, (Vec<TriId>, Vec<[DVec2; 3]>)> = BTreeMap::new();
    let mut without = Vec::new();
    for (face, corners) in mesh.indices.as_chunks::<3>().0.iter().enumerate() {
        let vertices = corners.map(|corner| &mesh.vertices[corner as usize]);
        let flat = vertices.map(|vertex| DVec2::from(vertex.uv.map(f64::from)) * size);
        let [a, b, c] = vertices.map(|vertex| vertex.chart);
        match a.filter(|_| is_free[face] && a == b && b == c && signed_area(flat) > 0.0) {
            Some(chart) => {
                let (triangles, corners) = charts.entry(chart).or_default();
                triangles.push(topology.tri(face as u32));
                corners.push(flat);
            }
            None if is_free[face] => without.push(face as u32),
            None => {}
        }
    }
    if let Some(chart) = charts.values().find(|(_, corners)| !is_sound(corners)) {
        return Result::Refused(format!("a chart of {} triangles lies on itself", chart.0.len()));
    }
    let charts = charts.into_values();
    let charts = charts.map(|(triangles, corners)| Chart::new(topology.object, triangles, &corners));
    found.extend(charts);
    Result::Charts(found, without)
}

fn is_sound(corners: &[[DVec2; 3]]) -> bool {
    corners.iter().flatten().all(|corner| corner.is_finite()) && !lies_on_itself(corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene_of;
    use lumel_testkit::mesh::{Facing, sphere};

    #[test]
    fn a_sphere_has_few_charts_that_hold_all_of_it() {
        let scene = scene_of(vec![sphere(Vec3::ZERO, 1.0, 4, Facing::Outward, 0)]);
        let topology = Topology::new(&scene, 0..scene.traced_count() as u32);
        let Ok(Result::Charts(charts, without)) = charts(&scene, &topology, &|| Pace::Go) else {
            panic!("refused")
        };
        assert!(without.is_empty() && charts.len() < 20, "{}", charts.len());
        let area: f64 = charts.iter().map(|chart| chart.area).sum();
        let whole: f64 = (0..topology.len() as u32).map(|f| f64::from(scene.area(topology.tri(f)))).sum();
        assert!((area / whole - 1.0).abs() < 0.05, "{area} {whole}");
    }

    #[test]
    fn time_that_is_up_refuses_and_stop_stops() {
        let scene = scene_of(vec![sphere(Vec3::ZERO, 1.0, 2, Facing::Outward, 0)]);
        let topology = Topology::new(&scene, 0..scene.traced_count() as u32);
        assert!(matches!(charts(&scene, &topology, &|| Pace::Hurry), Ok(Result::Refused(_))));
        assert!(matches!(charts(&scene, &topology, &|| Pace::Stop), Err(UvError::Stopped)));
    }
}
