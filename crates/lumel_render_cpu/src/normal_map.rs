//! Shading normals with normal maps.

use glam::{Vec2, Vec3};
use lumel_scene::{Scene, SurfacePoint, TextureRef, TriId};

/// The unit normal that a picture shows: the interpolated vertex normal, perturbed by the material's normal map.
///
/// The tangent frame comes from the triangle: `t` points along increasing `u`, `b` towards the top of the
/// image (`v` points down), both made perpendicular to the interpolated normal `n`. A texel `m`, 0..=1, gives
/// `normalize(t (2m.x − 1) + b (2m.y − 1) + n (2m.z − 1))`. On the back of a two-sided face it is that of the front,
/// negated. Where texture coordinates span no area, the map is ignored.
pub(crate) fn seen_normal(scene: &Scene, at: SurfacePoint) -> Vec3 {
    let normal = scene.shading_normal(at);
    let Some(map) = scene.material(at.tri).normal_texture else { return normal };
    let side = if scene.traced(at.tri) == at.tri { 1.0 } else { -1.0 };
    mapped(scene, at, map, side * normal).map_or(normal, |mapped| side * mapped)
}

/// The mapped normal on the front of a face.
fn mapped(scene: &Scene, at: SurfacePoint, map: TextureRef, normal: Vec3) -> Option<Vec3> {
    let [tangent, bitangent] = tangents(scene, at.tri, map, normal)?;
    let texture = scene.textures().get(map.texture.index())?;
    let m = 2.0 * texture.sample(map.transform.apply(scene.uv(at))) - Vec3::ONE;
    (tangent * m.x + bitangent * m.y + normal * m.z).try_normalize()
}

/// Unit vectors along the image's right and top, perpendicular to the normal.
fn tangents(scene: &Scene, tri: TriId, map: TextureRef, normal: Vec3) -> Option<[Vec3; 2]> {
    let [a, b, c] = scene.triangle_positions(tri);
    let [uv_a, uv_b, uv_c] = scene.triangle(tri).map(|v| map.transform.apply(scene.uvs()[v as usize]));
    let (e1, e2): (Vec3, Vec3) = (b - a, c - a);
    let (d1, d2): (Vec2, Vec2) = (uv_b - uv_a, uv_c - uv_a);
    let area = d1.perp_dot(d2);
    if area == 0.0 {
        return None;
    }
    let along_u = (e1 * d2.y - e2 * d1.y) * area.signum();
    let along_v = (e2 * d1.x - e1 * d2.x) * area.signum();
    let tangent = along_u.reject_from_normalized(normal).try_normalize()?;
    let bitangent = normal.cross(tangent);
    Some([tangent, if bitangent.dot(along_v) > 0.0 { -bitangent } else { bitangent }])
}
