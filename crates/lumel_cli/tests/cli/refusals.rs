use crate::common::{Place, run};

#[test]
fn outputs_are_checked_before_the_bake() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder.npz")).unwrap();
    // Were the scene baked first, it would take minutes.
    let refused = |outputs: &str, words: &str| {
        let line = format!("bake cornell-box --subdivide 2 --preset production {outputs}");
        run(&mut place.lumel(&line)).failed(words)
    };
    let unknown = refused("-o a.npz -o b.exr", "b.exr");
    assert!(unknown.stderr.contains(".npz, .glb, .ply, .obj, .rad, .png"), "{}", unknown.stderr);
    refused("-o noextension", "no extension");
    refused("-o missing/a.npz", "does not exist");
    refused("-o folder.npz", "folder");
    refused("-o a.npz -o ./a.npz", "twice");
    refused("-o a.npz -o a.checkpoint.npz", "checkpoint");
    place.write("theirs.mtl", "newmtl wood\n");
    refused("-o a.npz -o theirs.obj", "theirs.mtl");
    assert_eq!(place.files(), ["folder.npz", "theirs.mtl"]);
}

#[test]
fn a_bake_does_not_replace_its_scene() {
    let place = Place::new();
    place.write("room.ply", "ply\n");
    run(&mut place.lumel("bake room.ply -o room.ply")).failed("would be replaced");
    place.write("room.lumel.toml", "scene = \"room.ply\"\n");
    run(&mut place.lumel("bake room.lumel.toml -o room.ply")).failed("would be replaced");
    assert_eq!(std::fs::read(place.path("room.ply")).unwrap(), b"ply\n");
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    let place = Place::new();
    let cases = [
        "--max-edge 0",
        "--max-edge -1",
        "--max-edge nan",
        "--max-edge inf",
        "--threads 0",
        "--threads 1000000",
        "--bounces -1",
        "--bounces 4000000000",
        "--bounces many",
        "--direct-samples 0",
        "--indirect-samples 99999999999",
        "--remainder 0",
        "--remainder nan",
        "--target-error 0",
        "--target-error much",
        "--target-share 100%",
        "--sky nan,0,0",
        "--sky -1,0,0",
        "--sky 1,1",
        "--seed -1",
        "--subdivide 99",
        "--sampler dice",
        "--projection lightmap",
        "--preset best",
        "--tail long",
        "--light-sampling none",
        "--progress loud",
    ];
    for case in cases {
        let flag = case.split(' ').next().unwrap();
        run(&mut place.lumel(&format!("bake furnace {case}"))).failed(flag);
    }
    assert!(place.files().is_empty());
}

#[test]
fn lights_that_make_no_sense_say_why() {
    let place = Place::new();
    let refused = |light: &str, words: &str| {
        let run = run(place.lumel("bake furnace").args(["--light", light])).failed(words);
        assert!(run.stderr.contains("hint: for example --light 'rect center="), "{}", run.stderr);
    };
    refused("", "one of rect, disk, point, spot, sun");
    refused("rect", "center is missing");
    refused("rect center=0,0,x u=1,0,0 v=0,0,1 radiance=1,1,1", "center: \"x\" is not a number");
    refused("rect center=0,0,0 u=nan,0,0 v=0,0,1 radiance=1,1,1", "u: nan is not a finite number");
    refused("rect center=0,0,0 u=1,0,0 v=0,0,0 radiance=1,1,1", "v: it has no direction");
    refused("rect center=0,0,0 u=1,0,0 v=1,0,1 radiance=1,1,1", "perpendicular");
    refused("rect center=0,0,0 u=1,0,0 v=0,0,1 radiance=1,1,1 color=1", "\"color\"");
}

#[test]
fn a_dark_scene_is_refused_with_advice() {
    let place = Place::new();
    let run = run(&mut place.lumel("bake furnace --no-emissive"))
        .failed("nothing emits light in scene \"furnace\"");
    assert!(
        run.stderr.contains("hint: add a light that suits the scene: --light 'rect center="),
        "{}",
        run.stderr
    );
    assert!(place.files().is_empty());
}

#[test]
fn an_unknown_scene_lists_those_there_are() {
    let place = Place::new();
    let run = run(&mut place.lumel("info teapot")).failed("\"teapot\"");
    assert!(run.stderr.contains("hint: ") && run.stderr.contains("cornell-box"), "{}", run.stderr);
    let run = crate::common::run(&mut place.lumel("bake teapot.glb")).failed("\"teapot.glb\"");
    assert!(!run.stderr.contains("panicked"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error_and_a_closed_pipe_is_none() {
    use std::process::{Command, Stdio};
    let place = Place::new();
    for command in ["info furnace", "completions bash", "man", "--help", "bake --help"] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let start = |stdout: Stdio| {
            let mut lumel = Command::new(crate::common::LUMEL);
            lumel.current_dir(place.folder()).args(command.split(' ')).stdout(stdout).stderr(Stdio::null());
            lumel.spawn().unwrap()
        };
        assert_eq!(start(full.into()).wait().unwrap().code(), Some(2), "{command}");
        let mut child = start(Stdio::piped());
        drop(child.stdout.take());
        assert_eq!(child.wait().unwrap().code(), Some(0), "{command}");
    }
}
