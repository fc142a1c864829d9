//! Vertices that differ in the atlas.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;
use lumel_scene::TriId;
use lumel_uv::Atlas;
use std::collections::HashMap;
use std::sync::Arc;

/// Where on an atlas a vertex is, as the shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Place {
    /// Lumels.
    at: [f32; 2],
    page: u32,
    /// The smallest and the largest coordinates of its chart, lumels.
    chart: [[f32; 2]; 2],
}

/// Vertices of a device, of which a vertex of the scene has several where charts meet.
pub(crate) struct Corners {
    /// Triangles in the order they are drawn.
    pub(crate) indices: Vec<[u32; 3]>,
    /// The vertex of the scene that each of them is; `None` if they are those of the scene.
    pub(crate) sources: Option<Arc<[u32]>>,
    /// By vertex.
    pub(crate) places: Vec<Place>,
}

impl Corners {
    /// Those of a scene without an atlas.
    pub(crate) fn new(indices: Vec<[u32; 3]>) -> Self {
        Self { indices, sources: None, places: Vec::new() }
    }

    /// Splits vertices where the atlas has several places for them; `tris` are the triangles of `indices`.
    pub(crate) fn split(indices: &[[u32; 3]], tris: &[TriId], atlas: &Atlas) -> Self {
        let mut numbers: HashMap<(u32, [u32; 2], usize), u32> = HashMap::new();
        let (mut sources, mut places) = (Vec::new(), Vec::new());
        let bounds = bounds_of_charts(atlas);
        let mut number = |vertex: u32, at: [f32; 2], chart: usize| {
            *numbers.entry((vertex, at.map(f32::to_bits), chart)).or_insert_with(|| {
                sources.push(vertex);
                places.push(Place { at, page: atlas.charts()[chart].page, chart: bounds[chart] });
                sources.len() as u32 - 1
            })
        };
        let split = |(vertices, &tri): (&[u32; 3], &TriId)| {
            let (corners, chart) = (atlas.corners(tri), atlas.chart(tri));
            [0, 1, 2].map(|k| number(vertices[k], corners[k].to_array(), chart))
        };
        let indices = indices.iter().zip(tris).map(split).collect();
        Self { indices, sources: Some(sources.into()), places }
    }

    /// An attribute of the scene's vertices, by vertex of the device.
    pub(crate) fn of<T: Copy>(&self, values: &[T]) -> Vec<T> {
        gathered(self.sources.as_deref(), values)
    }
}

/// The smallest and the largest coordinates of each chart, lumels.
fn bounds_of_charts(atlas: &Atlas) -> Vec<[[f32; 2]; 2]> {
    let mut bounds = vec![[Vec2::INFINITY, Vec2::NEG_INFINITY]; atlas.charts().len()];
    for tri in (0..atlas.triangle_count() as u32).map(TriId) {
        let [min, max] = &mut bounds[atlas.chart(tri)];
        atlas.corners(tri).iter().for_each(|&at| (*min, *max) = (min.min(at), max.max(at)));
    }
    bounds.into_iter().map(|ends| ends.map(|end| end.to_array())).collect()
}

/// An attribute of the scene's vertices, for those of a device that are these.
pub(crate) fn gathered<T: Copy>(sources: Option<&[u32]>, values: &[T]) -> Vec<T> {
    match sources {
        Some(sources) => sources.iter().map(|&vertex| values[vertex as usize]).collect(),
        None => values.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lumel_testkit::{mesh, scene};
    use lumel_uv::{Pace, UnwrapSettings, unwrap};

    #[test]
    fn vertices_are_split_where_charts_meet_and_nowhere_else() {
        let ball = mesh::sphere(Vec3::ZERO, 1.0, 2, mesh::Facing::Outward, 0);
        let (scene, _) = scene::scene(vec![ball], vec![scene::grey(0.5, 0.0)], vec![]).build().unwrap();
        let atlas = unwrap(&scene, &UnwrapSettings::default(), &|| Pace::Go).unwrap().atlas;
        assert!(atlas.charts().len() > 1);
        let tris: Vec<TriId> = (0..scene.triangle_count() as u32).map(TriId).collect();
        let corners = Corners::split(scene.triangles(), &tris, &atlas);
        let sources = corners.sources.as_deref().unwrap();
        assert_eq!(corners.places.len(), sources.len());
        for (&tri, indices) in tris.iter().zip(&corners.indices) {
            assert_eq!(indices.map(|index| sources[index as usize]), scene.triangle(tri));
            let places = indices.map(|index| corners.places[index as usize]);
            assert_eq!(places.map(|place| place.at), atlas.corners(tri).map(|at| at.to_array()));
        }
        let added = sources.len() - scene.vertex_count();
        assert!(added > 0 && added < scene.vertex_count(), "{added}");
        let mut unique: Vec<_> =
            (0..sources.len()).map(|i| (sources[i], corners.places[i].at.map(f32::to_bits))).collect();
        unique.sort_unstable();
        unique.dedup();
        assert_eq!(unique.len(), sources.len());
    }
}
