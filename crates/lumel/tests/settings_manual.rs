//! `docs/settings.md` says what the table of settings says.
//!
//! After a change of the table, write the page again: `LUMEL_TEST_RECORD=1 cargo test -p lumel --test settings_manual`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use lumel::Preset;
use lumel::setting::{self, Choice, Setting, Value as _};
use std::fmt::Write as _;

const HEAD: &str = "\
# Settings

All settings of a bake. A project file sets them under `[bake]` by the names below. Command-line options, which have
dashes (`direct_samples` is `--direct-samples`), override the project file, and both override the preset. The window
shows them under *Solve*; a program sets them in `lumel::Settings`. A value out of range is refused everywhere with the
same message.

What a lightmap is like stands under `[lightmap]`, ambient occlusion under `[ambient_occlusion]`: see
[lightmaps](lightmaps.md#in-project-files).

This page is written by a test from the table of settings.
";

fn page() -> String {
    let mut page = HEAD.to_owned();
    write!(page, "\n## preset\n\nSettings to start from.\n\n").unwrap();
    let by_preset: Vec<&dyn Setting> = setting::ALL.iter().copied().filter(|s| s.is_by_preset()).collect();
    let names: Vec<String> = by_preset.iter().map(|s| format!("`{}`", s.about().name)).collect();
    writeln!(page, "| preset | {} | purpose |", names.join(" | ")).unwrap();
    writeln!(page, "|---|{}---|", "---|".repeat(names.len())).unwrap();
    for (preset, Choice { name, help, .. }) in Preset::ALL.into_iter().zip(Preset::choices()) {
        let values: Vec<String> = by_preset.iter().map(|s| s.text(&preset.settings())).collect();
        let default = if preset == Preset::default() { " (default)" } else { "" };
        writeln!(page, "| `{name}`{default} | {} | {help} |", values.join(" | ")).unwrap();
    }
    for setting in setting::ALL {
        section(&mut page, *setting);
    }
    page
}

fn section(page: &mut String, setting: &dyn Setting) {
    let about = setting.about();
    write!(page, "\n## {}\n\n{}\n", about.name, about.help()).unwrap();
    if let Some(details) = about.details() {
        write!(page, "\n{details}\n").unwrap();
    }
    page.push('\n');
    for choice in setting.choices() {
        writeln!(page, "- `{}`: {}", choice.name, choice.help).unwrap();
    }
    if setting.choices().is_empty() {
        writeln!(page, "- Value: {}", setting.expected()).unwrap();
    }
    match setting.is_by_preset() {
        true => page.push_str("- Default: by preset\n"),
        false => writeln!(page, "- Default: {}", setting.text(&Preset::default().settings())).unwrap(),
    }
}

#[test]
fn the_page_of_settings_says_what_the_table_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/settings.md");
    if std::env::var_os("LUMEL_TEST_RECORD").is_some() {
        std::fs::write(path, page()).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap().replace("\r\n", "\n"), page());
}
