//! A grid on the ground of open scenes, for a sense of size.

use lumel::Scene;
use lumel_render_gpu::Mark;

/// How far the grid reaches, in diagonals of the scene.
const REACH: f32 = 1.5;
/// Lines from the middle to an edge, at most.
const LINES: f32 = 24.0;
/// How far below the scene it lies, in diagonals: a floor is not drawn over.
const BELOW: f32 = 0.004;
/// Opacity of lines in the middle, and of every tenth.
const ALPHA: [f32; 2] = [70.0, 130.0];

/// Lines on the lowest level of a scene, a power of ten metres apart, that fade to all sides.
pub(super) fn grid(scene: &Scene) -> Vec<[Mark; 2]> {
    let (bounds, origin) = (scene.bounds(), scene.origin());
    let diagonal = bounds.diagonal();
    let reach = REACH * diagonal;
    if !(reach > 0.0 && reach.is_finite()) {
        return Vec::new();
    }
    let step = 10_f64.powf(f64::from(reach / LINES).log10().ceil());
    let (middle, height) = (bounds.center(), bounds.min.y - BELOW * diagonal);
    let mut lines = Vec::new();
    for (across, along) in [(0, 2), (2, 0)] {
        let world = origin[across] + f64::from(middle[across]);
        let first = ((world - f64::from(reach)) / step).ceil() as i64;
        let last = ((world + f64::from(reach)) / step).floor() as i64;
        for k in first..=last {
            let offset = (k as f64 * step - origin[across]) as f32 - middle[across];
            let fade = 1.0 - (offset / reach).abs();
            let alpha = (ALPHA[usize::from(k % 10 == 0)] * fade) as u8;
            let mark = |way: f32, alpha: u8| {
                let mut position = middle.with_y(height);
                position[across] += offset;
                position[along] += way;
                Mark { position, color: [200, 205, 215, alpha] }
            };
            let half = reach * fade.sqrt();
            lines.extend([-half, half].map(|end| [mark(0.0, alpha), mark(end, 0)]));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_at_round_places_below_the_scene_and_fade_out() {
        let opened = lumel::open("atrium", &lumel::OpenOptions::default()).unwrap();
        let (scene, _) = opened.builder.build().unwrap();
        let lines = grid(&scene);
        assert!((40..400).contains(&lines.len()), "{}", lines.len());
        let step =
            lines.iter().map(|[a, _]| a.position.x.abs()).filter(|x| *x > 1e-3).fold(f32::MAX, f32::min);
        assert!((step.log10() - step.log10().round()).abs() < 1e-3, "{step}");
        for [a, b] in lines {
            assert!(a.position.y < scene.bounds().min.y && b.color[3] == 0);
            assert!((b.position - a.position).length() <= REACH * scene.bounds().diagonal() * 1.001);
        }
    }
}
