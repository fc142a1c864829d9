//! Where on a scene's surfaces: indices and addresses.

use serde::{Deserialize, Serialize};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub struct $name(pub u32);

        impl $name {
            /// The index as a `usize`, for slices.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A triangle of a [`Scene`](crate::Scene).
    TriId
);
id!(
    /// A material of a scene.
    MaterialId
);
id!(
    /// A texture of a scene.
    TextureId
);
id!(
    /// A named part of a scene: an OBJ object or a glTF node.
    ObjectId
);

/// Barycentric coordinates: `u` and `v` weigh corners 0 and 1, corner 2 gets `1 - u - v`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Barycentrics {
    /// Weight of corner 0.
    pub u: f32,
    /// Weight of corner 1.
    pub v: f32,
}

impl Barycentrics {
    /// The coordinates of corner 0, 1 or 2.
    pub const CORNERS: [Self; 3] =
        [Self { u: 1.0, v: 0.0 }, Self { u: 0.0, v: 1.0 }, Self { u: 0.0, v: 0.0 }];

    /// The weights of the three corners; they sum to 1 up to rounding.
    #[inline]
    pub fn weights(self) -> [f32; 3] {
        [self.u, self.v, 1.0 - self.u - self.v]
    }
}

impl From<[f32; 2]> for Barycentrics {
    fn from([u, v]: [f32; 2]) -> Self {
        Self { u, v }
    }
}

/// A point on a surface, as an address that does not depend on rounding in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// The triangle.
    pub tri: TriId,
    /// Where on the triangle.
    pub bary: Barycentrics,
}

/// The side of a triangle that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceSide {
    /// Its corners run counter-clockwise.
    Front,
    /// Its corners run clockwise.
    Back,
}
