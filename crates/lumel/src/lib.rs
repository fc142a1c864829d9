//! Diffuse global illumination for meshes: open or build a scene, bake it, read the light.
//!
//! [`Bake`] is the way in: fifteen lines from arrays to irradiance. [`open`] reads scenes from files. [`Baker`] is for
//! programs that follow a solve, stop and resume it, or light the same surfaces again and again. What each crate below
//! does, for bases, transports and schedules of your own, is in ARCHITECTURE.md.
//!
//! ```
//! use lumel::{Bake, OpenOptions};
//!
//! let opened = lumel::open("furnace", &OpenOptions::default())?;
//! let baked = Bake::new(opened.builder).settings(opened.settings).bounces(1).run()?;
//! let solution = baked.solution();
//! assert_eq!(solution.irradiance.len(), solution.positions.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
mod assembly;
mod at_vertices;
mod bake;
mod baker;
mod bounce_basis;
mod camera_entry;
mod dark;
mod decimal;
mod difference;
mod direct_at_vertices;
mod error_estimate;
mod file_format;
mod first_look;
mod gated;
mod layers;
mod length;
mod light_entry;
mod light_file;
mod light_findings;
mod light_reader;
mod lightmap_entry;
mod lumels;
mod max_edge;
mod measure;
mod memory_need;
mod method;
mod occlusion;
mod occlusion_entry;
mod open;
mod places;
mod point_levels;
mod progress;
mod project;
mod reading;
mod resume;
mod samples;
mod settings;
mod sky_entry;
mod solved_lumels;
pub mod spec;
mod suggestion;
mod surfaces;
mod target;
mod two_sided;
mod words;
mod workload;

pub use adaptive::{Adapted, RefinementEnd, Refining};
pub use bake::{Bake, BakeError, Baked};
pub use baker::Baker;
pub use bounce_basis::BounceBasis;
pub use camera_entry::CameraEntry;
pub use decimal::decimal;
pub use difference::{Difference, Percentiles};
pub use error_estimate::{ErrorCause, ErrorEstimate};
pub use file_format::{FileFormat, SaveError};
pub use gated::gated;
pub use glam::{self, Vec3};
pub use layers::{LightLayer, light_layers};
pub use length::metres;
pub use light_entry::{LightEntry, LightKind};
pub use light_file::{Fitting, LightFile, LightFileError};
pub use light_findings::LightFinding;
pub use light_reader::LightReader;
pub use lightmap_entry::{LightBasis, LightmapEntry, UvChoice};
pub use lumel_accel::{Bvh, RayTracer, SeeThrough, tracer_of};
pub use lumel_basis::{
    Basis, Coefficients, Directional, Field, FieldLighting, IncidentRadiance, Lighting, Moment,
    PointReceivers, Shading, VertexCountError, VertexLighting,
};
pub use lumel_export::{
    Checkpoint, LightmapSolution, LightmapTarget, LumelState, RadFile, RefinementState, Saved,
    ScatteredLight, Solution, SolutionLayer, SolutionSelection,
};
pub use lumel_import::PathPolicy;
pub use lumel_lightmap::{Lightmap, LightmapLayer, LumelLight, SolvedLight};
pub use lumel_sample::SamplerKind;
pub use lumel_scene::{
    AlphaMode, Bisection, Camera, DirectionalLight, DiskLight, Face, FaceSide, Irradiance, Light, Material,
    MaterialId, ObjectId, ObjectMesh, PointLight, Radiance, RectLight, Scene, SceneBuilder, SceneError,
    Sides, Sky, SkyGradient, SkyImage, Smoothing, SphereLight, SpotLight, SunLight, Texture, TextureId,
    TextureRef, Transparency, Warnings,
};
pub use lumel_solve::{Accuracy, CONFIDENCE_95, Ended, Errors, Target};
pub use lumel_solve::{Observer, Silent, Snapshot, SolveError, SolveState, Step, mix};
pub use lumel_transport::{
    AmbientOcclusion, Control, Emitter, EmitterMask, EmitterSampling, LightSampling, TransportError,
};
pub use lumels::{LumelAccuracy, LumelParts, Lumels, PartDone};
pub use max_edge::MaxEdge;
pub use measure::{PointMeasurement, measure_points, vertex_errors};
pub use method::Method;
pub use occlusion_entry::OcclusionEntry;
pub use open::{AutoEdge, OpenError, OpenOptions, Opened, open};
pub use progress::{Progress, Tracker};
pub use project::{MaterialEntry, ObjectEntry, Project, ProjectError, SlotEntry};
pub use reading::Reading;
pub use resume::ResumeError;
pub use settings::{
    Adaptive, BounceLimit, Layers, Memory, PointNeed, PointSpacing, Preset, Projection, ScheduleKind,
    Settings, SettingsError, SettingsPatch, Share, SolverKind, Tail, TargetError,
};
pub use sky_entry::{GradientEntry, SkyEntry, SkyImageEntry};
pub use suggestion::{is_open, suggested_light};
pub use words::{counted, ray_rate};
pub use workload::Remainder;

/// The table of all settings: names, help, bounds and defaults, for programs that let users choose them.
pub mod setting {
    pub use crate::settings::table::*;
    pub use crate::settings::{About, Bounds, Choice, Influence, Slot, Value};
}
