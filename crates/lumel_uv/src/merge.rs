//! Charts that are smaller than a lumel, merged.

use crate::chart::Chart;
use crate::unfold::unfolded;
use glam::{DVec2, DVec3};
use lumel_scene::{ObjectId, Scene};
use std::collections::BTreeMap;

/// Charts narrower than this continue in their neighbours across creases, lumels: reading mixes their light anyway.
const NARROW: f64 = 1.0;

/// Charts up to this long are put side by side with others, lumels. Each alone would take four lumels.
const TINY: f64 = 0.5;

/// Charts are neighbours in a cube of this size, lumels: light varies as little there as within lumels elsewhere.
const NEIGHBOURHOOD: f64 = 1.0;

/// Where a chart is and which way it faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    object: ObjectId,
    cube: [i64; 3],
    /// The axis that its normal is nearest to, and whether it points against it.
    facing: (usize, bool),
}

/// Merges the charts of each object that are smaller than a lumel. `scale`: lumels per metre of a chart.
///
/// Narrow ones are laid out together with their neighbours, as far as all face about the same way. Those that are still tiny
/// are put side by side with others that lie within a lumel and face about the same way: their light is mixed at their
/// borders, as that of a lumel is.
pub(crate) fn merged(scene: &Scene, charts: Vec<Chart>, scale: impl Fn(&Chart) -> f64) -> Vec<Chart> {
    let is_narrow = |chart: &Chart| !chart.is_given() && chart.size.min_element() * scale(chart) < NARROW;
    let mut narrow: BTreeMap<ObjectId, Vec<Chart>> = BTreeMap::new();
    let mut wide = Vec::new();
    for chart in charts {
        if is_narrow(&chart) {
            narrow.entry(chart.object).or_default().push(chart);
        } else {
            wide.push(chart);
        }
    }
    wide.extend(narrow.into_values().flat_map(|charts| unfolded(scene, charts)));
    together(scene, wide, scale)
}

/// Puts tiny charts side by side.
fn together(scene: &Scene, charts: Vec<Chart>, scale: impl Fn(&Chart) -> f64) -> Vec<Chart> {
    let is_tiny = |chart: &Chart| !chart.is_given() && chart.size.max_element() * scale(chart) < TINY;
    let mut origins: BTreeMap<ObjectId, DVec3> = BTreeMap::new();
    for chart in charts.iter().filter(|chart| is_tiny(chart)) {
        let origin = origins.entry(chart.object).or_insert(DVec3::INFINITY);
        *origin = origin.min(center_and_normal(scene, chart).0);
    }
    let mut groups: BTreeMap<Place, Vec<Chart>> = BTreeMap::new();
    let mut found = Vec::with_capacity(charts.len());
    for chart in charts {
        if !is_tiny(&chart) {
            found.push(chart);
            continue;
        }
        let (center, normal) = center_and_normal(scene, &chart);
        let cell = (center - origins[&chart.object]) * scale(&chart) / NEIGHBOURHOOD;
        let axis = normal.abs().to_array();
        let axis = (1..3).fold(0, |best, k| if axis[k] > axis[best] { k } else { best });
        let facing = (axis, normal[axis] < 0.0);
        let cube = cell.floor().to_array().map(|k| k as i64);
        groups.entry(Place { object: chart.object, cube, facing }).or_default().push(chart);
    }
    found.extend(groups.into_values().map(side_by_side));
    found
}

/// The mean place of a chart's surface, and its normal times its area.
fn center_and_normal(scene: &Scene, chart: &Chart) -> (DVec3, DVec3) {
    let (mut center, mut normal, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for &tri in &chart.triangles {
        let [a, b, c] = scene.triangle_positions(tri).map(|p| p.as_dvec3());
        let cross = (b - a).cross(c - a);
        center += (a + b + c) / 3.0 * cross.length();
        normal += cross;
        area += cross.length();
    }
    (center / area.max(f64::MIN_POSITIVE), normal)
}

/// One chart of several, in rows of about equal length.
fn side_by_side(mut charts: Vec<Chart>) -> Chart {
    // The highest first: rows lose little.
    charts.sort_by(|a, b| b.size.y.total_cmp(&a.size.y));
    let area: f64 = charts.iter().map(|chart| chart.size.x * chart.size.y).sum();
    let longest = charts.iter().map(|chart| chart.size.x).fold(area.sqrt(), f64::max);
    let (mut triangles, mut corners) = (Vec::new(), Vec::new());
    let (mut at, mut row) = (DVec2::ZERO, 0.0);
    let object = charts.first().map_or(ObjectId(0), |chart| chart.object);
    for chart in charts {
        if at.x > 0.0 && at.x + chart.size.x > longest {
            at = DVec2::new(0.0, at.y + row);
            row = 0.0;
        }
        corners.extend(chart.corners.iter().map(|t| t.map(|c| c.as_dvec2() + at)));
        triangles.extend(chart.triangles);
        (at.x, row) = (at.x + chart.size.x, f64::max(row, chart.size.y));
    }
    Chart::in_place(object, triangles, &corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlap::overlapping;
    use crate::testing::{cube, scene_of};
    use crate::topology::Topology;
    use crate::{Pace, conformal};

    fn charts_of_two_cubes() -> (Scene, Vec<Chart>) {
        let mut cubes = cube();
        let second = cube();
        let first = cubes.positions.len() as u32;
        cubes.positions.extend(second.positions.iter().map(|p| *p + glam::Vec3::X * 5.0));
        cubes.faces.extend(
            second
                .faces
                .iter()
                .map(|face| lumel_scene::Face { vertices: face.vertices.map(|v| v + first), ..*face }),
        );
        let scene = scene_of(vec![cubes]);
        let topology = Topology::new(&scene, 0..scene.traced_count() as u32);
        let Ok(conformal::Result::Charts(charts, _)) = conformal::charts(&scene, &topology, &|| Pace::Go)
        else {
            panic!("refused")
        };
        (scene, charts)
    }

    #[test]
    fn only_charts_that_are_small_near_and_face_one_way_become_one() {
        let (scene, charts) = charts_of_two_cubes();
        let count = |density: f64| merged(&scene, charts.clone(), |_| density).len();
        // The sides of the one are five metres from those of the other.
        assert_eq!([2.0, 0.6, 0.1].map(count), [12, 12, 6]);
    }

    #[test]
    fn merged_charts_keep_all_triangles_and_do_not_overlap() {
        let (scene, charts) = charts_of_two_cubes();
        let areas = |charts: &[Chart]| charts.iter().map(|chart| chart.area).sum::<f64>();
        let whole = areas(&charts);
        let merged = merged(&scene, charts, |_| 0.1);
        assert!((areas(&merged) - whole).abs() < 1e-6);
        for chart in &merged {
            let corners: Vec<[DVec2; 3]> = chart.corners.iter().map(|t| t.map(|c| c.as_dvec2())).collect();
            assert_eq!((chart.triangles.len(), overlapping(&corners, 1e-3)), (4, vec![]));
        }
    }
}
