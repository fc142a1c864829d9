//! Lights and skies, and what the program says of those that are lost.

use crate::common::{Place, TINY, run};
use lumel_testkit::shared;
use std::f32::consts::PI;

/// A square metre that faces up.
const FLOOR: &str = "o floor\nv 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 1 2 3 4\n";

/// A cube whose faces face outwards: a room that is inside out.
const INSIDE_OUT: &str = "o walls\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n\
    f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";
const LAMP: &str = "point position=0.5,0.5,0.5 intensity=1,1,1 name=lamp";

/// A Radiance image of 2 x 1 texels of radiance `left` and `right`, 1 or 0.
fn write_hdr(place: &Place, name: &str, [left, right]: [u8; 2]) {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    // The shared exponent of one half.
    bytes.extend([left, right].map(|on| [128 * on, 128 * on, 128 * on, 129]).as_flattened());
    std::fs::create_dir_all(place.path(name).parent().unwrap()).unwrap();
    std::fs::write(place.path(name), bytes).unwrap();
}

fn mean(place: &Place) -> f32 {
    let irradiance = place.solution("a.npz").irradiance;
    irradiance.iter().map(|e| e.x).sum::<f32>() / irradiance.len() as f32
}

#[test]
fn a_room_that_is_inside_out_is_warned_of_and_two_sided_mends_it() {
    let place = Place::new();
    place.write("room.obj", INSIDE_OUT);
    let bake = |more: &[&str]| {
        let line = "bake room.obj --strict --bounces 0 -o a.npz";
        run(place.lumel(line).args(TINY).args(["--light", LAMP]).args(more))
    };
    let dark = bake(&[]);
    assert_eq!((dark.code, mean(&place)), (1, 0.0), "{}", dark.stderr);
    for words in [
        "warning: light \"lamp\" reaches no surface",
        "100 % of all direct light arrives at back faces, which are black",
        "--two-sided all (in project files two_sided)",
    ] {
        assert!(dark.stderr.contains(words), "{words} in {}", dark.stderr);
    }
    for name in ["all", "walls"] {
        let lit = bake(&["--two-sided", name]);
        assert_eq!(lit.code, 0, "{}", lit.stderr);
        assert!(mean(&place) > 0.1);
    }
    let unknown = bake(&["--two-sided", "curtain"]);
    assert!(unknown.stderr.contains("there is no material or object \"curtain\" to make two-sided"));
}

#[test]
fn a_project_makes_objects_two_sided_too() {
    let place = Place::new();
    place.write("room.obj", INSIDE_OUT);
    let light = "[[light]]\nkind = \"point\"\nposition = [0.5, 0.5, 0.5]\nintensity = [1, 1, 1]\n";
    place.write("room.lumel.toml", &format!("scene = \"room.obj\"\ntwo_sided = [\"walls\"]\n{light}"));
    run(place.lumel("bake room.lumel.toml --strict --bounces 0 -o a.npz").args(TINY)).done();
    assert!(mean(&place) > 0.1);
}

#[test]
fn a_light_in_an_opaque_bulb_reaches_nothing_and_is_named() {
    let Some(bulb) = shared::path_or_skip("fault-cases/light-in-opaque-bulb.glb") else { return };
    let place = Place::new();
    let run = run(place.lumel("bake --bounces 1 -o a.npz --strict").arg(bulb).args(TINY));
    assert_eq!((run.code, mean(&place)), (1, 0.0), "{}", run.stderr);
    assert!(run.stderr.contains("reaches no surface"), "{}", run.stderr);
}

#[test]
fn an_emissive_surface_that_lights_nothing_is_a_dark_bake() {
    let place = Place::new();
    place.write("lamp.mtl", "newmtl lamp\nKe 5 5 5\n");
    place.write("lamp.obj", &format!("mtllib lamp.mtl\nusemtl lamp\n{FLOOR}"));
    let run = run(place.lumel("bake lamp.obj --strict -o a.npz").args(TINY));
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("no light arrives at any surface of scene"), "{}", run.stderr);
    assert!(run.stderr.contains("add a light that suits the scene: --sky 'gradient"), "{}", run.stderr);
}

#[test]
fn images_of_the_sky_light_a_floor() {
    let place = Place::new();
    place.write("floor.obj", FLOOR);
    write_hdr(&place, "sky.hdr", [1, 1]);
    write_hdr(&place, "half.hdr", [1, 0]);
    for (sky, e) in [("sky.hdr", PI), ("sky.hdr strength=2 rotation=30", 2.0 * PI), ("half.hdr", 0.5 * PI)] {
        let line = "bake floor.obj --strict --two-sided none --bounces 0 -o a.npz --indirect-samples 1024";
        run(place.lumel(line).args(["--sky", sky])).done();
        assert!((mean(&place) / e - 1.0).abs() < 0.01, "{sky}: {} {e}", mean(&place));
    }
    let gradient = "gradient zenith=3,3,3 horizon=1,1,1";
    run(place.lumel("bake floor.obj --two-sided none --bounces 0 -o a.npz").args(["--sky", gradient])).done();
    assert!((mean(&place) / (PI * 7.0 / 3.0) - 1.0).abs() < 0.01, "{}", mean(&place));
    run(place.lumel("bake floor.obj -o b.npz").args(["--sky", "none.hdr"])).failed("none.hdr");
}

#[test]
fn a_project_finds_its_sky_beside_it_and_nowhere_else() {
    let place = Place::new();
    place.write("project/floor.obj", FLOOR);
    write_hdr(&place, "project/skies/noon.hdr", [1, 1]);
    write_hdr(&place, "outside.hdr", [1, 1]);
    let project = |image: &str| {
        let sky = format!("sky = {{ image = \"{image}\", strength = 2.0 }}");
        place.write("project/a.lumel.toml", &format!("scene = \"floor.obj\"\n{sky}\n"));
    };
    project("skies/noon.hdr");
    let line = "bake project/a.lumel.toml --strict --bounces 0 -o a.npz --indirect-samples 1024";
    run(&mut place.lumel(line)).done();
    assert!((mean(&place) / (2.0 * PI) - 1.0).abs() < 0.01);
    project("../outside.hdr");
    run(&mut place.lumel(line)).failed("outside.hdr");
    run(&mut place.lumel(&format!("{line} --allow-outside-paths"))).done();
    project("skies/none.hdr");
    run(&mut place.lumel(line)).failed("none.hdr");
    place.write("project/a.lumel.toml", "scene = \"floor.obj\"\nsky = { zenith = [1, 1, 1] }\n");
    run(&mut place.lumel(line)).failed("a sky must be [r, g, b], { zenith, horizon }");
}

#[test]
fn lights_of_a_project_name_what_is_wrong_with_them() {
    let place = Place::new();
    place.write("floor.obj", FLOOR);
    let lights = "[[light]]\nname = \"lamp\"\nkind = \"spot\"\nposition = [0, 1, 0]\nintensity = [1, 1, 1]\n";
    place.write("a.lumel.toml", &format!("scene = \"floor.obj\"\n{lights}"));
    run(&mut place.lumel("info a.lumel.toml")).failed("light \"lamp\": direction or toward is missing");
}
