//! The same places for smaller triangles.

use crate::Atlas;
use glam::{DVec2, DVec3, Vec2};
use lumel_scene::{Scene, TriId};
use rayon::prelude::*;

/// Points as far from a triangle, in parts of its largest coordinate, lie on it: rounding moves them by less.
const ON_IT: f64 = 1e-6;

impl Atlas {
    /// The places of the same surfaces in smaller triangles.
    ///
    /// `whole` is the scene of the atlas, and `fine` the same with long edges split: what reads light through the result on the
    /// triangles of `fine` finds it in the same lumels. Objects keep their numbers; a triangle belongs to the one of `whole`
    /// in which its middle lies, or next to which, if there is none.
    #[must_use]
    pub fn refined(&self, whole: &Scene, fine: &Scene) -> Self {
        let n_objects = fine.object_names().len();
        let (wholes, fines) = (by_object(whole, n_objects), by_object(fine, n_objects));
        let found: Vec<Vec<(TriId, TriId)>> = (wholes.par_iter().zip(&fines))
            .map(|(wholes, fines)| parents(whole, fine, wholes, fines))
            .collect();
        let n_triangles = fine.triangle_count();
        let (mut corners, mut charts) = (vec![[Vec2::ZERO; 3]; n_triangles], vec![0; n_triangles]);
        for (part, parent) in found.into_iter().flatten() {
            let (given, places) = (points(whole, parent), self.corners(parent).map(|c| c.as_dvec2()));
            corners[part.index()] = points(fine, part).map(|corner| {
                let weights = weights(given, corner).to_array();
                places.iter().zip(weights).map(|(&place, weight)| place * weight).sum::<DVec2>().as_vec2()
            });
            charts[part.index()] = self.charts[parent.index()];
        }
        Self { corners, charts, pages: self.pages.clone(), places: self.places.clone(), ..*self }
    }
}

fn by_object(scene: &Scene, n_objects: usize) -> Vec<Vec<TriId>> {
    let mut objects = vec![Vec::new(); n_objects];
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        if let Some(object) = objects.get_mut(scene.object_id(tri).index()) {
            object.push(tri);
        }
    }
    objects
}

/// Pairs each triangle of an object in `fine` with the one of `whole` that it is a part of.
fn parents(whole: &Scene, fine: &Scene, wholes: &[TriId], fines: &[TriId]) -> Vec<(TriId, TriId)> {
    // Parts of a triangle follow each other, in the order of the triangles.
    let mut now = 0;
    let mut pairs = Vec::with_capacity(fines.len());
    for &part in fines {
        let middle = points(fine, part).into_iter().sum::<DVec3>() / 3.0;
        let normal = fine.geometric_normal(part);
        let mut best = (f64::INFINITY, now);
        for place in (now..wholes.len()).chain(0..now) {
            let given = points(whole, wholes[place]);
            let distance = distance(given, middle);
            if distance < best.0 && whole.geometric_normal(wholes[place]).dot(normal) > 0.0 {
                best = (distance, place);
                if distance <= ON_IT * given.iter().fold(0.0, |size, p| p.abs().max_element().max(size)) {
                    break;
                }
            }
        }
        now = best.1;
        pairs.extend(wholes.get(now).map(|&parent| (part, parent)));
    }
    pairs
}

fn points(scene: &Scene, tri: TriId) -> [DVec3; 3] {
    scene.triangle_positions(tri).map(|p| p.as_dvec3())
}

/// The weights of the corners at the point of a triangle's plane that is nearest to `at`; they add up to 1.
fn weights([a, b, c]: [DVec3; 3], at: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared().max(f64::MIN_POSITIVE);
    let [u, v] = [(b - at).cross(c - at), (c - at).cross(a - at)].map(|n| n.dot(normal) / whole);
    DVec3::new(u, v, 1.0 - u - v)
}

/// How far a point is from a triangle at most, and 0 on it.
fn distance(corners: [DVec3; 3], at: DVec3) -> f64 {
    let inside = weights(corners, at).max(DVec3::ZERO);
    let [a, b, c] = corners;
    let nearest = (a * inside.x + b * inside.y + c * inside.z) / inside.element_sum();
    nearest.distance(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{cube, face};
    use crate::{Pace, UnwrapSettings, unwrap};
    use glam::Vec3;
    use lumel_scene::{Barycentrics, Face, Material, MaterialId, ObjectMesh, SceneBuilder, SurfacePoint};
    use std::collections::BTreeMap;

    /// A cube, and a sheet with two sides.
    fn builder() -> SceneBuilder {
        let both = |vertices| Face { material: MaterialId(1), ..face(vertices) };
        let sheet = ObjectMesh {
            name: "sheet".into(),
            positions: [[3.0, 0.0, 0.0], [4.0, 0.1, 0.0], [4.0, 1.0, 0.2], [3.0, 1.3, 0.1]]
                .map(Vec3::from)
                .into(),
            faces: [[0, 1, 2], [0, 2, 3]].map(both).into(),
            ..ObjectMesh::default()
        };
        let materials = vec![Material::default(), Material::default().two_sided()];
        SceneBuilder { objects: vec![cube(), sheet], materials, ..SceneBuilder::new("two") }
    }

    #[test]
    fn parts_have_the_places_of_their_triangle() {
        let whole = builder().build().unwrap().0;
        let mut split = builder();
        split.tessellate(0.17).unwrap();
        let fine = split.build().unwrap().0;
        let atlas = unwrap(&whole, &UnwrapSettings::default(), &|| Pace::Go).unwrap().atlas;
        let refined = atlas.refined(&whole, &fine);
        assert_eq!(refined.triangle_count(), fine.triangle_count());
        let area = |atlas: &Atlas, tri| {
            let [a, b, c] = atlas.corners(tri).map(|c| c.as_dvec2());
            0.5 * (b - a).perp_dot(c - a)
        };
        let mut areas: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for tri in (0..whole.triangle_count() as u32).map(TriId) {
            areas.entry(atlas.chart(tri)).or_default()[0] += area(&atlas, tri);
        }
        for tri in (0..fine.triangle_count() as u32).map(TriId) {
            let area = area(&refined, tri);
            assert!(area > 0.0, "parts are not mirrored");
            areas.entry(refined.chart(tri)).or_default()[1] += area;
        }
        assert!(areas.values().all(|[a, b]| (a - b).abs() < 1e-4 * a), "charts keep their areas: {areas:?}");
        // A place on a page is one point of the surface, whichever triangle says so.
        let middle = Barycentrics { u: 1.0 / 3.0, v: 1.0 / 3.0 };
        for part in (0..fine.triangle_count() as u32).map(TriId) {
            let place = refined.corners(part).into_iter().sum::<Vec2>() / 3.0;
            let point = fine.position(SurfacePoint { tri: part, bary: middle });
            let is_there = (0..whole.triangle_count() as u32).map(TriId).any(|tri| {
                let [a, b, c] = atlas.corners(tri);
                let whole_area = (b - a).perp_dot(c - a);
                let [u, v] = [(b - place).perp_dot(c - place), (c - place).perp_dot(a - place)]
                    .map(|x| x / whole_area);
                let bary = Barycentrics { u, v };
                let inside =
                    bary.weights().iter().all(|w| *w > -1e-4) && atlas.page(tri) == refined.page(part);
                inside && whole.position(SurfacePoint { tri, bary }).distance(point) < 1e-4
            });
            assert!(is_there, "{part:?}");
        }
    }
}
