use crate::common::{LUMEL, Place, TINY, assert_same_light, run};
use lumel::{Bake, BounceLimit, OpenOptions, Preset, SettingsPatch};
use lumel_export::Checkpoint;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn a_bake_resumed_at_any_bounce_has_the_same_bits() {
    let place = Place::new();
    for projection in ["point", "area"] {
        place
            .bake_furnace(&format!("--projection {projection} --bounces 3 --tail geometric -o whole.npz"))
            .done();
        for k in 0..=3 {
            place.bake_furnace(&format!("--projection {projection} --bounces {k} -o part.npz")).done();
            let resumed = format!(
                "--projection {projection} --bounces 3 --tail geometric --resume part.npz -o resumed.npz"
            );
            let run = place.bake_furnace(&resumed).done();
            assert!(run.stdout.contains("from the checkpoint"), "{}", run.stdout);
            assert_same_light(&place.solution("whole.npz"), &place.solution("resumed.npz"));
        }
    }
}

#[test]
fn bounces_that_are_not_asked_for_are_left_out() {
    let place = Place::new();
    place.bake_furnace("--bounces 4 -o long.npz").done();
    place.bake_furnace("--bounces 1 -o short.npz").done();
    place.bake_furnace("--bounces 1 --resume long.npz -o cut.npz").done();
    assert_same_light(&place.solution("short.npz"), &place.solution("cut.npz"));
    place.bake_furnace("--bounces all --remainder 0.15 -o all.npz").done();
    place.bake_furnace("--bounces all --remainder 0.15 --resume long.npz -o cut.npz").done();
    assert_same_light(&place.solution("all.npz"), &place.solution("cut.npz"));
}

#[test]
fn a_finished_solve_to_an_error_is_resumed_with_other_bounces() {
    let place = Place::new();
    let patch = SettingsPatch {
        direct_samples: Some(4),
        indirect_samples: Some(8),
        bounces: Some(BounceLimit::Count(1)),
        target_error: Some("90%".parse().unwrap()),
        ..SettingsPatch::default()
    };
    let scene = lumel::open("cornell-box", &OpenOptions::default()).unwrap().builder;
    let baked = Bake::new(scene).preset(Preset::Draft).settings(patch).run().unwrap();
    baked.baker().checkpoint(baked.state()).save(&place.path("reached.npz")).unwrap();
    for other in ["--bounces 3", "--bounces 0", "--bounces 1 --tail geometric"] {
        let bake = |line: &str| {
            let line = format!("bake cornell-box --target-error 90% {other} {line}");
            run(place.lumel(&line).args(TINY)).done();
        };
        bake("--resume reached.npz -o resumed.npz");
        bake("-o whole.npz");
        let (resumed, whole) = (place.solution("resumed.npz"), place.solution("whole.npz"));
        assert_same_light(&resumed, &whole);
        assert_eq!(resumed.standard_error, whole.standard_error, "{other}");
        assert_ne!(resumed.irradiance, baked.solution().irradiance, "{other}");
    }
}

#[test]
fn foreign_solutions_are_refused_by_name() {
    let place = Place::new();
    place.bake_furnace("-o furnace.npz").done();
    let sphere = run(place.lumel("bake sphere --resume furnace.npz -o x.npz").args(TINY));
    let sphere = sphere.failed("\"furnace\"");
    assert!(
        sphere.stderr.contains("\"sphere\"") && sphere.stderr.contains("furnace.npz"),
        "{}",
        sphere.stderr
    );
    place.bake_furnace("--seed 1 --resume furnace.npz -o x.npz").failed("seed 0, not 1");
    place.bake_furnace("--sky 1,1,1 --resume furnace.npz -o x.npz").failed("lights");
    place.write("text.npz", "this is no archive");
    place.bake_furnace("--resume text.npz -o x.npz").failed("text.npz");
    place.bake_furnace("--resume missing.npz -o x.npz").failed("missing.npz");
    assert_eq!(place.files(), ["furnace.npz", "text.npz"]);
}

/// A bake that would take for ever.
struct Endless {
    child: Child,
    checkpoint: PathBuf,
}

impl Endless {
    /// Starts it and waits for its first checkpoint.
    fn start(place: &Place) -> Self {
        let mut child = Command::new(LUMEL)
            .current_dir(place.folder())
            .args(["bake", "furnace", "--bounces", "10000", "-o", "out.npz", "--threads", "2"])
            .args(TINY)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let checkpoint = place.path("out.checkpoint.npz");
        let begun = Instant::now();
        while !checkpoint.exists() {
            assert!(begun.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(2));
        }
        Self { child, checkpoint }
    }

    fn finished_bounces(&self) -> usize {
        Checkpoint::load(&self.checkpoint).unwrap().bounces.len()
    }
}

impl Drop for Endless {
    fn drop(&mut self) {
        // It is usually over by now.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_killed_bake_goes_on_with_the_same_bits() {
    let place = Place::new();
    let mut endless = Endless::start(&place);
    std::thread::sleep(Duration::from_millis(60));
    endless.child.kill().unwrap();
    endless.child.wait().unwrap();
    let last = endless.finished_bounces() + 1;
    place.bake_furnace(&format!("--bounces {last} --resume out.checkpoint.npz -o out.npz")).done();
    assert!(!endless.checkpoint.exists(), "a checkpoint is removed when its bake is done");
    place.bake_furnace(&format!("--bounces {last} -o whole.npz")).done();
    assert_same_light(&place.solution("whole.npz"), &place.solution("out.npz"));
}

#[cfg(unix)]
#[test]
fn signals_stop_a_bake_at_once_and_leave_a_checkpoint() {
    use std::io::Read;
    for signal in ["-INT", "-TERM"] {
        let place = Place::new();
        let mut endless = Endless::start(&place);
        let begun = Instant::now();
        let pid = endless.child.id().to_string();
        assert!(Command::new("kill").args([signal, &pid]).status().unwrap().success());
        let status = endless.child.wait().unwrap();
        // A tenth of a second on a machine that has nothing else to do.
        assert!(begun.elapsed() < Duration::from_secs(3), "{:?}", begun.elapsed());
        assert_eq!(status.code(), Some(130));
        let mut stderr = String::new();
        endless.child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        assert!(stderr.contains("--resume out.checkpoint.npz"), "{stderr}");
        let checkpoint = Checkpoint::load(&place.path("out.checkpoint.npz")).unwrap();
        assert!(!checkpoint.bounces.is_empty());
        assert_eq!(place.files(), ["out.checkpoint.npz"]);
    }
}

#[test]
fn the_checkpoint_of_an_earlier_bake_is_not_replaced_in_silence() {
    let place = Place::new();
    place.bake_furnace("--bounces 0 -o a.npz").done();
    std::fs::rename(place.path("a.npz"), place.path("b.checkpoint.npz")).unwrap();
    let run = place.bake_furnace("-o b.npz").done();
    assert!(run.stderr.starts_with("note: "), "{}", run.stderr);
    assert!(run.stderr.contains("--resume b.checkpoint.npz"), "{}", run.stderr);
}
