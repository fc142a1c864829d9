//! The commands of the tutorial, in their order.

use crate::common::{Place, run};

const TUTORIAL: &str = include_str!("../../../../docs/tutorial.md");

/// What makes bakes short: other settings than those of the tutorial are tested elsewhere.
const SHORT: [&str; 4] = ["--direct-samples", "4", "--indirect-samples", "8"];

/// The commands in fences of code that have no language.
fn commands() -> Vec<&'static str> {
    let mut fence = None;
    let mut commands = Vec::new();
    for line in TUTORIAL.lines() {
        match (fence, line.strip_prefix("```")) {
            (None, Some(language)) => fence = Some(language),
            (Some(_), Some(_)) => fence = None,
            (Some(""), None) => commands.push(line),
            (_, None) => {}
        }
    }
    commands
}

/// The words of a line, of which those in single quotes are one.
fn words(line: &str) -> Vec<&str> {
    let parts = line.split('\'').enumerate();
    parts
        .flat_map(|(i, part)| if i % 2 == 1 { vec![part] } else { part.split_whitespace().collect() })
        .collect()
}

#[test]
fn every_command_of_the_tutorial_does_what_it_says() {
    let place = Place::new();
    let commands = commands();
    assert!(commands.len() > 10);
    for command in commands {
        let [program, name, rest @ ..] = &*words(command) else { panic!("{command}") };
        assert_eq!(*program, "lumel", "{command}");
        let mut lumel = place.lumel(name);
        lumel.args(rest);
        if *name == "bake" {
            lumel.args(SHORT);
            if rest.contains(&"lightmap") {
                lumel.args(["--lumels", "16000"]);
            }
        }
        if *name == "render" {
            lumel.args(["--size", "160x120"]);
        }
        let run = run(&mut lumel).done();
        assert!(!run.stderr.contains("warning: "), "{command}: {}", run.stderr);
        for output in rest.windows(2).filter(|pair| pair[0] == "-o").map(|pair| pair[1]) {
            assert!(place.path(output).exists(), "{command}");
        }
    }
}
