//! All settings: one entry each, from which everything that knows settings is made.
//!
//! A new setting is a new entry. Its comment is the help of the command line and of the window; its type is a
//! [`Value`]. It then has a field in [`Settings`] and [`SettingsPatch`], so that files know it, and stands in [`ALL`],
//! so that the command line, the window, validation, comparison and resuming know it.

use super::about::{About, Bounds, Influence};
use super::adaptive::Adaptive;
use super::bounce_limit::BounceLimit;
use super::error::SettingsError;
use super::layers::Layers;
use super::memory::Memory;
use super::point_spacing::PointSpacing;
use super::preset::Preset;
use super::projection::Projection;
use super::schedule_kind::ScheduleKind;
use super::share::Share;
use super::solver_kind::SolverKind;
use super::tail::Tail;
use super::target_error::TargetError;
use super::value::{Choice, Slot, Value};
use lumel_basis::Directional;
use lumel_sample::SamplerKind;
use lumel_transport::{EmitterSampling, LightSampling};
use serde::{Deserialize, Serialize};

/// A setting with a value of type `T`.
pub struct Definition<T> {
    /// What is said about it.
    pub about: About,
    /// Its value in each preset, in the order of [`Preset::ALL`].
    presets: [T; Preset::ALL.len()],
    get: fn(&Settings) -> T,
    slot: fn(&mut Settings) -> &mut T,
    patched: fn(&SettingsPatch) -> Option<T>,
    patch: fn(T) -> SettingsPatch,
}

/// A setting whatever its type.
pub trait Setting: Sync {
    /// What is said about it.
    fn about(&self) -> &About;

    /// The values by name, if there are only a few.
    fn choices(&self) -> &'static [Choice];

    /// The value that its name alone means, if it means one.
    fn implied(&self) -> Option<&'static str>;

    /// What its value is, in a few words to follow "it must be".
    fn expected(&self) -> String;

    /// A patch that sets it alone.
    ///
    /// # Errors
    /// [`SettingsError::Invalid`] for a text that says no value, or one out of bounds.
    fn parse(&self, text: &str) -> Result<SettingsPatch, SettingsError>;

    /// Its value, rounded where that is shorter, in words that [`parse`](Self::parse) understands.
    fn text(&self, settings: &Settings) -> String;

    /// Its value, to be edited.
    fn slot<'a>(&self, settings: &'a mut Settings) -> Slot<'a>;

    /// What its change from one value to the other influences; `None` if both have the same value.
    fn influence(&self, from: &Settings, to: &Settings) -> Option<Influence>;

    /// Whether it has the same value in both.
    fn is_same(&self, a: &Settings, b: &Settings) -> bool {
        self.influence(a, b).is_none()
    }

    /// Takes its value from other settings.
    fn copy(&self, from: &Settings, to: &mut Settings);

    /// Whether a patch sets it.
    fn is_set(&self, patch: &SettingsPatch) -> bool;

    /// Checks its value in a patch that sets it.
    ///
    /// # Errors
    /// [`SettingsError::Invalid`] for a value out of bounds.
    fn check(&self, patch: &SettingsPatch) -> Result<(), SettingsError>;

    /// Whether presets differ in it.
    fn is_by_preset(&self) -> bool {
        let [first, rest @ ..] = Preset::ALL.map(Preset::settings);
        rest.iter().any(|settings| !self.is_same(&first, settings))
    }
}

impl<T: Value> Definition<T> {
    fn invalid(&self, value: String) -> SettingsError {
        SettingsError::Invalid { setting: self.about.name, value, expected: self.expected() }
    }

    fn allows(&self, value: &T) -> bool {
        value.number().is_none_or(|number| self.about.bounds.contain(number))
    }
}

impl<T: Value> Setting for Definition<T> {
    fn about(&self) -> &About {
        &self.about
    }

    fn choices(&self) -> &'static [Choice] {
        T::choices()
    }

    fn implied(&self) -> Option<&'static str> {
        T::implied()
    }

    fn expected(&self) -> String {
        T::expected(self.about.bounds)
    }

    fn parse(&self, text: &str) -> Result<SettingsPatch, SettingsError> {
        let value = T::read(text).filter(|value| self.allows(value));
        value.map(self.patch).ok_or_else(|| self.invalid(format!("\"{text}\"")))
    }

    fn text(&self, settings: &Settings) -> String {
        (self.get)(settings).text()
    }

    fn slot<'a>(&self, settings: &'a mut Settings) -> Slot<'a> {
        (self.slot)(settings).slot()
    }

    fn influence(&self, from: &Settings, to: &Settings) -> Option<Influence> {
        let (from, to) = ((self.get)(from), (self.get)(to));
        (from != to).then(|| from.influence(&to, self.about.influence))
    }

    fn copy(&self, from: &Settings, to: &mut Settings) {
        *(self.slot)(to) = (self.get)(from);
    }

    fn is_set(&self, patch: &SettingsPatch) -> bool {
        (self.patched)(patch).is_some()
    }

    fn check(&self, patch: &SettingsPatch) -> Result<(), SettingsError> {
        match (self.patched)(patch) {
            Some(value) if !self.allows(&value) => Err(self.invalid(value.text())),
            _ => Ok(()),
        }
    }
}

macro_rules! settings {
    ($(
        $(#[doc = $doc:literal])+
        $constant:ident = $field:ident $(| $former:literal)?: $kind:ty {
            presets: $presets:expr,
            $($part:ident: $value:expr,)+
        }
    )+) => {
        /// All settings of a bake; the same settings and scene give the same bits.
        ///
        /// Read from a file, settings that are the same in all presets may be missing.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(try_from = "SettingsPatch")]
        pub struct Settings {
            $($(#[doc = $doc])+ pub $field: $kind,)+
        }

        /// Settings that replace those of a preset.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct SettingsPatch {
            /// The preset to start from.
            #[serde(skip_serializing_if = "Option::is_none")]
            pub preset: Option<Preset>,
            $(
                $(#[doc = $doc])+
                #[serde(skip_serializing_if = "Option::is_none")]
                $(#[serde(alias = $former)])?
                pub $field: Option<$kind>,
            )+
        }

        $(
            $(#[doc = $doc])+
            pub static $constant: Definition<$kind> = Definition {
                about: About {
                    name: stringify!($field),
                    former: &[$($former)?],
                    doc: concat!($($doc, "\n"),+),
                    $($part: $value,)+
                },
                presets: $presets,
                get: |settings| settings.$field,
                slot: |settings| &mut settings.$field,
                patched: |patch| patch.$field,
                patch: |value| SettingsPatch { $field: Some(value), ..SettingsPatch::default() },
            };
        )+

        /// All settings.
        pub static ALL: &[&dyn Setting] = &[$(&$constant),+];

        impl Preset {
            /// The preset's settings.
            pub fn settings(self) -> Settings {
                Settings { $($field: $constant.presets[self as usize],)+ }
            }
        }

        impl SettingsPatch {
            /// What `over` sets, else what `self` sets.
            #[must_use]
            pub fn overridden_by(self, over: Self) -> Self {
                Self { preset: over.preset.or(self.preset), $($field: over.$field.or(self.$field),)+ }
            }

            /// A patch that sets everything, so that its settings are these whatever the presets are.
            pub fn complete(settings: &Settings) -> Self {
                Self { preset: None, $($field: Some(settings.$field),)+ }
            }

            /// The settings: those of the preset with the replacements.
            pub fn settings(&self) -> Settings {
                let preset = self.preset.unwrap_or_default();
                let mut settings = preset.settings();
                $(if let Some(value) = self.$field { settings.$field = value; })+
                settings.adaptive = settings.adaptive.with_error_of(preset);
                settings.point_spacing = settings.point_spacing.with_points_of(preset);
                // A number of bounces that only the preset asks for does not stand in the way of shooting.
                if !settings.tells_bounces() && self.bounces.is_none() {
                    settings.bounces = BounceLimit::All;
                }
                settings
            }
        }
    };
}

/// The same value in each preset.
const fn always<T: Copy>(value: T) -> [T; Preset::ALL.len()] {
    [value; Preset::ALL.len()]
}

/// The most samples per receiver: more than any scene needs, and few enough to be counted exactly.
const MAX_SAMPLES: f64 = 16_777_216.0;

/// More vertices than fit into the memory of most machines.
const MAX_VERTICES_OF_ANY: f64 = 100_000_000.0;

/// With more levels, the coarsest has fewer points than any scene needs.
const MAX_LEVELS: f64 = 10.0;

settings! {
    /// How light becomes values at the vertices.
    ///
    /// What is measured over areas also counts the light between vertices, and carries all of its power from bounce to
    /// bounce. Least squares reads the same measurements more sharply, and may overshoot beside the edges of shadows.
    /// Project files may still use the former name basis, with vertex for point and vertex-area for area.
    PROJECTION = projection | "basis": Projection {
        presets: always(Projection::LeastSquares),
        label: "Projection",
        placeholder: "KIND",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: None,
    }

    /// Carry bounces on points that are scattered over the surfaces, at least so many metres from each other, in place of vertices.
    ///
    /// auto: as many points as suit the preset, 12500 for draft, 50000 for medium and 125000 for production; a number such as
    /// "20000 points": about as many. What carries light then does not depend on how surfaces are cut into triangles: there may be
    /// millions of small ones, or a few large ones. In the end bounces are read at the vertices, where direct light is measured, too, as the
    /// projection says, so that the edges of shadows stay sharp; with a target error it is read from the points as well. Where there are more
    /// vertices than points, surfaces reflect it as the vertices have it.
    POINT_SPACING = point_spacing: PointSpacing {
        presets: always(PointSpacing::Off),
        label: "Points",
        placeholder: "METRES",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: None,
    }

    /// With points: how many levels of them there are, each of half the spacing of the one before it.
    ///
    /// The finest has the spacing that is asked for; all have a third more points than it has alone. Each level stores what light
    /// differs by from what the coarser ones say. Where light is smooth, its error falls faster with the spacing; reading a place takes as many times
    /// as long as there are levels. Levels cannot be used with a target error and with shooting.
    LEVELS = levels: u32 {
        presets: always(1),
        label: "Levels",
        placeholder: "N",
        influence: Influence::Rays,
        bounds: Bounds::Within(1.0, MAX_LEVELS),
        offered: Some([1.0, 6.0]),
    }

    /// Split edges where light needs it, such as 2% or 0.02: how far light may be from a linear function along an edge.
    ///
    /// The error is relative to the light there and meant for edges of a 64th of the scene's diameter; longer ones may hide
    /// less, shorter ones more. Shadows get small triangles, even walls large ones. Without a number, the error is 4 % for
    /// draft, 2 % for medium and 1 % for production. The mesh is taken as it is given, unless a longest edge is asked for. What
    /// is no more than noise splits nothing: more direct samples find finer shadows. With three or more levels of points, the mesh stays as it
    /// is: points of fine levels are measured where coarser ones differ by more than that from what is read without them.
    ADAPTIVE = adaptive: Adaptive {
        presets: always(Adaptive::Off),
        label: "Follow light",
        placeholder: "ERROR",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: Some([0.001, 0.2]),
    }

    /// With a mesh that follows light: its vertices at most; with points that follow light: those measured at most.
    ///
    /// Where light needs more, the edges that need it most are split. Of points, no finer level is measured.
    MAX_VERTICES = max_vertices: u32 {
        presets: always(500_000),
        label: "Vertices",
        placeholder: "N",
        influence: Influence::Rays,
        bounds: Bounds::Within(1.0, MAX_VERTICES_OF_ANY),
        offered: Some([1000.0, 5_000_000.0]),
    }

    /// In which order light is transported.
    ///
    /// Shooting sends the light of the brightest vertices first and ends when less than the remainder of all light is missing. It
    /// sends it along the stored rays, backwards, or where rays are not stored, by shadow rays to points of the surfaces that send it,
    /// which takes longer than gathering. Both orders reach the same light. Shots tell no bounces apart: a solution then has direct
    /// light and all light.
    SCHEDULE = schedule: ScheduleKind {
        presets: always(ScheduleKind::Gather),
        label: "Order",
        placeholder: "KIND",
        influence: Influence::Bounces,
        bounds: Bounds::Any,
        offered: None,
    }

    /// Number of bounces after the direct light, or all: until the rest is negligible.
    BOUNCES = bounces: BounceLimit {
        presets: [BounceLimit::Count(2), BounceLimit::All, BounceLimit::All],
        label: "Bounces",
        placeholder: "N|all",
        influence: Influence::Extent,
        // No scene needs a tenth of them.
        bounds: Bounds::Within(0.0, 10_000.0),
        offered: Some([0.0, 16.0]),
    }

    /// With all bounces, and where light is shot: the share of all light that may be missing.
    REMAINDER = remainder: f32 {
        presets: [1e-2, 1e-2, 1e-3],
        label: "Remainder",
        placeholder: "SHARE",
        influence: Influence::Extent,
        bounds: Bounds::Between(0.0, 1.0),
        offered: Some([1e-5, 0.5]),
    }

    /// What to add for the light that is not computed.
    ///
    /// After shooting, that is the ambient term: as much on all surfaces as the light that is unshot would bring on average.
    TAIL = tail: Tail {
        presets: always(Tail::Auto),
        label: "Later bounces",
        placeholder: "KIND",
        influence: Influence::Sum,
        bounds: Bounds::Any,
        offered: None,
    }

    /// Which parts of the light to tell apart: the solution then has one layer for each light.
    ///
    /// Layers add up to all light. Lights, emissive materials and the sky each make one; what shares a name makes one
    /// together. On stored rays, a layer costs its shadow rays and no further hemisphere ray. A final gather and the solver
    /// neumann trace their rays for each layer. Cannot be used with a target error.
    LAYERS = layers: Layers {
        presets: always(Layers::Off),
        label: "Layers",
        placeholder: "KIND",
        influence: Influence::Sum,
        bounds: Bounds::Any,
        offered: None,
    }

    /// What to keep of where light comes from, for normal maps.
    ///
    /// Irradiance stays what it is, bit by bit. Beside it are coefficients of the light that arrives, which are measured once in the
    /// end, of all light and of each layer: by a quarter of the shadow rays and hemisphere rays that the settings say, which are
    /// spread over directions more evenly.
    DIRECTIONAL = directional: Directional {
        presets: always(Directional::Off),
        label: "Directional",
        placeholder: "KIND",
        influence: Influence::Sum,
        bounds: Bounds::Any,
        offered: None,
    }

    /// Shadow rays per vertex and light.
    DIRECT_SAMPLES = direct_samples: u32 {
        presets: [16, 64, 256],
        label: "Direct samples",
        placeholder: "N",
        influence: Influence::Bounces,
        bounds: Bounds::Within(1.0, MAX_SAMPLES),
        offered: Some([1.0, 4096.0]),
    }

    /// Hemisphere rays per vertex and bounce.
    INDIRECT_SAMPLES = indirect_samples: u32 {
        presets: [64, 256, 1024],
        label: "Indirect samples",
        placeholder: "N",
        influence: Influence::Rays,
        bounds: Bounds::Within(1.0, MAX_SAMPLES),
        offered: Some([1.0, 65536.0]),
    }

    /// How sample points are distributed.
    SAMPLER = sampler: SamplerKind {
        presets: always(SamplerKind::Sobol),
        label: "Sampler",
        placeholder: "NAME",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: None,
    }

    /// How area lights are sampled.
    LIGHT_SAMPLING = light_sampling: LightSampling {
        presets: always(LightSampling::Analytic),
        label: "Light sampling",
        placeholder: "KIND",
        influence: Influence::Bounces,
        bounds: Bounds::Any,
        offered: None,
    }

    /// How light from emissive surfaces is found.
    EMITTERS = emitters: EmitterSampling {
        presets: always(EmitterSampling::Auto),
        label: "Emissive",
        placeholder: "KIND",
        influence: Influence::Bounces,
        bounds: Bounds::Any,
        offered: None,
    }

    /// How bounces are computed.
    SOLVER = solver: SolverKind {
        presets: always(SolverKind::Cached),
        label: "Solver",
        placeholder: "KIND",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: None,
    }

    /// Memory for stored rays, such as 500MB or 2GiB.
    ///
    /// If not all rays fit, fewer are stored, and all light is gathered once more at the end.
    MEMORY = memory: Memory {
        // On every machine: what is computed must not depend on where.
        presets: always(Memory(2 << 30)),
        label: "Memory",
        placeholder: "SIZE",
        influence: Influence::Storage,
        bounds: Bounds::Any,
        offered: None,
    }

    /// Add samples until values are known to within this, such as 1% or 0.01: half of their 95 % confidence interval,
    /// relative.
    ///
    /// Eight independent solves share the samples; their spread gives the standard error of every value, which is kept
    /// in the solution. Vertices whose error is too large get more samples, up to 64 times the initial number and as
    /// many rays as the memory allows. Values darker than a tenth of the mean are compared with the mean.
    TARGET_ERROR = target_error: TargetError {
        presets: always(TargetError::Off),
        label: "Error",
        placeholder: "SHARE|off",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: Some([0.001, 0.5]),
    }

    /// With a target error: the share of values that must meet it.
    TARGET_SHARE = target_share: Share {
        presets: always(Share::MOST),
        label: "Share of values",
        placeholder: "SHARE",
        influence: Influence::Bounces,
        bounds: Bounds::Any,
        offered: Some([0.5, 0.999]),
    }

    /// Seed of all random choices.
    SEED = seed: u64 {
        presets: always(0),
        label: "Seed",
        placeholder: "N",
        influence: Influence::Rays,
        bounds: Bounds::Any,
        offered: None,
    }
}

impl Default for Settings {
    fn default() -> Self {
        Preset::default().settings()
    }
}

impl TryFrom<SettingsPatch> for Settings {
    type Error = SettingsError;

    fn try_from(patch: SettingsPatch) -> Result<Self, SettingsError> {
        let is_missing = |setting: &&&dyn Setting| setting.is_by_preset() && !setting.is_set(&patch);
        match ALL.iter().find(is_missing) {
            Some(setting) if patch.preset.is_none() => {
                Err(SettingsError::Missing { setting: setting.about().name })
            }
            _ => Ok(patch.settings()),
        }
    }
}

#[cfg(test)]
mod tests;
