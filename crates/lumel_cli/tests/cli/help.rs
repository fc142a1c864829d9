use crate::common::{Place, run};
use lumel::Settings;
use lumel::setting::{PROJECTION, Setting as _};

/// What other programs may rely on, beside the options of settings.
const FLAGS: [(&str, &[&str]); 6] = [
    (
        "bake",
        &[
            "-o",
            "--light",
            "--no-emissive",
            "--max-edge",
            "--preset",
            "--threads",
            "--resume",
            "--progress",
            "--sky",
            "--subdivide",
            "--allow-outside-paths",
            "--strict",
            "--json",
        ],
    ),
    (
        "render",
        &[
            "--solution",
            "-o",
            "--size",
            "--camera",
            "--bounce",
            "--show",
            "--normal-maps",
            "--shading",
            "--exposure",
            "--tone",
            "--range",
            "--samples",
        ],
    ),
    ("measure", &["--light", "--point", "--normal", "--points", "-o", "--solution", "--json"]),
    (
        "unwrap",
        &[
            "-o",
            "--density",
            "--lumels",
            "--density-factor",
            "--atlas-size",
            "--gutter",
            "--align",
            "--uv",
            "--time-limit",
            "--json",
            "--strict",
        ],
    ),
    ("info", &["--json", "--strict", "--max-edge"]),
    ("compare", &["--json", "--max-error"]),
];

#[test]
fn every_flag_is_in_the_help_and_in_the_manual() {
    let place = Place::new();
    run(&mut place.lumel("man .")).done();
    let settings: Vec<String> =
        lumel::setting::ALL.iter().map(|s| format!("--{}", s.about().flag())).collect();
    for (command, flags) in FLAGS {
        let settings = settings.iter().map(String::as_str).filter(|_| ["bake", "measure"].contains(&command));
        let help = run(&mut place.lumel(&format!("{command} --help"))).done().stdout;
        let page = std::fs::read_to_string(place.path(&format!("lumel-{command}.1"))).unwrap();
        for flag in flags.iter().copied().chain(settings) {
            let words: Vec<&str> = help.split([' ', ',', '\n']).collect();
            assert!(words.contains(&flag), "{command} {flag}: {help}");
            assert!(page.contains(&flag.replace('-', "\\-")), "{command} {flag}");
        }
        assert!(help.contains("Example"), "{help}");
    }
}

#[test]
fn defaults_and_units_are_in_the_help() {
    let place = Place::new();
    let help = run(&mut place.lumel("bake --help")).done().stdout;
    let projection = format!("[default: {}]", PROJECTION.text(&Settings::default()));
    for part in ["[default: medium]", &projection, "[default: sobol]", "metres", "W/(m² sr)", "cornell-box: "]
    {
        assert!(help.contains(part), "no {part} in {help}");
    }
    let short = run(&mut place.lumel("bake -h")).done().stdout;
    assert!(short.len() < help.len());
}

#[test]
fn help_and_version_are_results_and_mistakes_are_failures() {
    let place = Place::new();
    for line in ["--help", "--version", "help bake", "render -h"] {
        let run = run(&mut place.lumel(line)).done();
        assert!(!run.stdout.is_empty() && run.stderr.is_empty());
    }
    for line in ["", "paint", "bake", "bake furnace --frobnicate", "compare a.npz"] {
        let run = run(&mut place.lumel(line));
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}");
        assert!(!run.stderr.is_empty());
    }
}

#[test]
fn shells_get_their_completions() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = run(&mut place.lumel(&format!("completions {shell}"))).done().stdout;
        assert!(script.contains("lumel") && script.contains("max-edge"), "{shell}");
    }
    let page = run(&mut place.lumel("man")).done().stdout;
    assert!(page.contains(".TH lumel 1"), "{page}");
    run(&mut place.lumel("man missing")).failed("missing");
}
