//! Cameras that have all of a scene in the picture.

use crate::viewpoint::NAME;
use glam::Vec3;
use lumel_scene::{Camera, Scene};

/// The part of the picture's width and height that the scene fills.
const FILLED: f32 = 0.9;

/// The camera that looks along `forward`, stands as near as all vertices fit into the picture, and has them in the
/// middle of its longer side.
///
/// With `f`, `u` the axes of the camera and `t` the tangent of half its field of view, a point `p` is in the picture if
/// `|(p − c)·u| ≤ t (p − c)·f`. With `a± = max(t⁻¹ (±p·u) − p·f)` over all points, the nearest camera that holds the
/// topmost and the lowest of them has `c·u = t (a₊ − a₋)/2` and `c·f = −(a₊ + a₋)/2`; the width likewise.
pub(crate) fn framed(scene: &Scene, forward: Vec3, fov_y: f32, aspect: f32) -> Camera {
    let middle = scene.bounds().center();
    let camera = Camera { forward, ..Camera::looking_at(NAME, middle, middle, fov_y) };
    let Some([right, up, ahead]) = camera.axes() else { return camera };
    let t_up = FILLED * (0.5 * fov_y).tan();
    let (across, width) = fit(scene, middle, right, ahead, t_up * aspect);
    let (along, height) = fit(scene, middle, up, ahead, t_up);
    // Flat scenes that are seen edge on need some distance, too.
    let back = width.max(height).max(1e-3 * scene.bounds().diagonal()).max(1e-6);
    Camera { position: middle + across * right + along * up - back * ahead, ..camera }
}

/// Where a camera is along `axis`, and how far behind `middle`.
fn fit(scene: &Scene, middle: Vec3, axis: Vec3, ahead: Vec3, t: f32) -> (f32, f32) {
    let reach = |p: &Vec3| {
        let d = *p - middle;
        let (side, depth) = (d.dot(axis) / t, d.dot(ahead));
        [side - depth, -side - depth]
    };
    let farthest = |[a, b]: [f32; 2], [c, d]: [f32; 2]| [a.max(c), b.max(d)];
    let [plus, minus] = scene.positions().iter().map(reach).reduce(farthest).unwrap_or([0.0; 2]);
    (0.5 * t * (plus - minus), 0.5 * (plus + minus))
}
