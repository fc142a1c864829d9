//! Orthonormal frames around a normal.

use glam::Vec3;

/// A right-handed orthonormal frame: `tangent × bitangent = normal`.
///
/// Local coordinates are (along tangent, along bitangent, along normal), so the local hemisphere has z up. Unit
/// vectors in the space of the normal, usually world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x axis.
    pub tangent: Vec3,
    /// Local y axis.
    pub bitangent: Vec3,
    /// Local z axis.
    pub normal: Vec3,
}

impl Frame {
    /// A frame around the unit vector `n`, orthonormal to f32 rounding for every `n`.
    ///
    /// The frame turns smoothly with `n` on each half of the sphere and jumps where `n.z` changes its sign.
    ///
    /// Duff et al., *Building an orthonormal basis, revisited*, JCGT 6(1), 2017.
    #[inline]
    #[must_use]
    pub fn from_normal(n: Vec3) -> Self {
        // Reflecting through the plane half-way to the nearer pole turns that pole into n and x, y into the frame;
        // the nearer pole keeps the denominator at 1 or above.
        let pole = 1.0_f32.copysign(n.z);
        let scale = -1.0 / (pole + n.z);
        let shared = n.x * n.y * scale;
        Self {
            tangent: Vec3::new(1.0 + pole * n.x * n.x * scale, pole * shared, -pole * n.x),
            bitangent: Vec3::new(shared, pole + n.y * n.y * scale, -n.y),
            normal: n,
        }
    }

    /// A local vector in the space of the frame's axes.
    #[inline]
    #[must_use]
    pub fn to_world(&self, local: Vec3) -> Vec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }

    /// The coordinates of `world` along the axes: the inverse of [`to_world`](Self::to_world).
    #[inline]
    #[must_use]
    pub fn to_local(&self, world: Vec3) -> Vec3 {
        Vec3::new(self.tangent.dot(world), self.bitangent.dot(world), self.normal.dot(world))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dim, Sampler, StreamKey, uniform_sphere};

    fn normals() -> impl Iterator<Item = Vec3> {
        let stream = Sampler::Sobol.stream(StreamKey::new(5), Dim::Hemisphere);
        let near_poles =
            [Vec3::new(1e-4, -2e-4, 1.0), Vec3::new(1e-4, 3e-5, -1.0), Vec3::new(1.0, 0.0, -1e-9)];
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z, Vec3::new(0.6, 0.8, -0.0)];
        (0..4096).map(move |i| uniform_sphere(stream.sample_2d(i))).chain(near_poles).chain(axes)
    }

    /// Four roundings per component, each 6e-8 of values near one.
    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for n in normals() {
            let Frame { tangent, bitangent, normal } = Frame::from_normal(n);
            assert!((tangent.length() - 1.0).abs() < 4e-7 && (bitangent.length() - 1.0).abs() < 4e-7, "{n}");
            assert!(tangent.dot(bitangent).abs().max(tangent.dot(normal).abs()) < 4e-7, "{n}");
            assert!(tangent.cross(bitangent).distance(normal) < 5e-7, "{n}");
        }
    }

    #[test]
    fn to_local_undoes_to_world() {
        let local = Vec3::new(0.3, -1.7, 2.5);
        for n in normals() {
            let frame = Frame::from_normal(n);
            assert!(frame.to_local(frame.to_world(local)).distance(local) < 3e-6, "{n}");
            assert!(frame.to_world(Vec3::Z).distance(n) == 0.0);
        }
    }
}
