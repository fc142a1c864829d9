//! What users choose.

mod basis_kind;
mod bounce_limit;
mod memory;
mod number_or_text;
mod preset;
mod share;
mod solver_kind;
mod table;
mod tail;
mod target_error;

pub use basis_kind::BasisKind;
pub use bounce_limit::BounceLimit;
pub use memory::Memory;
pub use preset::Preset;
pub use share::Share;
pub use solver_kind::SolverKind;
pub use table::{Settings, SettingsPatch};
pub use tail::Tail;
pub use target_error::TargetError;
