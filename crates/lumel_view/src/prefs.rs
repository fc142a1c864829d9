//! Preferences, kept between runs.

use crate::layout::LumelSettings;
use crate::relief::ReliefPrefs;
use crate::selection::Selection;
use lumel::{Directional, Moment, Settings};
use lumel_lightmap::Filter;
use lumel_render_cpu::{Scale, ToneMapper};
use serde::{Deserialize, Serialize};

/// What surfaces show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ViewMode {
    /// Albedo times light, as the eye would see it.
    #[default]
    Final,
    /// Light on white surfaces.
    Irradiance,
    /// The share that surfaces reflect.
    Albedo,
    /// Where surfaces look.
    Normals,
    /// Light as colours with a legend.
    FalseColor,
    /// Standard error of the light, as colours.
    StandardError,
    /// Vertices that could not be measured.
    Validity,
    /// Length of the edges, as colours.
    TriangleSize,
    /// What is still to be reflected, as colours.
    Unshot,
    /// How far light is from linear between vertices, over what it may be, as colours.
    Bends,
    /// Lumels per metre, as colours.
    LumelDensity,
    /// Squares of lumels.
    Chequerboard,
    /// The charts of the lightmap.
    Charts,
    /// Lumels along the seams of charts.
    Seams,
    /// What is known of light by direction.
    Moment(Moment),
}

/// What there is to be looked at besides light and surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// Whether there is a lightmap.
    pub lumels: bool,
    /// What is known of light by direction.
    pub directional: Directional,
}

impl ViewMode {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 24] = [
        Self::Final,
        Self::Irradiance,
        Self::Albedo,
        Self::Normals,
        Self::FalseColor,
        Self::StandardError,
        Self::Unshot,
        Self::Validity,
        Self::TriangleSize,
        Self::Bends,
        Self::LumelDensity,
        Self::Chequerboard,
        Self::Charts,
        Self::Seams,
        Self::Moment(Moment::Direction),
        Self::Moment(Moment::Sh0),
        Self::Moment(Moment::Sh1),
        Self::Moment(Moment::Sh2),
        Self::Moment(Moment::Sh3),
        Self::Moment(Moment::Sh4),
        Self::Moment(Moment::Sh5),
        Self::Moment(Moment::Sh6),
        Self::Moment(Moment::Sh7),
        Self::Moment(Moment::Sh8),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Final => "Final colour",
            Self::Irradiance => "Irradiance",
            Self::Albedo => "Albedo",
            Self::Normals => "Normals",
            Self::FalseColor => "False colour",
            Self::StandardError => "Standard error",
            Self::Unshot => "Unshot power",
            Self::Validity => "Validity",
            Self::TriangleSize => "Triangle size",
            Self::Bends => "Bends of light",
            Self::LumelDensity => "Lumel density",
            Self::Chequerboard => "Chequerboard",
            Self::Charts => "Charts",
            Self::Seams => "Seams",
            Self::Moment(Moment::Direction) => "Light direction",
            Self::Moment(coefficient) => coefficient.name(),
        }
    }

    /// What it shows.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Final => "Radiance: albedo × irradiance / π, plus emission",
            Self::Irradiance => "Irradiance, as on white surfaces",
            Self::Albedo => "The fraction of light that surfaces reflect",
            Self::Normals => "Surface normals: red +X, green +Y, blue +Z",
            Self::FalseColor => "Luminance of the irradiance in false colours, with a legend",
            Self::StandardError => {
                "Standard error of the irradiance at each vertex or lumel, where it was measured"
            }
            Self::Unshot => {
                "Light that has arrived and is still to be reflected, as radiosity: what shoots next is the brightest; after \
                 gathering, the last bounce"
            }
            Self::Validity => {
                "Red vertices or lumels lie inside geometry; their light is extrapolated from neighbours"
            }
            Self::TriangleSize => "Mean edge length around each vertex, in false colours",
            Self::Bends => {
                "By how much light bends along the edges around each vertex, over what it may: edges above 1 are split \
                 where the mesh follows light"
            }
            Self::LumelDensity => "Lumels per metre, in false colours",
            Self::Chequerboard => {
                "Squares of 8 × 8 lumels; squares that are none show where charts are stretched"
            }
            Self::Charts => "Parts of the surface that lie together on a page of the lightmap",
            Self::Seams => "Lumels along smooth edges that the lightmap cuts",
            Self::Moment(moment) => moment.text(),
        }
    }

    /// Whether a legend explains its colours.
    pub fn has_legend(self) -> bool {
        match self {
            Self::FalseColor
            | Self::StandardError
            | Self::Unshot
            | Self::TriangleSize
            | Self::Bends
            | Self::LumelDensity => true,
            Self::Moment(moment) => moment.harmonic().is_some(),
            _ => false,
        }
    }

    /// Those that show something of what is known.
    pub fn offered(known: Known) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |mode| match mode {
            Self::Moment(moment) => moment.is_in(known.directional),
            mode => known.lumels || !mode.needs_lumels(),
        })
    }

    /// Whether it shows light, which normal maps and ripples tilt.
    pub fn is_light(self) -> bool {
        matches!(self, Self::Final | Self::Irradiance | Self::FalseColor)
    }

    /// Whether it shows nothing without a lightmap.
    pub fn needs_lumels(self) -> bool {
        matches!(self, Self::LumelDensity | Self::Chequerboard | Self::Charts | Self::Seams)
    }

    /// Whether exposure and tone mapping matter.
    pub fn is_exposed(self) -> bool {
        matches!(self, Self::Final | Self::Irradiance)
    }
}

/// How light is read between lumels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LumelFilter {
    /// Each lumel is a square.
    Nearest,
    /// Linear between four.
    #[default]
    Bilinear,
    /// Smooth between sixteen.
    Bicubic,
}

impl LumelFilter {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Nearest, Self::Bilinear, Self::Bicubic];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nearest => "Nearest",
            Self::Bilinear => "Bilinear",
            Self::Bicubic => "Bicubic",
        }
    }
}

impl From<LumelFilter> for Filter {
    fn from(filter: LumelFilter) -> Self {
        match filter {
            LumelFilter::Nearest => Self::Nearest,
            LumelFilter::Bilinear => Self::Bilinear,
            LumelFilter::Bicubic => Self::Bicubic,
        }
    }
}

/// What false colours are labelled with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// Irradiance, W/m².
    #[default]
    Watts,
    /// Illuminance: irradiance times the luminous efficacy.
    Lux,
    /// Doublings of 1 W/m².
    Stops,
}

impl Unit {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Watts, Self::Lux, Self::Stops];

    /// Its symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Watts => "W/m²",
            Self::Lux => "lux",
            Self::Stops => "stops",
        }
    }
}

/// What the plot of convergence shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PlotKind {
    /// What each bounce of the last solve brought.
    #[default]
    Bounces,
    /// What was still to come at each time of the last two solves.
    Time,
}

/// How the picture is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewPrefs {
    /// What surfaces show.
    pub mode: ViewMode,
    /// Which bounces.
    pub selection: Selection,
    /// Whether what is still to come is added on average while a solve is not finished.
    pub ambient: bool,
    /// Whether the exposure follows the picture.
    pub auto_exposure: bool,
    /// The exposure when it does not, stops.
    pub stops: f32,
    /// The tone mapper's name.
    pub tone: String,
    /// The luminance that the Reinhard tone mapper makes white.
    pub white: f32,
    /// Edges of triangles.
    pub wireframe: bool,
    /// Borders of lumels.
    pub grid: bool,
    /// How light is read between lumels.
    pub filter: LumelFilter,
    /// Dots where light is measured.
    pub sample_points: bool,
    /// Rays of the picked vertex.
    pub rays: bool,
    /// Dots where the most light is still to be reflected.
    pub shooters: bool,
    /// A grid on the ground of open scenes.
    pub ground: bool,
    /// The lights' outlines and handles.
    pub gizmo: bool,
    /// Smooth edges by four samples.
    pub antialias: bool,
    /// The unit of false colours.
    pub unit: Unit,
    /// Lumens per watt of the lights' spectrum; 1 for scenes with photometric lights.
    pub efficacy: f32,
    /// Whether the range of false colours follows the light.
    pub auto_range: bool,
    /// The range when it does not, W/m².
    pub range: [f32; 2],
    /// Equal steps for equal ratios.
    pub logarithmic: bool,
    /// What the plot of convergence shows.
    pub plot: PlotKind,
    /// How normal maps and ripples are shown.
    pub relief: ReliefPrefs,
}

impl Default for ViewPrefs {
    fn default() -> Self {
        Self {
            mode: ViewMode::default(),
            selection: Selection::default(),
            ambient: true,
            auto_exposure: true,
            stops: 0.0,
            tone: ToneMapper::default().to_string(),
            white: ToneMapper::DEFAULT_WHITE,
            wireframe: false,
            grid: false,
            filter: LumelFilter::default(),
            sample_points: false,
            rays: true,
            shooters: false,
            ground: true,
            gizmo: true,
            antialias: true,
            unit: Unit::default(),
            // White light of equal energy, as Ward's Radiance has it.
            efficacy: 179.0,
            auto_range: true,
            range: [0.0, 1.0],
            logarithmic: false,
            plot: PlotKind::default(),
            relief: ReliefPrefs::default(),
        }
    }
}

impl ViewPrefs {
    /// The tone mapper.
    pub fn tone(&self) -> ToneMapper {
        self.tone.parse().unwrap_or_default()
    }

    /// How the range of false colours is divided.
    pub fn scale(&self) -> Scale {
        // Half and twice a density are as far from it.
        match self.mode {
            ViewMode::LumelDensity | ViewMode::Bends => Scale::Log,
            // Coefficients have both signs.
            ViewMode::Moment(_) => Scale::Linear,
            _ if self.logarithmic => Scale::Log,
            _ => Scale::Linear,
        }
    }
}

/// Everything that is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Prefs {
    /// Changes when older ones can no longer be read.
    pub version: u32,
    /// Scenes opened last, the last one first.
    pub recent: Vec<String>,
    /// Settings of the solve.
    pub settings: Settings,
    /// Whether there is to be a lightmap, and how fine.
    pub lumels: LumelSettings,
    /// Whether the light follows changes of the lights.
    pub live: bool,
    /// How the picture is drawn.
    pub view: ViewPrefs,
    /// How fast one flies, relative to the scene's size.
    pub speed: f32,
    /// How fast one looks around, degrees per point dragged.
    pub look_speed: f32,
}

/// More scenes than this are forgotten.
const MAX_RECENT: usize = 10;

/// The version of [`Prefs`].
const VERSION: u32 = 1;

impl Default for Prefs {
    fn default() -> Self {
        Self {
            version: VERSION,
            recent: Vec::new(),
            settings: Settings::default(),
            lumels: LumelSettings::default(),
            live: true,
            view: ViewPrefs::default(),
            speed: 1.0,
            look_speed: 0.25,
        }
    }
}

impl Prefs {
    /// What was kept, with what makes no sense made good.
    pub fn checked(mut self) -> Self {
        let default = Self::default();
        if self.version != VERSION {
            return default;
        }
        let sensible = |value: f32, lo: f32, hi: f32, default: f32| {
            if (lo..=hi).contains(&value) { value } else { default }
        };
        self.speed = sensible(self.speed, SPEED[0], SPEED[1], default.speed);
        self.look_speed = sensible(self.look_speed, 0.01, 2.0, default.look_speed);
        self.view.stops = sensible(self.view.stops, -100.0, 100.0, 0.0);
        self.view.white = sensible(self.view.white, 0.1, 1e3, default.view.white);
        self.view.efficacy = sensible(self.view.efficacy, 1e-3, 1e4, default.view.efficacy);
        if !self.view.range.iter().all(|x| x.is_finite()) || self.view.range[0] >= self.view.range[1] {
            self.view.range = default.view.range;
        }
        self.view.relief = self.view.relief.mended();
        self.settings = self.settings.mended();
        self.lumels = self.lumels.mended();
        self
    }

    /// Puts a scene first among those opened last.
    pub fn opened(&mut self, name: &str) {
        self.recent.retain(|old| old != name);
        self.recent.insert(0, name.to_owned());
        self.recent.truncate(MAX_RECENT);
    }
}

/// The range of the flying speed, relative to the scene.
pub const SPEED: [f32; 2] = [0.01, 100.0];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_no_sense_is_made_good() {
        let mut prefs = Prefs { speed: f32::NAN, look_speed: -1.0, ..Prefs::default() };
        prefs.view.range = [3.0, 2.0];
        prefs.view.tone = "sepia".into();
        prefs.settings.indirect_samples = 0;
        let good = prefs.checked();
        assert_eq!((good.speed, good.look_speed, good.view.range), (1.0, 0.25, [0.0, 1.0]));
        assert_eq!(good.view.tone(), ToneMapper::default());
        assert_eq!(good.settings, Settings::default());
        assert_eq!(Prefs { version: 0, speed: 3.0, ..Prefs::default() }.checked(), Prefs::default());
    }

    #[test]
    fn scenes_opened_last_come_first_and_once() {
        let mut prefs = Prefs::default();
        ["a", "b", "a"].iter().for_each(|name| prefs.opened(name));
        assert_eq!(prefs.recent, ["a", "b"]);
        (0..20).for_each(|i| prefs.opened(&i.to_string()));
        assert_eq!(prefs.recent.len(), MAX_RECENT);
    }
}
