//! Why a scene cannot be built.

/// The largest number of triangles in a scene: indices of corners must fit 32 bits.
pub const MAX_TRIANGLES: usize = (u32::MAX / 3) as usize;

/// Why a scene cannot be built.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum SceneError {
    /// Nothing to light.
    #[error("scene \"{scene}\" has no triangles that can be lit")]
    Empty {
        /// The scene's name.
        scene: String,
    },
    /// All triangles are too small for the extent of the scene.
    #[error(
        "scene \"{scene}\" has no triangles that can be lit: all are smaller than a millionth of its extent; the scene is \
         {diagonal:.0} m across, so some object lies very far from the others: move it nearer"
    )]
    TooSmall {
        /// The scene's name.
        scene: String,
        /// The diagonal of its bounds, metres.
        diagonal: f64,
    },
    /// More triangles or vertices than indices can address.
    #[error("scene \"{scene}\" would have {triangles} triangles; the limit is {MAX_TRIANGLES}")]
    TooLarge {
        /// The scene's name.
        scene: String,
        /// How many it would have.
        triangles: u64,
    },
    /// An index points outside its array.
    #[error("object \"{object}\": face {face} refers to {what} {index} of {count}")]
    BadIndex {
        /// The object's name.
        object: String,
        /// Which of its faces.
        face: usize,
        /// "vertex" or "material".
        what: &'static str,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// Attribute arrays of different lengths.
    #[error("object \"{object}\" has {count} {what} for {vertices} vertices")]
    BadCount {
        /// The object's name.
        object: String,
        /// Which attribute.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there should be.
        vertices: usize,
    },
    /// Coordinates that are rounded too coarsely for the triangles.
    #[error(
        "object \"{object}\": its coordinates are rounded to {rounding:.1e} m, as coarsely as most of its triangles are \
         wide: move it near the origin in the modelling program, or make it a scene of its own"
    )]
    Unresolved {
        /// The object's name.
        object: String,
        /// By how much, metres.
        rounding: f64,
    },
    /// A material or light names a texture that does not exist.
    #[error("{user} refers to texture {index} of {count}")]
    BadTexture {
        /// The material or light.
        user: String,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A sky that is not finite or negative.
    #[error("the sky's radiance must be finite and not negative")]
    BadSky,
    /// A rectangle light that has no area, is not rectangular or is not finite.
    #[error("light {index}: {problem}")]
    BadLight {
        /// Index into the lights.
        index: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A length for tessellation that would take more memory than anybody has.
    #[error(
        "edges of at most {max_edge} m would give scene \"{scene}\" at least {triangles} triangles; the limit is {limit}: choose a longer edge"
    )]
    TooFine {
        /// The scene's name.
        scene: String,
        /// The length, metres.
        max_edge: f32,
        /// How many triangles it takes at the least.
        triangles: u64,
        /// How many are allowed.
        limit: u64,
    },
    /// Splits of edges that the scene does not have.
    #[error("the refinement of {splits} split edges does not belong to scene \"{scene}\"")]
    BadSplits {
        /// The scene's name.
        scene: String,
        /// How many edges are split.
        splits: usize,
    },
    /// A length for tessellation that is not a positive number.
    #[error("the longest edge must be a positive length, not {0}")]
    BadEdgeLength(f32),
}
