//! Rectangles among emissive triangles: one light each, with a closed form, however finely they are split.

use glam::{DVec3, Vec3};
use lumel_scene::{Edges, MaterialId, RectLight, Scene, TriId, Weld};
use std::collections::BTreeMap;

/// Normals of one plane agree to this cosine, and right angles are right to this one.
const FLAT: f64 = 1.0 - 1e-6;
const RIGHT: f64 = 1e-4;

/// The area of a rectangle agrees with that of its triangles to this share.
const SAME_AREA: f64 = 1e-4;

/// Triangles that make up a rectangle of one material.
pub(crate) struct EmissiveRect {
    pub(crate) rect: RectLight,
    pub(crate) material: MaterialId,
    /// In ascending order.
    pub(crate) tris: Vec<TriId>,
}

/// Finds the rectangles among triangles that shine evenly; returns the triangles that are left, in their order, too.
pub(crate) fn rectangles(scene: &Scene, tris: &[TriId]) -> (Vec<EmissiveRect>, Vec<TriId>) {
    let patches = Patches::new(scene, tris);
    let (mut rects, mut others) = (Vec::new(), Vec::new());
    for patch in patches.each() {
        let material = scene.material_id(patch[0]);
        match patches.outline(&patch).and_then(|outline| rectangle(scene, &patch, &outline)) {
            Some(rect) if patch.len() > 1 => rects.push(EmissiveRect { rect, material, tris: patch }),
            _ => others.extend(patch),
        }
    }
    others.sort_unstable();
    (rects, others)
}

/// The rectangle with this outline, if it is one.
fn rectangle(scene: &Scene, patch: &[TriId], outline: &[Vec3]) -> Option<RectLight> {
    let corners = without_straight(outline);
    let [a, b, c, d] = <[DVec3; 4]>::try_from(corners).ok()?;
    let (along, up) = (b - a, d - a);
    let is_right = along.normalize().dot(up.normalize()).abs() < RIGHT;
    let closes = (a + along + up - c).length() < RIGHT * (along.length() + up.length());
    let area: f64 = patch.iter().map(|&tri| f64::from(scene.area(tri))).sum();
    let has_area = (along.cross(up).length() / area - 1.0).abs() < SAME_AREA;
    let radiance = scene.material(patch[0]).emission.0;
    let center = (a + b + c + d) / 4.0;
    let rect = RectLight::new(center.as_vec3(), (along / 2.0).as_vec3(), (up / 2.0).as_vec3(), radiance);
    (is_right && closes && has_area).then_some(rect)
}

/// The corners of an outline at which it turns.
fn without_straight(outline: &[Vec3]) -> Vec<DVec3> {
    let n = outline.len();
    let at = |i: usize| outline[i % n].as_dvec3();
    let turns = |i: &usize| {
        let (before, after) = (at(*i) - at(i + n - 1), at(i + 1) - at(*i));
        before.normalize_or_zero().dot(after.normalize_or_zero()) < FLAT
    };
    (0..n).filter(turns).map(at).collect()
}

/// Triangles that hang together in one plane.
struct Patches<'a> {
    scene: &'a Scene,
    tris: &'a [TriId],
    /// The places of the corners of each.
    corners: Vec<[u32; 3]>,
    /// The patch of each.
    patch: Vec<usize>,
}

impl<'a> Patches<'a> {
    fn new(scene: &'a Scene, tris: &'a [TriId]) -> Self {
        let mut weld = Weld::default();
        let corners: Vec<[u32; 3]> =
            tris.iter().map(|&tri| scene.triangle_positions(tri).map(|p| weld.number(p))).collect();
        let at_edge = Edges::new(corners.iter().copied());
        let normals: Vec<DVec3> = tris.iter().map(|&tri| scene.geometric_normal(tri).as_dvec3()).collect();
        let mut patch = vec![usize::MAX; tris.len()];
        for first in 0..tris.len() {
            if patch[first] != usize::MAX {
                continue;
            }
            patch[first] = first;
            let mut next = vec![first];
            while let Some(i) = next.pop() {
                for j in edges(corners[i]).flat_map(|(p, q)| at_edge.between(p, q)).map(|e| e.tri as usize) {
                    if patch[j] == usize::MAX
                        && scene.material_id(tris[j]) == scene.material_id(tris[first])
                        && normals[j].dot(normals[first]) > FLAT
                    {
                        patch[j] = first;
                        next.push(j);
                    }
                }
            }
        }
        Self { scene, tris, corners, patch }
    }

    /// The triangles of each patch.
    fn each(&self) -> impl Iterator<Item = Vec<TriId>> {
        let mut patches: BTreeMap<usize, Vec<TriId>> = BTreeMap::new();
        for (&tri, &patch) in self.tris.iter().zip(&self.patch) {
            patches.entry(patch).or_default().push(tri);
        }
        patches.into_values()
    }

    /// The points around a patch, if it has one border, in the order of the winding.
    fn outline(&self, patch: &[TriId]) -> Option<Vec<Vec3>> {
        let place = |tri: &TriId| self.tris.binary_search(tri).ok();
        let mut border: BTreeMap<(u32, u32), Vec3> = BTreeMap::new();
        for tri in patch {
            let corners = self.corners[place(tri)?];
            let points = self.scene.triangle_positions(*tri);
            for ((p, q), point) in edges(corners).zip(points) {
                // What two triangles have in common is passed both ways.
                if border.remove(&(q, p)).is_none() {
                    border.insert((p, q), point);
                }
            }
        }
        let from: BTreeMap<u32, (u32, Vec3)> =
            border.iter().map(|(&(p, q), &point)| (p, (q, point))).collect();
        let (&first, _) = from.iter().next()?;
        let (mut at, mut outline) = (first, Vec::with_capacity(from.len()));
        for _ in 0..border.len() {
            let (next, point) = *from.get(&at)?;
            outline.push(point);
            at = next;
            if at == first {
                break;
            }
        }
        (at == first && outline.len() == border.len()).then_some(outline)
    }
}

fn edges([a, b, c]: [u32; 3]) -> impl Iterator<Item = (u32, u32)> {
    [(a, b), (b, c), (c, a)].into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{EulerRot, Quat};
    use lumel_testkit::mesh::{disk_facing_down, quad};
    use lumel_testkit::scene::{grey, scene};

    #[test]
    fn rectangles_are_found_however_they_are_split_and_nothing_else_is() {
        let turn = Quat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.3);
        let place = |[x, y]: [f32; 2]| turn * Vec3::new(x, y, 0.0) + Vec3::new(3.0, -2.0, 7.0);
        let wide = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]].map(place);
        let slanted = [[5.0, 0.0], [8.0, 0.0], [9.0, 1.0], [6.0, 1.0]].map(place);
        let objects = vec![
            quad(wide, [5, 3], 0),
            quad(slanted, [2, 2], 0),
            quad(wide.map(|p| p + turn * Vec3::Z), [1, 1], 1),
            disk_facing_down(Vec3::splat(20.0), 1.0, 12, 0),
        ];
        let builder = scene(objects, vec![grey(0.5, 1.0), grey(0.5, 2.0)], vec![]);
        let scene = builder.build().unwrap().0;
        let tris: Vec<TriId> = (0..scene.triangle_count() as u32).map(TriId).collect();
        let (rects, others) = rectangles(&scene, &tris);
        assert_eq!(rects.iter().map(|rect| rect.tris.len()).collect::<Vec<_>>(), [30, 2]);
        assert_eq!(others, tris[30..38].iter().chain(&tris[40..]).copied().collect::<Vec<_>>());
        for (EmissiveRect { rect, material, .. }, height) in rects.iter().zip([0.0, 1.0]) {
            let middle = place([1.5, 0.5]) + turn * Vec3::Z * height;
            assert!((rect.center - middle).length() < 1e-5, "{}", rect.center);
            assert!((rect.area() - 3.0).abs() < 1e-5);
            assert!((rect.normal().unwrap() - turn * Vec3::Z).length() < 1e-5);
            assert_eq!(rect.radiance, scene.materials()[material.index()].emission);
        }
    }
}
