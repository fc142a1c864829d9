//! What users choose. The table of all settings is in `table.rs`; their types have files of their own.

mod about;
mod adaptive;
mod bounce_limit;
mod compare;
mod directional;
mod error;
mod layers;
mod memory;
mod number_or_text;
mod plan;
mod preset;
mod projection;
mod sampling;
mod schedule_kind;
mod share;
mod solver_kind;
pub(crate) mod table;
mod tail;
mod target_error;
mod validate;
mod value;

pub use about::{About, Bounds, Influence};
pub use adaptive::Adaptive;
pub use bounce_limit::BounceLimit;
pub use error::SettingsError;
pub use layers::Layers;
pub use memory::Memory;
pub use preset::Preset;
pub use projection::Projection;
pub use schedule_kind::ScheduleKind;
pub use share::Share;
pub use solver_kind::SolverKind;
pub use table::{Settings, SettingsPatch};
pub use tail::Tail;
pub use target_error::TargetError;
pub use value::{Choice, Slot, Value};
