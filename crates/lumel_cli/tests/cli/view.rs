use crate::common::{LUMEL, Place, Run, run};
use assert_cmd::Command;

/// A place with a copy of the program in `bin`, which no viewer lies beside.
///
/// The shell makes the files: while this process had them open for writing, other tests' child processes would too,
/// and then they could not be run.
fn place() -> Place {
    let place = Place::new();
    shell(&place, &format!("mkdir bin other; ln '{LUMEL}' bin/lumel 2>&1 || cp '{LUMEL}' bin/lumel"));
    place
}

fn shell(place: &Place, script: &str) {
    let done = Command::new("sh").args(["-ec", script]).current_dir(place.folder()).ok();
    done.unwrap();
}

/// Puts a viewer there that tells its folder and arguments.
fn add_viewer(place: &Place, folder: &str, exit_code: u8) {
    let script = format!("#!/bin/sh\nprintf {folder}\nprintf ' <%s>' \"$@\"\nexit {exit_code}\n");
    shell(place, &format!("cat > {folder}/lumel-view << 'END'\n{script}END\nchmod +x {folder}/lumel-view"));
}

/// Runs `lumel view`, with the folder `other` on the path.
fn view(place: &Place, arguments: &[&str]) -> Run {
    let mut command = Command::new(place.path("bin/lumel"));
    command.arg("view").args(arguments).env("PATH", place.path("other"));
    run(&mut command)
}

#[test]
fn the_viewer_beside_the_program_gets_all_arguments_and_returns_its_exit_code() {
    let place = place();
    add_viewer(&place, "bin", 7);
    add_viewer(&place, "other", 0);
    let seen = view(&place, &["a b.glb", "--help", "--max-edge", "0.1", "--", "-x", ""]);
    assert_eq!((seen.code, seen.stderr.as_str()), (7, ""));
    assert_eq!(seen.stdout, "bin <a b.glb> <--help> <--max-edge> <0.1> <--> <-x> <>");
    let seen = view(&place, &["--screenshot", "a.png"]);
    assert_eq!(seen.stdout, "bin <--screenshot> <a.png>");
}

#[test]
fn else_the_viewer_on_the_path_is_run() {
    let place = place();
    add_viewer(&place, "other", 0);
    let seen = view(&place, &["atrium"]).done();
    assert_eq!(seen.stdout, "other <atrium>");
}

#[test]
fn without_a_viewer_one_is_told_how_to_get_it() {
    let place = place();
    let seen = view(&place, &["atrium"]).failed("neither in the folder of lumel nor on the path");
    for command in ["cargo install --path crates/lumel_view", "cargo run --release -p lumel_view"] {
        assert!(seen.stderr.contains(command), "{}", seen.stderr);
    }
    shell(&place, "echo 'no program' > bin/lumel-view");
    view(&place, &["atrium"]).failed("cannot run");
    run(&mut place.lumel("help view")).done();
}
