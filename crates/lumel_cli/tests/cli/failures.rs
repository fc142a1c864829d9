//! What goes wrong outside of lumel: limits, locks, pipes, names, and processes that are killed.

use crate::common::{LUMEL, Place, Run, TINY, run};
use crate::project::FLOOR;
use assert_cmd::Command;
use serde_json::Value;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::FileTypeExt;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// What takes so much memory before the first ray that 600 MB do not hold it.
const HUGE: &str = "bake atrium --subdivide 3 --threads 2 -o a.npz";

/// The program under a limit of the shell, such as `-f 8`.
fn limited(place: &Place, limit: &str, line: &str) -> Run {
    let script = format!("ulimit {limit} && exec \"$@\"");
    let mut command = Command::new("sh");
    command.current_dir(place.folder()).args(["-c", &script, "sh", LUMEL]);
    run(command.args(line.split_whitespace()))
}

/// The events of a run, each of which is a line.
#[track_caller]
fn events(run: &Run) -> Vec<Value> {
    let event = |line: &str| -> Value {
        let event: Value = serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {}", run.stderr));
        assert!(event["event"].is_string(), "{line}");
        event
    };
    run.stderr.lines().map(event).collect()
}

#[test]
fn every_line_is_json_whatever_fails() {
    let place = Place::new();
    place.write("broken.obj", "v 0 zero 0\n");
    call("mkfifo", &[place.path("pipe.npz").as_os_str()]);
    let held = File::create(place.path(".lumel-taken.npz.lock")).unwrap();
    held.lock().unwrap();
    let tiny = TINY.join(" ");
    let furnace = format!("bake furnace {tiny} --progress json");
    let cases = [
        ("-f 4", format!("{furnace} -o small.npz"), "longer than the system allows"),
        ("-v 600000", format!("{HUGE} --progress json"), "out of memory"),
        ("-n 256", format!("{furnace} -o taken.npz"), "is writing this file"),
        ("-n 256", format!("{furnace} -o pipe.npz"), "a device or a pipe"),
        ("-n 256", format!("{furnace} -o missing/a.npz"), "does not exist"),
        ("-n 256", format!("{furnace} --resume missing.npz"), "missing.npz"),
        ("-n 256", "bake broken.obj --progress json".to_owned(), "broken.obj:1"),
        ("-n 256", "bake nothing --progress json".to_owned(), "no built-in scene"),
        ("-n 256", format!("{furnace} --bounces 4294967296"), "a whole number from 0 to 10000"),
        ("-n 256", "bake --progress=json".to_owned(), "SCENE"),
    ];
    for (limit, line, words) in cases {
        let run = limited(&place, limit, &line);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}: {}", run.stderr);
        let last = events(&run).pop().unwrap();
        let message = last["message"].as_str().unwrap();
        assert!(last["event"] == "error" && message.contains(words), "{line}: {last}");
    }
}

#[test]
fn a_bake_that_is_stopped_tells_it_in_json() {
    let place = Place::new();
    let mut endless = Endless::start(&place, &["--progress", "json"]);
    call("kill", &[OsStr::new("-INT"), OsStr::new(&endless.0.id().to_string())]);
    let (status, stderr) = endless.end();
    assert_eq!(status, Some(130));
    let events = events(&Run { code: 130, stdout: String::new(), stderr });
    assert_eq!(events.last().unwrap()["event"], "note");
}

/// Runs another program, which must succeed.
fn call(program: &str, arguments: &[&OsStr]) {
    assert!(std::process::Command::new(program).args(arguments).status().unwrap().success());
}

/// A bake that would take for ever, which is killed in the end.
struct Endless(Child);

impl Endless {
    /// Starts it and waits for its first checkpoint.
    fn start(place: &Place, options: &[&str]) -> Self {
        let child = std::process::Command::new(LUMEL)
            .current_dir(place.folder())
            .args(["bake", "furnace", "--bounces", "10000", "-o", "out.npz", "--threads", "2"])
            .args(TINY)
            .args(options)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while !place.path("out.checkpoint.npz").exists() {
            assert!(begun.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(2));
        }
        Self(child)
    }

    /// How it ends, and what it has said.
    fn end(&mut self) -> (Option<i32>, String) {
        let mut stderr = String::new();
        std::io::Read::read_to_string(&mut self.0.stderr.take().unwrap(), &mut stderr).unwrap();
        (self.0.wait().unwrap().code(), stderr)
    }
}

impl Drop for Endless {
    fn drop(&mut self) {
        // It is usually over by now.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn two_bakes_of_one_output_are_one_too_many_until_the_first_is_gone() {
    let place = Place::new();
    let mut endless = Endless::start(&place, &[]);
    // The checkpoint is an output, too.
    for output in ["out.npz", "out.glb"] {
        let second = place.bake_furnace(&format!("-o {output}")).failed("is writing this file");
        assert!(second.stderr.contains(&format!("(process {})", endless.0.id())), "{}", second.stderr);
    }
    endless.0.kill().unwrap();
    endless.0.wait().unwrap();
    assert!(place.path(".lumel-out.npz.lock").exists(), "the file stays, and nobody holds it");
    place.bake_furnace("-o out.npz").done();
    // It may have been writing a checkpoint, which is too young to be taken for a stray.
    let files = place.files().into_iter().filter(|name| !name.ends_with(".tmp"));
    assert_eq!(files.collect::<Vec<_>>(), ["out.npz"]);
}

#[test]
fn what_killed_bakes_leave_is_removed_by_the_next_one() {
    let place = Place::new();
    for name in [".lumel-a1B2c3.tmp", ".lumel-old.npz.lock"] {
        let stray = File::create(place.path(name)).unwrap();
        stray.set_modified(SystemTime::now() - Duration::from_secs(3600)).unwrap();
    }
    place.bake_furnace("-o out.npz").done();
    assert_eq!(place.files(), ["out.npz"]);
}

#[test]
fn limits_end_a_bake_with_an_error_that_names_the_file() {
    let place = Place::new();
    let tiny = TINY.join(" ");
    let run = limited(&place, "-f 4", &format!("bake furnace {tiny} -o a.npz"));
    let run = run.failed("the file would be longer than the system allows");
    assert!(run.stderr.contains("a.npz") && run.stderr.contains("no checkpoint"), "{}", run.stderr);
    assert_eq!(place.files(), [""; 0]);
    let run = limited(&place, "-v 600000", HUGE).failed("out of memory");
    assert!(run.stderr.contains("hint: "), "{}", run.stderr);
}

#[test]
fn pipes_and_devices_are_refused_before_the_bake() {
    let place = Place::new();
    call("mkfifo", &[place.path("pipe.npz").as_os_str()]);
    std::os::unix::fs::symlink("/dev/full", place.path("full.png")).unwrap();
    for output in ["pipe.npz", "full.png"] {
        // Were the scene baked first, it would take minutes.
        let line = format!("bake cornell-box --subdivide 2 --preset production -o {output}");
        run(&mut place.lumel(&line))
            .failed(&format!("this is a device or a pipe, which cannot be written: {output}"));
    }
    assert!(fs::metadata(place.path("pipe.npz")).unwrap().file_type().is_fifo());
}

#[test]
fn names_of_files_need_not_be_text() {
    let place = Place::new();
    let name = OsStr::from_bytes(b"r\xffom.obj");
    fs::write(place.folder().join(name), FLOOR).unwrap();
    let bake = |output: &[&OsStr]| {
        let mut command = place.lumel("bake");
        run(command.arg(name).args(["--sky", "1,1,1"]).args(TINY).args(output)).done()
    };
    bake(&[]);
    let solution = place.folder().join(OsStr::from_bytes(b"r\xffom.npz"));
    assert!(solution.exists());
    let picture = OsStr::from_bytes(b"p\xfe.png");
    bake(&[OsStr::new("-o"), picture]);
    assert!(place.folder().join(picture).exists());
    let render = ["--sky", "1,1,1", "--size", "8x6", "-o", "a.png", "--solution"];
    run(place.lumel("render").arg(name).args(render).arg(&solution)).done();
    let alone = run(place.lumel("render -o b.png").arg(&solution)).failed("does not say where its scene is");
    assert!(alone.stderr.contains("lumel render SCENE --solution"), "{}", alone.stderr);
}
