//! The laws that every basis and all receivers keep, from one test body.
//!
//! A new basis or new receivers call [`assert_basis_laws`] or [`assert_receiver_laws`] on the scenes of
//! [`scenes`]. [`basis_laws`] and [`receiver_laws`] return the first violation instead, so that tests can show
//! that each law fails when it is broken.

mod basis;
mod receivers;
mod scenes;

pub use basis::{assert_basis_laws, basis_laws};
pub use receivers::{assert_receiver_laws, receiver_laws};
pub use scenes::scenes;

use glam::Vec3;
use lumel_basis::Identity;
use lumel_scene::{Scene, SceneBuilder};
use std::fmt;
use std::sync::Arc;

/// A law of bases or receivers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// The weights at every point sum to 1, so constants are reproduced.
    PartitionOfUnity,
    /// Weights belong to nodes that exist and are finite; those of measurements are not negative.
    Weights,
    /// A basis that is linear over triangles reproduces functions that are linear in space.
    LinearFunctions,
    /// `node_areas` are the integrals of the basis functions and sum to the area of the surfaces.
    NodeAreas,
    /// `corner_nodes` agree with `weights_at`, `corners` with `towards`.
    CornerNodes,
    /// The adjacency is symmetric and has all nodes; the nodes of a triangle are adjacent.
    Adjacency,
    /// Extrapolation gives all nodes that known ones are connected to the constant of these.
    Extrapolation,
    /// The identity is the same when all is made again and another one when a vertex has moved.
    Identity,
    /// `nodes_of` covers every node that a site counts towards, and every node is measured by some element.
    NodesOf,
    /// Sites are finite, have orthonormal frames and depend on `u` as the sampling says.
    Sites,
}

/// A law that is not kept, and where.
#[derive(Clone, Debug)]
pub struct Violation {
    /// The law.
    pub law: Law,
    /// What was found.
    pub found: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}: {}", self.law, self.found)
    }
}

/// Fails with `found` unless the law holds.
fn check(holds: bool, law: Law, found: impl FnOnce() -> String) -> Result<(), Violation> {
    if holds { Ok(()) } else { Err(Violation { law, found: found() }) }
}

/// The scene, which must be sound.
fn built(builder: &SceneBuilder) -> Arc<Scene> {
    Arc::new(builder.clone().build().expect("the scene builds").0)
}

/// Checks that an identity depends on the geometry of the scene and on nothing else.
fn check_identity(builder: &SceneBuilder, of: &dyn Fn(Arc<Scene>) -> Identity) -> Result<(), Violation> {
    let identity = of(built(builder));
    check(identity == of(built(builder)), Law::Identity, || "another one for the same scene".to_owned())?;
    let mut moved = builder.clone();
    let object = &mut moved.objects[0];
    let [vertex, other, _] = object.faces[0].vertices.map(|v| v as usize);
    let edge: Vec3 = object.positions[other] - object.positions[vertex];
    object.positions[vertex] += 1e-3 * edge;
    check(identity != of(built(&moved)), Law::Identity, || "the same one after a vertex moved".to_owned())
}
