//! From a mesh's own space to the world.

use glam::{DAffine3, DMat3, DVec3, Mat3, Vec3, Vec4};

/// Where the vertices of a primitive stand.
pub(super) enum Pose {
    /// All of them where one transform puts them.
    Rigid(Transform),
    /// Each where its own does.
    Skinned(Vec<Transform>),
}

impl Pose {
    /// A position in world space.
    pub(super) fn point(&self, vertex: usize, point: [f32; 3]) -> Vec3 {
        self.of(vertex).world.transform_point3(Vec3::from(point).as_dvec3()).as_vec3()
    }

    /// A normal in world space, of any length.
    pub(super) fn normal(&self, vertex: usize, normal: [f32; 3]) -> Vec3 {
        self.of(vertex).normals * Vec3::from(normal)
    }

    /// A tangent in world space, of any length, and the sign of its bitangent.
    pub(super) fn tangent(&self, vertex: usize, tangent: [f32; 3], sign: f32) -> Vec4 {
        let Transform { world, mirrors, .. } = self.of(vertex);
        let along = world.transform_vector3(Vec3::from(tangent).as_dvec3()).as_vec3();
        along.extend(if *mirrors { -sign } else { sign })
    }

    /// Whether a triangle shows its other side unless its corners run the other way. Corners that disagree vote.
    pub(super) fn mirrors(&self, corners: [u32; 3]) -> bool {
        corners.iter().filter(|&&vertex| self.of(vertex as usize).mirrors).count() > 1
    }

    /// How many times as far apart points are at the most.
    pub(super) fn stretch(&self) -> f64 {
        match self {
            Self::Rigid(transform) => transform.stretch(),
            Self::Skinned(transforms) => transforms.iter().map(Transform::stretch).fold(0.0, f64::max),
        }
    }

    fn of(&self, vertex: usize) -> &Transform {
        match self {
            Self::Rigid(transform) => transform,
            Self::Skinned(transforms) => &transforms[vertex],
        }
    }
}

/// World from mesh.
pub(super) struct Transform {
    world: DAffine3,
    normals: Mat3,
    mirrors: bool,
}

impl Transform {
    fn stretch(&self) -> f64 {
        let DMat3 { x_axis, y_axis, z_axis } = self.world.matrix3;
        [x_axis, y_axis, z_axis].into_iter().map(DVec3::length).fold(0.0, f64::max)
    }
}

impl From<DAffine3> for Transform {
    fn from(world: DAffine3) -> Self {
        let mirrors = world.matrix3.determinant() < 0.0;
        Self { world, normals: normal_matrix(world.matrix3), mirrors }
    }
}

/// The transform of normals to world space: the inverse transpose up to a positive factor.
///
/// The matrix of cofactors is the inverse transpose times the determinant; it exists for flat shapes too, where one
/// scale is zero. Its largest element is made 1, so that tiny and huge scales stay within f32.
fn normal_matrix(m: DMat3) -> Mat3 {
    let cofactors =
        DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let largest = cofactors.to_cols_array().into_iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let scale = if largest > 0.0 { sign / largest } else { 1.0 };
    (cofactors * scale).as_mat3()
}
