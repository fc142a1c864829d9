//! The scattered points that carry light, as dots with rings.

use crate::point_light::PointIllumination;
use crate::prefs::{NodeColors, ViewPrefs};
use glam::Vec3;
use lumel_basis::CloudPoint;
use lumel_render_cpu::{Scale, false_color};
use lumel_render_gpu::Mark;
use lumel_scene::luminance;

/// At most this many dots: more cannot be told apart.
const MOST_DOTS: usize = 400_000;

/// At most this many rings: more would cover everything.
const MOST_RINGS: usize = 100;

/// Corners of a ring.
const CORNERS: usize = 32;

/// Opacity of rings.
const RING: u8 = 110;

/// The colours of levels, from the coarsest on: they recur.
const LEVELS: [[u8; 3]; 6] =
    [[240, 90, 70], [250, 180, 60], [120, 210, 110], [80, 180, 240], [180, 130, 250], [240, 130, 200]];

/// What each colour of coefficients stands for, over the largest of all.
const SHARES: [f32; 2] = [1e-3, 1.0];

/// Dots and lines of the levels that are shown.
pub(super) fn marks(light: &PointIllumination, view: &ViewPrefs) -> (Vec<Mark>, Vec<[Mark; 2]>) {
    let values = match view.nodes {
        NodeColors::Hidden => return (Vec::new(), Vec::new()),
        NodeColors::Level => None,
        NodeColors::Coefficient => Some(light.select(view.selection)),
    };
    let size = |value: &Vec3| luminance(value.abs());
    let largest = values.iter().flatten().map(size).fold(f32::MIN_POSITIVE, f32::max);
    let color = |i: usize, point: &CloudPoint| match &values {
        None => LEVELS[point.level as usize % LEVELS.len()],
        Some(values) => false_color(Scale::Log.position(size(&values[i]) / largest, SHARES)),
    };
    let last = light.cloud.level_count().saturating_sub(1).min(view.finest_level);
    let shown = || light.cloud.points().iter().enumerate().filter(|(_, point)| point.level <= last);
    let step = shown().count().div_ceil(MOST_DOTS).max(1);
    let dot = |(i, point): (usize, &CloudPoint)| {
        let [r, g, b] = color(i, point);
        Mark { position: point.position, color: [r, g, b, u8::MAX] }
    };
    let finest = || shown().filter(|(_, point)| point.level == last);
    let step_of_rings = finest().count().div_ceil(MOST_RINGS).max(1);
    let rings = finest().step_by(step_of_rings).flat_map(|(i, point)| ring(point, color(i, point)));
    let mut dots: Vec<Mark> = shown().step_by(step).map(dot).collect();
    // Of coarse levels there are few: they come last, above the others.
    dots.reverse();
    (dots, rings.collect())
}

/// A circle as far as a point reaches, on its surface.
fn ring(point: &CloudPoint, [r, g, b]: [u8; 3]) -> Vec<[Mark; 2]> {
    let (across, along) = point.normal.any_orthonormal_pair();
    let corner = |k: usize| {
        let (sin, cos) = (360.0 * k as f32 / CORNERS as f32).to_radians().sin_cos();
        let position = point.position + point.radius * (across * cos + along * sin);
        Mark { position, color: [r, g, b, RING] }
    };
    (0..CORNERS).map(|k| [corner(k), corner(k + 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_basis::PointCloud;
    use std::sync::Arc;

    fn light() -> PointIllumination {
        let point = |i: u32| CloudPoint {
            position: Vec3::X * i as f32,
            normal: Vec3::Y,
            radius: if i < 2 { 2.0 } else { 1.0 },
            level: u32::from(i >= 2),
        };
        let cloud = Arc::new(PointCloud::new((0..6).map(point).collect()));
        let values = [8.0, 1.0, 0.1, 0.0, -0.1, 0.1].map(Vec3::splat).to_vec();
        PointIllumination { bounces: vec![Arc::new(values)], ..PointIllumination::new(cloud) }
    }

    #[test]
    fn points_of_the_levels_that_are_shown_are_dots_and_the_finest_have_rings() {
        let view = |nodes, finest_level| ViewPrefs { nodes, finest_level, ..ViewPrefs::default() };
        assert_eq!(marks(&light(), &view(NodeColors::Hidden, u32::MAX)), (vec![], vec![]));
        let (dots, rings) = marks(&light(), &view(NodeColors::Level, u32::MAX));
        assert_eq!((dots.len(), rings.len()), (6, 4 * CORNERS));
        assert!(dots[0].color != dots[5].color && dots[3].color == dots[0].color);
        let (dots, rings) = marks(&light(), &view(NodeColors::Level, 0));
        assert_eq!((dots.len(), rings.len()), (2, 2 * CORNERS));
        let far = rings[0][0].position.distance(Vec3::ZERO);
        assert!((far - 2.0).abs() < 1e-5 && rings[0][0].position.y == 0.0, "{far}");
    }

    #[test]
    fn coefficients_have_colours_by_their_size_of_either_sign() {
        let view = ViewPrefs { nodes: NodeColors::Coefficient, ..ViewPrefs::default() };
        let (dots, _) = marks(&light(), &view);
        assert_eq!(dots[3].color, dots[1].color);
        assert!(dots[5].color != dots[4].color && dots[2].color != dots[3].color);
    }
}
