//! Places for the light of all surfaces: charts, the atlas they are packed into, and what each lumel covers.
//!
//! [`unwrap`] makes an [`Atlas`] of a scene and [`check`]s it. Every triangle that is lit has lumels of its own: the back
//! of a two-sided surface lies in other lumels than its front, and so does every instance of a mesh. [`Coverage`] then
//! says which parts of which triangles lie in each lumel.
//!
//! Coordinates on a page are in lumels: the centre of lumel (x, y) is at (x + ½, y + ½), and y runs down, as rows of an
//! image do. All triangles have a positive area there, but for layouts that files give, which are kept as they are.

mod atlas;
mod atlas_parts;
mod chart;
mod check;
mod clip;
mod conformal;
mod coverage;
mod cut;
mod error;
mod given;
mod lay_out;
mod mask;
mod merge;
mod middles;
mod object;
mod overlap;
mod pack;
mod page;
mod patches;
mod planar;
mod raster;
mod rectangle;
mod refined;
mod report;
mod settings;
mod shared;
mod slight;
#[cfg(test)]
mod testing;
mod topology;
mod unfold;
mod unwrap;

pub use atlas::{Atlas, ChartPlace};
pub use atlas_parts::AtlasParts;
pub use check::{Fault, check};
pub use coverage::{Coverage, Piece, Share};
pub use error::UvError;
pub use report::{Finding, Method, ObjectReport, Report};
pub use settings::{Density, GivenUvs, MAX_PAGE, Pace, UnwrapSettings};
pub use unwrap::{Unwrapped, unwrap};
