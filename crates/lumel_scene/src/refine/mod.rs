//! Finer triangles where somebody asks for them: bisection of a scene's triangles, in barycentric space.
//!
//! A [`Bisection`] is a mesh that is being refined; [`Scene::refined`](crate::Scene::refined) makes a scene of what it
//! [split](Bisection::splits), whose [`Refinement`] leads from the triangles of the one to those of the other.

mod bisection;
mod parts;
mod refined;
mod refinement;
#[cfg(test)]
mod tests;

pub use bisection::Bisection;
pub use parts::Part;
pub use refinement::Refinement;
