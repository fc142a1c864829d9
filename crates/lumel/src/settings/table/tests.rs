use super::*;
use serde_json::{Value as Json, json};

/// A value of each setting that is not its default, and one that it cannot have.
const EXAMPLES: [(&str, &str, &str); 21] = [
    ("projection", "area", "lightmap"),
    ("point_spacing", "0.25", "-1"),
    ("levels", "3", "0"),
    ("adaptive", "3 %", "fine"),
    ("max_vertices", "1000", "0"),
    ("schedule", "shoot", "wait"),
    ("bounces", "7", "10001"),
    ("remainder", "0.25", "1"),
    ("tail", "geometric", "long"),
    ("layers", "lights", "rooms"),
    ("directional", "sh1", "sh3"),
    ("direct_samples", "3", "0"),
    ("indirect_samples", "5", "16777217"),
    ("sampler", "halton", "dice"),
    ("light_sampling", "area", "none"),
    ("emitters", "off", "some"),
    ("solver", "neumann", "magic"),
    ("memory", "5 MiB", "much"),
    ("target_error", "2 %", "0"),
    ("target_share", "90 %", "100%"),
    ("seed", "18446744073709551615", "-1"),
];

fn with(name: &str) -> (&'static dyn Setting, &'static str, &'static str) {
    let (_, good, bad) = EXAMPLES.iter().find(|(known, ..)| *known == name).unwrap();
    (*ALL.iter().find(|setting| setting.about().name == name).unwrap(), good, bad)
}

#[test]
fn every_setting_is_set_by_a_text_and_refuses_what_it_cannot_be() {
    assert_eq!(ALL.len(), EXAMPLES.len());
    for (name, ..) in EXAMPLES {
        let (setting, good, bad) = with(name);
        let patch = setting.parse(good).unwrap();
        assert!(setting.is_set(&patch));
        let settings = patch.settings();
        assert_eq!(setting.text(&settings), good);
        let differing: Vec<&str> = settings.differing(&Settings::default()).map(|s| s.about().name).collect();
        assert_eq!(differing, [name]);
        let mut copy = Settings::default();
        setting.copy(&settings, &mut copy);
        assert_eq!(copy, settings);
        let error = setting.parse(bad).unwrap_err();
        assert_eq!((error.setting(), error.to_string().contains(&format!("\"{bad}\""))), (name, true));
    }
}

#[test]
fn every_setting_is_known_to_files_by_its_name_and_its_choices() {
    for (name, good, _) in EXAMPLES {
        let (setting, ..) = with(name);
        let patch = setting.parse(good).unwrap();
        let file = serde_json::to_value(&patch).unwrap();
        assert_eq!(file.as_object().unwrap().keys().collect::<Vec<_>>(), [name]);
        assert_eq!(serde_json::from_value::<SettingsPatch>(file).unwrap(), patch);
        for choice in setting.choices() {
            let file = json!({ name: choice.name });
            assert_eq!(
                serde_json::from_value::<SettingsPatch>(file).unwrap(),
                setting.parse(choice.name).unwrap()
            );
        }
    }
}

#[test]
fn former_names_are_still_read_in_place_of_the_names_of_today() {
    for setting in ALL {
        let about = setting.about();
        let value = |patch: &SettingsPatch| setting.text(&patch.settings());
        for choice in setting.choices() {
            for former in choice.former {
                assert_eq!(value(&setting.parse(former).unwrap()), choice.name);
                for name in about.former.iter().chain([&about.name]) {
                    let patch: SettingsPatch = serde_json::from_value(json!({ *name: former })).unwrap();
                    assert_eq!((value(&patch).as_str(), setting.is_set(&patch)), (choice.name, true));
                }
            }
        }
    }
    let patch: SettingsPatch = serde_json::from_value(json!({ "basis": "vertex-area" })).unwrap();
    assert_eq!(patch.projection, Some(Projection::Area));
    let both = json!({ "basis": "vertex-area", "projection": "area" });
    assert!(serde_json::from_value::<SettingsPatch>(both).is_err());
}

#[test]
fn every_setting_is_explained() {
    for setting in ALL {
        let about = setting.about();
        let help = about.help();
        assert!(help.ends_with('.') && !about.label.is_empty() && !about.placeholder.is_empty(), "{help}");
        // A slider offers nothing that is refused.
        if let Some(offered) = about.offered {
            assert!(offered[0] < offered[1] && offered.iter().all(|&n| about.bounds.contain(n)), "{help}");
        }
    }
}

#[test]
fn presets_differ_in_samples_and_bounces() {
    let differing = ALL.iter().filter(|setting| setting.is_by_preset()).map(|s| s.about().name);
    assert_eq!(differing.collect::<Vec<_>>(), ["bounces", "remainder", "direct_samples", "indirect_samples"]);
}

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
    assert!(serde_json::from_str::<Settings>(r#"{"bounce": 3}"#).is_err());
}

#[test]
fn settings_of_the_first_solutions_are_still_read() {
    // As the first version wrote them, before there were solvers, memory and target errors.
    let mut old = json!({
        "basis": "vertex-area",
        "bounces": "all",
        "remainder": 0.01,
        "tail": "geometric",
        "direct_samples": 4,
        "indirect_samples": 8,
        "sampler": "stratified",
        "light_sampling": "area",
        "emitters": "rays",
        "seed": 3,
    });
    let settings: Settings = serde_json::from_value(old.clone()).unwrap();
    let expected = Settings {
        projection: Projection::Area,
        bounces: BounceLimit::All,
        remainder: 0.01,
        tail: Tail::Geometric,
        direct_samples: 4,
        indirect_samples: 8,
        sampler: SamplerKind::Stratified,
        light_sampling: LightSampling::Area,
        emitters: EmitterSampling::Rays,
        seed: 3,
        ..Settings::default()
    };
    assert_eq!(settings, expected);
    let Json::Object(fields) = &mut old else { panic!("it is an object") };
    fields.remove("direct_samples");
    let error = serde_json::from_value::<Settings>(old).unwrap_err();
    assert!(error.to_string().contains("direct_samples is missing"), "{error}");
}
