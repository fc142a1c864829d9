//! Normals that images tilt.

use crate::{Scene, SurfacePoint, TextureRef};
use glam::{Mat2, Vec2, Vec3, Vec4, Vec4Swizzles};
use std::fmt;

/// A normal map as a material uses it: tangent-space normals, linear, red along the image's right, green along its top.
///
/// It tilts the normals that are shown. Light is measured, and bounces, as if there were none.
#[derive(Clone, Copy, PartialEq)]
pub struct NormalMap {
    /// The image.
    pub image: TextureRef,
    /// Factors of red and green, each from -1 to 1 before; the second is negative where green points down.
    pub scale: Vec2,
}

impl NormalMap {
    /// A normal map whose green points up.
    pub fn new(image: TextureRef) -> Self {
        Self { image, scale: Vec2::ONE }
    }

    /// The same with green the other way.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { scale: self.scale * Vec2::new(1.0, -1.0), ..self }
    }

    /// From red and green, -1..=1, to what is along the tangent and the bitangent of the mesh.
    ///
    /// Both are those of the coordinates of the mesh, which [`UvTransform`](crate::UvTransform) may turn and mirror in the
    /// image. Zero where it makes a line or a point of the image.
    pub fn tangent_from_texel(&self) -> Mat2 {
        let transform = self.image.transform;
        let [origin, u, v] = [Vec2::ZERO, Vec2::X, Vec2::Y].map(|uv| transform.apply(uv));
        let image_from_mesh = Mat2::from_cols(u - origin, v - origin);
        let determinant = image_from_mesh.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return Mat2::ZERO;
        }
        // The image's right in coordinates of the mesh; there and in the image, v is down and bitangents are up.
        let right = (image_from_mesh.inverse() * Vec2::X).normalize_or_zero() * Vec2::new(1.0, -1.0);
        let up = right.perp() * determinant.signum();
        Mat2::from_cols(right * self.scale.x, up * self.scale.y)
    }
}

impl fmt::Debug for NormalMap {
    /// As the image it was before it could have a scale: the hashes of scenes are made of this.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.scale == Vec2::ONE {
            true => self.image.fmt(f),
            false => f.debug_tuple("NormalMap").field(&self.image).field(&self.scale).finish(),
        }
    }
}

impl Scene {
    /// The unit normal of a surface point tilted by the material's normal map; `None` where it has none, and where a
    /// [tangent](Self::tangents) is missing.
    ///
    /// With the interpolated tangent `t`, its sign `w` and the interpolated normal `n`, none of unit length, it is along
    /// `t x + w (n × t) y + n z`, as [MikkTSpace](http://www.mikktspace.com) has it; `x`, `y` and `z` are those of the
    /// texel, which is read as `2c − 1`. `scale` multiplies the map's own.
    pub fn mapped_normal(&self, at: SurfacePoint, scale: Vec2) -> Option<Vec3> {
        let map = self.material(at.tri).normal_texture?;
        let tangent = self.tangent(at)?;
        let uv = map.image.transform.apply(self.uv(at));
        let texel = 2.0 * self.textures()[map.image.texture.index()].sample(uv) - Vec3::ONE;
        let normal = self.vertex_normal(at);
        let tilt = map.tangent_from_texel() * (scale * texel.truncate());
        let bitangent = tangent.w * normal.cross(tangent.xyz());
        (tangent.xyz() * tilt.x + bitangent * tilt.y + normal * texel.z).try_normalize()
    }

    /// The interpolated tangent and the sign of its bitangent; `None` where there is none.
    fn tangent(&self, at: SurfacePoint) -> Option<Vec4> {
        let corners =
            self.triangle(at.tri).map(|v| self.tangents().get(v as usize).copied().unwrap_or_default());
        let [a, b, c] = corners;
        let [wa, wb, wc] = at.bary.weights();
        let along = (a * wa + b * wb + c * wc).xyz();
        // Only where the image is mirrored do signs differ, and no triangle is.
        (along != Vec3::ZERO && corners.iter().all(|t| t.w != 0.0)).then(|| along.extend(a.w))
    }
}
