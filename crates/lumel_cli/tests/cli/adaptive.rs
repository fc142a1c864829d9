use crate::common::{LUMEL, Place, assert_same_light, run};

/// A room of twelve triangles with a lamp.
const ROOM: &str = "\
v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 0 2 0\nv 2 2 0\nv 2 2 2\nv 0 2 2
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

const LAMP: [&str; 2] = ["--light", "rect center=1,1.9,1 direction=0,-1,0 size=0.3,0.3 radiance=30,30,30"];

/// What is carried is what is read: a solution is resumed bit by bit.
const SMALL: &str = "--projection area --preset draft --direct-samples 8 --indirect-samples 16 --bounces 1";

#[test]
fn a_mesh_follows_light_and_its_solution_is_drawn_resumed_and_measured() {
    let place = Place::new();
    place.write("room.obj", ROOM);
    let lumel = |line: &str| run(place.lumel(line).args(LAMP));
    let baked = lumel(&format!("bake room.obj --adaptive 5% {SMALL} -o a.npz -o a.glb")).done();
    assert!(baked.stdout.contains("refined to follow light to 5"), "{}", baked.stdout);
    let solution = place.solution("a.npz");
    assert!(solution.splits.len() > 300 && solution.positions.len() == 24 + solution.splits.len());
    let error = solution.meta.settings["adaptive"].as_f64().unwrap();
    assert!((error - 0.05).abs() < 1e-6, "{error}");
    run(&mut place.lumel("render room.obj --solution a.npz -o a.png --size 64x48 --samples 1")).done();
    let resumed = format!("bake room.obj --adaptive 5% {SMALL} --resume a.npz -o b.npz");
    lumel(&resumed).done();
    assert_same_light(&solution, &place.solution("b.npz"));
    let point = "--point 1,0,1 --normal 0,1,0";
    lumel(&format!("measure room.obj --solution a.npz {point}")).done();
    // The preset says how closely, a project too.
    place.write("room.lumel.toml", "scene = \"room.obj\"\n[bake]\nadaptive = \"auto\"\nmax_vertices = 400\n");
    let few = lumel(&format!("bake room.lumel.toml {SMALL} -o few.npz --json")).done();
    assert!(few.stdout.contains("\"adaptive\":{\"error\":0.04"), "{}", few.stdout);
    assert!(few.stderr.contains("raise --max-vertices"), "{}", few.stderr);
    assert!(place.solution("few.npz").positions.len() <= 400);
    // Another mesh does not have these edges.
    place.write("other.obj", &ROOM.replace("f 4 1 5 8\n", ""));
    let other = run(&mut place.lumel("render other.obj --solution a.npz -o a.png --size 64x48"));
    other.failed("does not belong to scene");
    let lightmap = format!("bake room.obj --adaptive 10% --basis lightmap --lumels 600 {SMALL} -o a.exr");
    lumel(&lightmap).done();
}

#[test]
fn a_bake_that_is_killed_while_it_refines_goes_on_with_the_same_bits() {
    use lumel_export::Checkpoint;
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let place = Place::new();
    place.write("room.obj", ROOM);
    let bake = format!("bake room.obj --adaptive 1% {SMALL} --threads 2");
    let mut child = Command::new(LUMEL)
        .current_dir(place.folder())
        .args(bake.split_whitespace())
        .args(LAMP)
        .args(["-o", "a.npz"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (path, begun) = (place.path("a.checkpoint.npz"), Instant::now());
    while !path.exists() {
        assert!(begun.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let checkpoint = Checkpoint::load(&path).unwrap();
    let refinement = checkpoint.refinement.expect("the mesh is being refined");
    println!("{:?}, {} splits, {} probes", refinement.next, refinement.splits.len(), refinement.probes.len());
    // Another error would have split other edges.
    let lumel = |line: &str| run(place.lumel(line).args(LAMP));
    let other = bake.replace("1%", "2%");
    lumel(&format!("{other} --resume a.checkpoint.npz -o a.npz")).failed("adaptive");
    lumel(&format!("{bake} --resume a.checkpoint.npz -o a.npz")).done();
    assert!(!path.exists(), "a checkpoint is removed when its bake is done");
    lumel(&format!("{bake} -o whole.npz")).done();
    let (whole, resumed) = (place.solution("whole.npz"), place.solution("a.npz"));
    assert!(whole.splits.len() > refinement.splits.len() && whole.splits == resumed.splits);
    assert_same_light(&whole, &resumed);
}
