use crate::common::{Place, run};
use serde_json::Value;

/// A room of twelve triangles, its ceiling a lamp.
const ROOM: &str = "\
mtllib room.mtl
v 0 0 0\nv 3 0 0\nv 3 2 0\nv 0 2 0\nv 0 0 3\nv 3 0 3\nv 3 2 3\nv 0 2 3
usemtl wall
o Walls
f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1
usemtl lamp
o Lamp
f 4 3 7 8
";

const MATERIALS: &str = "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n";

const QUICK: &str = "--basis lightmap --max-edge 0.4 --bounces 2 --direct-samples 4 --indirect-samples 16";

fn room() -> Place {
    let place = Place::new();
    place.write("room.obj", ROOM);
    place.write("room.mtl", MATERIALS);
    place
}

fn bake(place: &Place, line: &str) -> crate::common::Run {
    run(&mut place.lumel(&format!("bake room.obj {QUICK} {line}")))
}

#[test]
fn a_lightmap_is_written_as_pages_as_a_lit_mesh_and_as_a_picture() {
    let place = room();
    let text = bake(&place, "--lumels 4096 -o a.exr -o a.glb -o a.png").done().stdout;
    for part in [
        "lightmap 1 page of ",
        " used by 6 charts; ",
        " per metre\n",
        "lumels ",
        "wrote a.exr, ",
        "wrote a.glb, ",
    ] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    assert_eq!(place.files(), ["a.exr", "a.glb", "a.png", "room.mtl", "room.obj"]);
    // The floor lies a room's height below a lamp of radiance 1; light on walls is brightest where they meet it.
    let page = image::open(place.path("a.exr")).unwrap().to_rgb32f();
    let values: Vec<f32> = page.pixels().map(|pixel| pixel.0[0]).collect();
    assert!(values.iter().all(|value| value.is_finite() && *value >= 0.0));
    let brightest = values.iter().copied().fold(0.0, f32::max);
    assert!((1.5..4.0).contains(&brightest), "{brightest}");
    let picture = image::open(place.path("a.png")).unwrap().to_rgb8();
    assert!(picture.pixels().any(|pixel| pixel.0 != [0; 3]));
    // The mesh is the one that was given.
    let info = run(&mut place.lumel("info a.glb --json")).done();
    let info: Value = serde_json::from_str(&info.stdout).unwrap();
    assert_eq!(info["triangles"]["total"], 12, "{info}");
}

/// The names of the layers of an image.
fn layers(place: &Place, name: &str) -> Vec<String> {
    let bytes = std::fs::read(place.path(name)).unwrap();
    // Names of channels are text in the header.
    let header = String::from_utf8_lossy(&bytes[..4096.min(bytes.len())]).into_owned();
    let is_there = |layer: &&str| header.contains(&format!("{layer}.R"));
    ["direct", "bounce 1", "bounce 2", "noisy", "error"]
        .into_iter()
        .filter(is_there)
        .map(str::to_owned)
        .collect()
}

#[test]
fn noise_is_taken_off_unless_it_is_wanted_and_the_noisy_light_is_kept() {
    let place = room();
    bake(&place, "--lumels 4096 -o on.exr").done();
    bake(&place, "--lumels 4096 --denoise off -o off.exr").done();
    bake(&place, "--lumels 4096 --preset production -o production.exr").done();
    let all = ["direct", "bounce 1", "bounce 2", "noisy", "error"];
    assert_eq!(layers(&place, "on.exr"), all);
    for name in ["off.exr", "production.exr"] {
        assert_eq!(layers(&place, name), [&all[..3], &all[4..]].concat(), "{name}");
    }
    // Neighbours in the middle of a page are more alike.
    let roughness = |name: &str| {
        let page = image::open(place.path(name)).unwrap().to_rgb32f();
        let pairs = page.rows().flat_map(|row| {
            let values: Vec<f32> = row.map(|pixel| pixel.0[0]).collect();
            values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect::<Vec<f32>>()
        });
        pairs.sum::<f32>()
    };
    let [on, off] = ["on.exr", "off.exr"].map(roughness);
    assert!(on < 0.8 * off, "{on} {off}");
}

#[test]
fn a_project_says_how_a_lightmap_is_finished_and_written_and_options_go_first() {
    let place = room();
    let lightmap = "[lightmap]\nlumels = 4096\ndenoise = false\ntarget = \"occlusion\"\ntime_limit = 60\n";
    let text = format!("scene = \"room.obj\"\n{lightmap}[ambient_occlusion]\ndistance = 0.5\n");
    place.write("room.lumel.toml", &text);
    let bake = |line: &str| run(&mut place.lumel(&format!("bake room.lumel.toml {QUICK} {line}")));
    bake("-o a.exr -o a.glb").done();
    let occlusion = |name: &str| {
        let file = std::fs::read(place.path(name)).unwrap();
        String::from_utf8_lossy(&file).contains("\"occlusionTexture\":{")
    };
    assert!(!layers(&place, "a.exr").contains(&"noisy".to_owned()) && occlusion("a.glb"));
    bake("--denoise on --target any -o b.exr -o b.glb").done();
    assert!(layers(&place, "b.exr").contains(&"noisy".to_owned()) && !occlusion("b.glb"));
    place.write("room.lumel.toml", &text.replace("[ambient_occlusion]\ndistance = 0.5\n", ""));
    bake("-o c.glb").failed("--target occlusion needs ambient occlusion");
    bake("--ao-falloff 2 --target any -o c.glb").failed("--ao-falloff needs ambient occlusion");
}

#[test]
fn threads_make_no_difference_and_the_default_output_is_an_image() {
    let place = room();
    bake(&place, "--lumels 4096 --threads 1 -o one.exr").done();
    bake(&place, "--lumels 4096 --threads 2").done();
    assert_eq!(place.files(), ["one.exr", "room.exr", "room.mtl", "room.obj"]);
    let [one, two] = ["one.exr", "room.exr"].map(|name| std::fs::read(place.path(name)).unwrap());
    assert!(one == two);
}

#[test]
#[cfg(target_os = "linux")]
fn no_more_memory_is_taken_than_is_announced_before() {
    let place = room();
    for line in ["--lumels 65536 --bounces all -o a.npz -o a.png", "--max-edge 0.05 --basis vertex -o b.npz"]
    {
        let run = bake(&place, &format!("{line} --json")).done();
        let summary: Value = serde_json::from_str(&run.stdout).unwrap();
        let [announced, peak] =
            ["announced", "peak"].map(|name| summary["memory"][name].as_u64().unwrap() as f64);
        assert!((1.0..2.0).contains(&(announced / peak)), "{line}: {summary}");
        assert!(
            run.stderr.contains("note: needs about ") && run.stderr.contains("iB of memory\n"),
            "{run:?}"
        );
    }
    let text = bake(&place, "--lumels 4096 -o c.exr").done().stdout;
    assert!(text.contains(" s, rays stored part by part ("), "{text}");
    assert!(text.contains("\nmemory ") && text.contains("iB at most, announced "), "{text}");
}

#[test]
fn pages_that_are_too_small_for_all_become_several_files() {
    let place = room();
    let run = bake(&place, "--density 24 --atlas-size 64 -o a.exr --json").done();
    let summary: Value = serde_json::from_str(&run.stdout).unwrap();
    let pages = summary["lightmap"]["pages"].as_array().unwrap().len();
    assert!(pages > 1, "{summary}");
    let files = place.files();
    assert_eq!(files.iter().filter(|name| name.starts_with("a-")).count(), pages, "{files:?}");
    assert_eq!(summary["files"].as_array().unwrap().len(), pages);
    assert!(summary["lightmap"]["lumels"].as_u64().unwrap() > 4000, "{summary}");
}

#[test]
fn what_a_basis_cannot_write_is_refused_before_anything_is_computed() {
    let place = room();
    bake(&place, "-o a.ply").failed("--basis lightmap writes no .ply files");
    run(&mut place.lumel("bake room.obj -o a.exr")).failed("--basis vertex writes no .exr files");
    bake(&place, "--density-factor Table=2 -o a.exr").failed("has no object \"Table\"");
    assert_eq!(place.files(), ["room.mtl", "room.obj"]);
}

#[test]
fn lightmaps_are_drawn_and_compared_by_other_commands() {
    let place = room();
    bake(&place, "--lumels 4096 -o a.npz -o a.png").done();
    bake(&place, "--lumels 4096 --seed 5 -o b.npz").done();
    bake(&place, "--lumels 2048 -o coarse.npz").done();
    let render = |line: &str| run(&mut place.lumel(&format!("render room.obj {line}")));
    render("--solution a.npz -o again.png").done();
    let [a, again] = ["a.png", "again.png"].map(|name| std::fs::read(place.path(name)).unwrap());
    assert!(a == again, "the picture of the bake");
    render("--solution a.npz --bounce 1 -o bounce.png").done();
    render("--solution a.npz --bounce 3 -o none.png").failed("no bounce 3");
    let compared = run(&mut place.lumel("compare a.npz b.npz --json")).done().stdout;
    let compared: Value = serde_json::from_str(&compared).unwrap();
    assert_eq!((&compared["places"], &compared["bounces_a"]), (&"lumels".into(), &3.into()), "{compared}");
    let error = compared["sum"]["relative_rmse"].as_f64().unwrap();
    assert!((0.001..0.2).contains(&error), "{compared}");
    run(&mut place.lumel("compare a.npz coarse.npz")).failed("only light at the same lumels can be compared");
    run(&mut place.lumel(&format!("bake room.obj {} -o v.npz", QUICK.replace("lightmap", "vertex")))).done();
    run(&mut place.lumel("compare a.npz v.npz")).failed("compare two files of the same basis");
    run(&mut place.lumel("render cornell-box --solution a.npz -o none.png")).failed("was computed for scene");
}

#[test]
fn ambient_occlusion_is_a_layer_an_array_and_a_texture_and_pages_are_images() {
    let place = room();
    bake(&place, "--lumels 4096 --ao 0.5 -o a.exr -o a.npz -o a.glb --target occlusion").done();
    let header = std::fs::read(place.path("a.exr")).unwrap();
    assert!(String::from_utf8_lossy(&header[..4096]).contains("occlusion.R"));
    let glb = std::fs::read(place.path("a.glb")).unwrap();
    let document = String::from_utf8_lossy(&glb).into_owned();
    assert!(document.contains("\"occlusionTexture\":{\"index\":0,\"texCoord\":1}"));
    run(&mut place.lumel(&format!("bake room.obj {} --ao 0.5 -o v.npz", QUICK.replace("lightmap", "vertex")))).done();
    let mut npz = lumel_export::NpzReader::open(&place.path("v.npz")).unwrap();
    let lumel_export::ArrayData::F32(shares) = npz.array("occlusion").unwrap().data else {
        panic!("numbers")
    };
    assert!(
        shares.iter().all(|share| (0.0..=1.0).contains(share)) && shares.iter().any(|share| *share < 0.9)
    );
    bake(&place, "--lumels 4096 --png 16 -o words.png").done();
    bake(&place, "--lumels 4096 --png 8 -o bytes.png").done();
    let [words, bytes] = ["words.png", "bytes.png"].map(|name| image::open(place.path(name)).unwrap());
    assert_eq!((words.color().bits_per_pixel(), bytes.color().bits_per_pixel()), (48, 24));
    let mean = |image: &image::DynamicImage| {
        let image = image.to_rgb32f();
        image.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>()
            / f64::from(image.width() * image.height())
    };
    assert!((mean(&words) / mean(&bytes) - 1.0).abs() < 0.003, "{} {}", mean(&words), mean(&bytes));
    bake(&place, "--target occlusion -o b.glb").failed("--target occlusion needs ambient occlusion");
    bake(&place, "--ao -1 -o b.glb").failed("ao");
}
