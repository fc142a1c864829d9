//! Places on the surfaces of a scene.

use lumel_sample::{PiecewiseConstant1D, Stream};
use lumel_scene::{Scene, TriId};

/// Places on the triangles that rays meet, evenly by area: the triangle and where on it, in the unit square. None if there
/// is no area.
pub(crate) fn by_area(scene: &Scene, stream: Stream, n: u32) -> impl Iterator<Item = (TriId, [f32; 2])> {
    let weights: Vec<f32> = (0..scene.traced_count() as u32).map(|tri| scene.area(TriId(tri))).collect();
    PiecewiseConstant1D::new(&weights).into_iter().flat_map(move |by_area| {
        (0..n).map(move |i| {
            let [x, y, choice, _] = stream.sample_4d(i);
            (TriId(by_area.sample(choice).0 as u32), [x, y])
        })
    })
}
