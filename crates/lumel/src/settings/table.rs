//! What users choose.

use super::{BasisKind, BounceLimit, Memory, Preset, Share, SolverKind, Tail, TargetError};
use lumel_sample::SamplerKind;
use lumel_solve::Stop;
use lumel_transport::{EmitterSampling, LightSampling, Plan};
use serde::{Deserialize, Serialize};

/// All settings of a bake; the same settings and scene give the same bits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Where light is stored.
    pub basis: BasisKind,
    /// How many bounces.
    pub bounces: BounceLimit,
    /// With [`BounceLimit::All`]: the share of all light that may be missing.
    pub remainder: f32,
    /// What stands for the missing bounces.
    pub tail: Tail,
    /// Shadow rays per receiver and light.
    pub direct_samples: u32,
    /// Hemisphere rays per receiver and bounce.
    pub indirect_samples: u32,
    /// Where sample points come from.
    pub sampler: SamplerKind,
    /// The estimator for lights with an area.
    pub light_sampling: LightSampling,
    /// What emissive surfaces do.
    pub emitters: EmitterSampling,
    /// How bounces are computed.
    #[serde(default)]
    pub solver: SolverKind,
    /// Memory for stored rays; it decides on how many are stored.
    #[serde(default)]
    pub memory: Memory,
    /// The error to stop at. Samples are then those to begin with, and `solver` has no effect: rays are stored.
    #[serde(default)]
    pub target_error: TargetError,
    /// With a target error: the share of values that must be below.
    #[serde(default)]
    pub target_share: Share,
    /// Changes all random choices.
    pub seed: u64,
}

/// More bounces than this are never computed: at the largest albedo allowed, 0.98, the light that is left then is
/// below a thousandth.
const MAX_BOUNCES: u32 = 400;

impl Preset {
    /// All presets, from fast to good.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Medium, Self::Production];

    /// The preset's settings.
    pub fn settings(self) -> Settings {
        let (bounces, direct_samples, indirect_samples) = match self {
            Self::Draft => (BounceLimit::Count(2), 16, 64),
            Self::Medium => (BounceLimit::Count(4), 64, 256),
            Self::Production => (BounceLimit::All, 256, 1024),
        };
        Settings {
            basis: BasisKind::default(),
            bounces,
            remainder: 1e-3,
            tail: Tail::default(),
            direct_samples,
            indirect_samples,
            sampler: SamplerKind::default(),
            light_sampling: LightSampling::default(),
            emitters: EmitterSampling::default(),
            solver: SolverKind::default(),
            memory: Memory::default(),
            target_error: TargetError::default(),
            target_share: Share::default(),
            seed: 0,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Preset::default().settings()
    }
}

impl Settings {
    /// The sampling part.
    pub fn plan(&self) -> Plan {
        Plan {
            sampler: self.sampler,
            direct_samples: self.direct_samples,
            indirect_samples: self.indirect_samples,
            seed: self.seed,
            light_sampling: self.light_sampling,
            emitters: self.emitters,
            second_half: false,
        }
    }

    /// When to stop.
    pub fn stop(&self) -> Stop {
        match self.bounces {
            BounceLimit::Count(n) => Stop::Bounces(n),
            BounceLimit::All => Stop::Remainder { fraction: self.remainder, at_most: MAX_BOUNCES },
        }
    }

    /// Whether bounces computed with `other` are the very bounces these settings ask for.
    ///
    /// How many there are to be does not matter for that, nor does memory as long as there is enough.
    pub fn same_bounces_as(&self, other: &Self) -> bool {
        let Self { bounces, remainder, tail, memory, .. } = self.clone();
        *self == Self { bounces, remainder, tail, memory, ..other.clone() }
    }

    /// In which settings `found` differs from these so that bounces differ too, as a list for a message.
    pub(crate) fn differences_of_bounces(&self, found: &Self) -> String {
        let table = |settings: &Self| match serde_json::to_value(settings) {
            Ok(serde_json::Value::Object(table)) => table,
            _ => serde_json::Map::new(),
        };
        let (here, there) = (table(self), table(found));
        let matters = |name: &str| !["bounces", "remainder", "tail"].contains(&name);
        let differing = here.iter().filter(|(name, value)| matters(name) && there.get(*name) != Some(value));
        let text = |value: &serde_json::Value| value.to_string().replace('"', "");
        let phrases = differing.map(|(name, value)| {
            let found = there.get(name).map_or_else(|| "none".to_owned(), text);
            format!("{} {found}, not {}", name.replace('_', " "), text(value))
        });
        phrases.collect::<Vec<_>>().join("; ")
    }
}

macro_rules! patch {
    ($($(#[$doc:meta])* $field:ident: $kind:ty,)*) => {
        /// Settings that replace those of a preset.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct SettingsPatch {
            /// The preset to start from.
            #[serde(skip_serializing_if = "Option::is_none")]
            pub preset: Option<Preset>,
            $($(#[$doc])*
            #[serde(skip_serializing_if = "Option::is_none")]
            pub $field: Option<$kind>,)*
        }

        impl SettingsPatch {
            /// What `over` sets, else what `self` sets.
            #[must_use]
            pub fn overridden_by(self, over: Self) -> Self {
                Self { preset: over.preset.or(self.preset), $($field: over.$field.or(self.$field),)* }
            }

            /// A patch that sets everything, so that its settings are these whatever the presets are.
            pub fn complete(settings: &Settings) -> Self {
                Self { preset: None, $($field: Some(settings.$field),)* }
            }

            /// The settings: those of the preset with the replacements.
            pub fn settings(&self) -> Settings {
                let mut settings = self.preset.unwrap_or_default().settings();
                $(if let Some(value) = self.$field { settings.$field = value; })*
                settings
            }
        }
    };
}

patch! {
    /// Where light is stored.
    basis: BasisKind,
    /// How many bounces.
    bounces: BounceLimit,
    /// The share of all light that may be missing after all bounces.
    remainder: f32,
    /// What stands for the missing bounces.
    tail: Tail,
    /// Shadow rays per receiver and light.
    direct_samples: u32,
    /// Hemisphere rays per receiver and bounce.
    indirect_samples: u32,
    /// Where sample points come from.
    sampler: SamplerKind,
    /// The estimator for lights with an area.
    light_sampling: LightSampling,
    /// What emissive surfaces do.
    emitters: EmitterSampling,
    /// How bounces are computed.
    solver: SolverKind,
    /// Memory for stored rays.
    memory: Memory,
    /// The error to stop at.
    target_error: TargetError,
    /// The share of values that must be below.
    target_share: Share,
    /// Changes all random choices.
    seed: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_settings_win_over_earlier_ones_and_over_the_preset() {
        let file: SettingsPatch =
            serde_json::from_str(r#"{"preset": "draft", "bounces": "all", "direct_samples": 7}"#).unwrap();
        let flags = SettingsPatch { bounces: Some(BounceLimit::Count(9)), ..SettingsPatch::default() };
        let settings = file.overridden_by(flags).settings();
        assert_eq!((settings.bounces, settings.direct_samples), (BounceLimit::Count(9), 7));
        assert_eq!(settings.indirect_samples, Preset::Draft.settings().indirect_samples);
    }

    #[test]
    fn settings_survive_a_round_trip() {
        for preset in Preset::ALL {
            let settings = preset.settings();
            let text = serde_json::to_string(&settings).unwrap();
            assert_eq!(serde_json::from_str::<Settings>(&text).unwrap(), settings);
        }
    }

    #[test]
    fn unknown_settings_are_refused() {
        let error = serde_json::from_str::<SettingsPatch>(r#"{"bounce": 3}"#).unwrap_err();
        assert!(error.to_string().contains("unknown field `bounce`"), "{error}");
    }

    #[test]
    fn differences_are_told_by_name() {
        let here = Preset::Medium.settings();
        let there =
            Settings { seed: 7, basis: BasisKind::VertexArea, bounces: BounceLimit::All, ..here.clone() };
        assert_eq!(here.differences_of_bounces(&there), "basis vertex-area, not vertex; seed 7, not 0");
    }

    #[test]
    fn the_number_of_bounces_does_not_change_what_each_of_them_is() {
        let a = Preset::Medium.settings();
        assert!(a.same_bounces_as(&Settings {
            bounces: BounceLimit::All,
            tail: Tail::Geometric,
            ..a.clone()
        }));
        assert!(!a.same_bounces_as(&Settings { seed: 1, ..a.clone() }));
        assert!(!a.same_bounces_as(&Settings { basis: BasisKind::VertexArea, ..a.clone() }));
    }
}
