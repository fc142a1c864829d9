//! Settings of the solve, as the table of all settings has them.

use super::shared::Tessellation;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use lumel::setting::{self, Choice, EMITTERS, Setting, Value as _};
use lumel::{Adaptive, EmitterSampling, Preset, SettingsPatch};

/// What the help lists them under.
const HEADING: &str = "Settings";

/// Former names of settings that are options of their own now.
const TAKEN: [&str; 1] = ["basis"];

/// The name of the option for a preset.
const PRESET: &str = "preset";

/// The name of the option for what [`EMITTERS`] is most often set to.
const NO_EMISSIVE: &str = "no_emissive";

/// Settings of the solve: the options `--preset`, one for each setting, and `--no-emissive`.
#[derive(Clone, Debug, Default)]
pub(crate) struct SettingsArgs {
    /// The settings that were given.
    pub(crate) patch: SettingsPatch,
}

impl SettingsArgs {
    /// What these settings say of how finely scenes are tessellated.
    pub(crate) fn tessellation(&self) -> Tessellation {
        Tessellation {
            vertex_budget: self.patch.preset.map(Preset::vertex_budget),
            adaptive: self.patch.adaptive.map(|adaptive| adaptive != Adaptive::Off),
            splits: Vec::new(),
        }
    }
}

impl Args for SettingsArgs {
    fn augment_args(command: Command) -> Command {
        setting::ALL.iter().fold(command.arg(preset()), |command, setting| {
            let command = command.arg(option(*setting));
            if setting.about().name == EMITTERS.about.name { command.arg(no_emissive()) } else { command }
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SettingsArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut args = Self::default();
        args.update_from_arg_matches(matches)?;
        Ok(args)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let names = setting::ALL.iter().map(|setting| setting.about().name);
        for patch in names.chain([PRESET]).filter_map(|name| matches.get_one::<SettingsPatch>(name)) {
            self.patch = self.patch.clone().overridden_by(patch.clone());
        }
        if matches.get_flag(NO_EMISSIVE) {
            self.patch.emitters = Some(EmitterSampling::Off);
        }
        Ok(())
    }
}

/// The option of a setting; its value is a patch that sets it.
fn option(setting: &'static dyn Setting) -> Arg {
    let about = setting.about();
    let choices = setting.choices();
    let parser: ValueParser = if choices.is_empty() {
        ValueParser::new(move |text: &str| setting.parse(text).map_err(|error| error.remedy()))
    } else {
        names(choices.iter().map(|choice| possible(choice, choice.help.to_owned())))
            .try_map(move |name| setting.parse(&name))
            .into()
    };
    let default = if setting.is_by_preset() {
        "by preset".to_owned()
    } else {
        // As it is written without quotes.
        setting.text(&Preset::default().settings()).replace(' ', "")
    };
    let help = format!("{} [default: {default}]", about.help());
    let option = Arg::new(about.name)
        .long(about.flag())
        .aliases(about.former.iter().filter(|name| !TAKEN.contains(name)))
        .value_name(about.placeholder)
        .value_parser(parser)
        .allow_negative_numbers(true)
        .help_heading(HEADING);
    let option = match setting.implied() {
        Some(value) => option.num_args(0..=1).default_missing_value(value),
        None => option,
    };
    match about.details() {
        Some(details) => option.long_help(format!("{help}\n\n{details}")).help(help),
        None => option.help(help),
    }
}

fn preset() -> Arg {
    let by_preset = || setting::ALL.iter().filter(|setting| setting.is_by_preset());
    let help = |preset: Preset, choice: &Choice| {
        let settings = preset.settings();
        let values = by_preset().map(|s| format!("{} {}", s.about().flag(), s.text(&settings)));
        format!("{} ({})", choice.help, values.collect::<Vec<_>>().join(", "))
    };
    let values = Preset::ALL.into_iter().zip(Preset::choices());
    let parser = names(values.map(|(preset, choice)| possible(choice, help(preset, choice))))
        .map(|name| SettingsPatch { preset: Preset::read(&name), ..SettingsPatch::default() });
    Arg::new(PRESET).long(PRESET).value_name("NAME").value_parser(parser).help_heading(HEADING).help(format!(
        "Settings to start from; project files and other options override them. [default: {}]",
        Preset::default().text()
    ))
}

fn no_emissive() -> Arg {
    Arg::new(NO_EMISSIVE)
        .long("no-emissive")
        .action(ArgAction::SetTrue)
        .conflicts_with(EMITTERS.about.name)
        .help_heading(HEADING)
        .help("Ignore the light of emissive surfaces: --emitters off")
}

fn possible(choice: &Choice, help: String) -> PossibleValue {
    PossibleValue::new(choice.name).aliases(choice.former).help(help)
}

fn names(values: impl Iterator<Item = PossibleValue>) -> PossibleValuesParser {
    PossibleValuesParser::new(values.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Cli, Command};
    use clap::Parser;
    use lumel::{
        BounceLimit, Directional, Layers, LightSampling, Memory, PointSpacing, Projection, SamplerKind,
        ScheduleKind, Settings, SolverKind, Tail,
    };

    /// Every setting other than by default. A new setting belongs here.
    fn unusual() -> Settings {
        Settings {
            projection: Projection::Area,
            point_spacing: PointSpacing::Metres(0.25),
            adaptive: "3%".parse().unwrap(),
            max_vertices: 1000,
            schedule: ScheduleKind::Shoot,
            bounces: BounceLimit::Count(7),
            remainder: 0.25,
            tail: Tail::Geometric,
            layers: Layers::Lights,
            directional: Directional::Sh2,
            direct_samples: 3,
            indirect_samples: 5,
            sampler: SamplerKind::Halton,
            light_sampling: LightSampling::Area,
            emitters: EmitterSampling::Rays,
            solver: SolverKind::Neumann,
            memory: Memory(3 << 20),
            target_error: "2%".parse().unwrap(),
            target_share: "80%".parse().unwrap(),
            seed: u64::MAX,
        }
    }

    fn parsed(options: &[&str]) -> Result<SettingsPatch, String> {
        let line = ["lumel", "bake", "furnace"].iter().chain(options);
        match Cli::try_parse_from(line).map_err(|error| error.to_string())?.command {
            Command::Bake(args) => Ok(args.settings.patch),
            _ => panic!("this is a bake"),
        }
    }

    #[test]
    fn every_setting_has_an_option_that_sets_it_and_refuses_what_it_cannot_be() {
        for setting in setting::ALL {
            let flag = format!("--{}", setting.about().flag());
            let value = setting.text(&unusual()).replace(' ', "");
            let patch = parsed(&[&flag, &value]).unwrap();
            assert_eq!(patch, setting.parse(&value).unwrap(), "{flag} {value}");
            assert!(
                setting.is_set(&patch) && !setting.is_same(&patch.settings(), &Settings::default()),
                "{flag}"
            );
            let error = parsed(&[&flag, "nonsense"]).unwrap_err();
            assert!(error.contains(&flag) && error.contains("nonsense"), "{error}");
        }
    }

    #[test]
    fn options_are_set_together_and_the_last_of_two_counts() {
        let options =
            ["--seed", "1", "--preset", "draft", "--no-emissive", "--bounces", "all", "--seed", "2"];
        let expected = SettingsPatch {
            preset: Some(Preset::Draft),
            bounces: Some(BounceLimit::All),
            emitters: Some(EmitterSampling::Off),
            seed: Some(2),
            ..SettingsPatch::default()
        };
        assert_eq!(parsed(&options), Ok(expected));
        assert!(
            parsed(&["--no-emissive", "--emitters", "rays"]).unwrap_err().contains("cannot be used with")
        );
    }

    #[test]
    fn an_option_says_what_its_value_must_be() {
        let error = parsed(&["--direct-samples", "0"]).unwrap_err();
        assert!(error.contains("it must be a whole number from 1 to 16777216"), "{error}");
        let error = parsed(&["--remainder", "nan"]).unwrap_err();
        assert!(error.contains("it must be a number between 0 and 1"), "{error}");
    }
}
