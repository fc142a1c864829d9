use crate::common::{Place, TINY, run};
use crate::project::FLOOR;
use image::RgbImage;

fn picture(place: &Place, name: &str) -> RgbImage {
    image::open(place.path(name)).unwrap().to_rgb8()
}

#[test]
fn pictures_of_everything_that_can_be_shown() {
    let place = Place::new();
    place.bake_furnace("-o a.npz -o a.rad").done();
    for show in ["radiance", "irradiance", "albedo", "normals", "false-color"] {
        let line =
            format!("render furnace --solution a.npz -o {show}.png --size 40x30 --samples 2 --show {show}");
        let run = run(&mut place.lumel(&line)).done();
        assert!(run.stdout.starts_with(&format!("wrote {show}.png, 40x30, ")), "{}", run.stdout);
        assert_eq!(picture(&place, &format!("{show}.png")).dimensions(), (40, 30));
    }
    run(&mut place.lumel("render furnace -o albedo2.png --size 40x30 --samples 2 --show albedo")).done();
    assert_eq!(picture(&place, "albedo.png"), picture(&place, "albedo2.png"), "albedo needs no light");
}

#[test]
fn bounces_exposure_tone_and_camera_change_the_picture() {
    let place = Place::new();
    place.bake_furnace("-o a.npz").done();
    let base = "render furnace --solution a.npz --size 24x18 --samples 1 --exposure 0 -o";
    let draw = |name: &str, more: &[&str]| {
        run(place.lumel(base).arg(name).args(more)).done();
        picture(&place, name)
    };
    let all = draw("all.png", &[]);
    assert_eq!(all, draw("sum.png", &["--bounce", "sum"]));
    assert_ne!(all, draw("direct.png", &["--bounce", "0"]));
    assert_ne!(all, draw("tone.png", &["--tone", "none"]));
    let view = "position=0.1,0,0 target=0.4,0.3,0.4 fov=80";
    assert_ne!(
        draw("here.png", &["--show", "normals", "--exposure", "auto", "--camera", view]),
        draw("there.png", &["--show", "normals", "--exposure", "auto"])
    );
    let brighter = run(place.lumel(base).args(["b.png", "--exposure", "-2.5"]));
    assert!(brighter.done().stdout.contains("exposure -2.5 EV"));
}

#[test]
fn the_light_of_a_layer_is_shown_by_its_name() {
    let place = Place::new();
    let lamp = "rect center=0,0.2,0 u=0.1,0,0 v=0,0,0.1 radiance=1,2,3 name=lamp";
    let bake = run(place.lumel("bake furnace --layers lights -o a.npz").args(TINY).args(["--light", lamp]));
    assert!(bake.done().stdout.contains("layer 2 "));
    let solution = place.solution("a.npz");
    let names: Vec<&str> = solution.layers.iter().map(|layer| layer.name.as_str()).collect();
    let [only_lamp @ "lamp", surfaces] = names[..] else { panic!("{names:?}") };
    let base = "render furnace --solution a.npz --size 24x18 --samples 1 --exposure 0 -o";
    let draw = |name: &str, more: &[&str]| {
        run(place.lumel(base).arg(name).args(["--light", lamp]).args(more)).done();
        picture(&place, name)
    };
    let [lit, glow, all] = [
        draw("lamp.png", &["--light", only_lamp]),
        draw("glow.png", &["--light", surfaces]),
        draw("all.png", &[]),
    ];
    assert!(lit != all && glow != all && lit != glow);
    let refused = |more: &[&str], words: &str| {
        run(place.lumel(base).arg("x.png").args(["--light"]).args(more)).failed(words);
    };
    refused(&["sun"], &format!("no layer \"sun\"; its layers are lamp, {surfaces}"));
    refused(&["lamp", "--bounce", "0"], "a layer has no single bounces");
    refused(&["lamp", "--light", surfaces], "only one layer");
    place.bake_furnace("-o b.npz").done();
    run(&mut place.lumel("render furnace --solution b.npz -o x.png --light lamp")).failed("--layers lights");
    run(&mut place.lumel("bake furnace -o c.npz --light lamp")).failed("must be the kind of the light");
    run(&mut place.lumel("bake furnace -o c.npz --layers lights --target-error 5%"))
        .failed("exclude each other");
}

#[test]
fn the_courses_files_light_a_picture_too() {
    let place = Place::new();
    place.bake_furnace("-o a.npz -o a.rad").done();
    for file in ["a.npz", "a.rad"] {
        let line = format!("render furnace --solution {file} -o {file}.png --size 24x18 --samples 1");
        run(&mut place.lumel(&line)).done();
    }
    assert_eq!(picture(&place, "a.npz.png"), picture(&place, "a.rad.png"));
    run(&mut place.lumel("render furnace --solution a.rad -o x.png --bounce 1")).failed("sum of all bounces");
    run(&mut place.lumel("render sphere --solution a.rad -o x.png")).failed("other positions");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let place = Place::new();
    place.bake_furnace("-o a.npz").done();
    let refused = |line: &str, words: &str| {
        run(&mut place.lumel(&format!("render {line}"))).failed(words);
    };
    refused("furnace --solution a.npz -o x.jpg", ".png");
    refused("furnace --solution a.npz -o x.png --bounce 9", "no bounce 9");
    refused("furnace --solution a.npz -o x.png --camera nobody", "its cameras are");
    refused("furnace --solution a.npz -o x.png --size 0x10", "at least one pixel");
    refused("furnace --solution a.npz -o x.png --size 99999x99999", "limit");
    refused("furnace --solution a.npz -o x.png --range 0,1", "--show false-color");
    refused("furnace --solution a.npz -o x.png --exposure nan", "exposure");
    refused("furnace -o x.png", "--solution");
    refused("furnace -o x.png --show radiance", "needs light");
    refused("sphere --solution a.npz -o x.png", "\"furnace\"");
    assert_eq!(place.files(), ["a.npz"]);
}

#[test]
fn old_light_on_new_materials_is_told() {
    let place = Place::new();
    place.bake_furnace("-o a.npz").done();
    let line = "render furnace --solution a.npz -o x.png --size 8x8 --samples 1 --sky 1,1,1";
    let changed = run(&mut place.lumel(line)).done();
    assert!(changed.stderr.contains("materials or lights have changed"), "{}", changed.stderr);
    assert_eq!(run(place.lumel(line).arg("--strict")).code, 1);
}

#[test]
fn solutions_say_how_fine_their_scene_was_made() {
    let place = Place::new();
    // More than a draft may add.
    let sheets = (0..20).map(|y| {
        let y = 0.05 * f64::from(y);
        format!("v 0 {y} 0\nv 0 {y} 1\nv 1 {y} 1\nv 1 {y} 0\nf -4 -3 -2 -1\n")
    });
    place.write("sheets.obj", &sheets.collect::<String>());
    let bake = |preset: &str, more: &str| {
        let line =
            format!("bake sheets.obj -o {preset}.npz --sky 1,1,1 --bounces 0 --preset {preset} {more}");
        run(&mut place.lumel(&format!("{line} --indirect-samples 1 --projection point"))).done();
        place.solution(&format!("{preset}.npz"))
    };
    let [draft, medium] = [bake("draft", ""), bake("medium", "")];
    assert_eq!([&draft, &medium].map(|light| light.meta.vertex_budget), [Some(50_000), Some(200_000)]);
    assert!(draft.vertex_count() < 110_000 && medium.vertex_count() > 110_000);
    for preset in ["draft", "medium"] {
        run(&mut place.lumel(&format!("render sheets.obj --solution {preset}.npz -o a.png --size 8x6")))
            .done();
        let point = "--point 0.5,0,0.5 --normal 0,1,0 --sky 1,1,1";
        run(&mut place.lumel(&format!("measure sheets.obj --solution {preset}.npz {point}"))).done();
    }
    assert_eq!(bake("draft", "--max-edge 0.5").meta.vertex_budget, None);
}

#[test]
fn normal_maps_are_lit_from_the_side_of_the_light() {
    let place = Place::new();
    let corners = "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    place.write("floor.obj", &format!("mtllib floor.mtl\n{corners}usemtl bumpy\nf 1/1 2/2 3/3 4/4\n"));
    place.write("floor.mtl", "newmtl bumpy\nKd 0.5 0.5 0.5\nnorm bumps.png\n");
    // Turned by 23° to the image's top, which is at -z.
    image::RgbImage::from_pixel(1, 1, image::Rgb([128, 177, 245])).save(place.path("bumps.png")).unwrap();
    let sun = "sun direction=0,-1,1 irradiance=3,3,3 angle=0";
    let bake = |more: &str| {
        let line = format!("bake floor.obj -o {more}.npz --directional {more} --max-edge off");
        run(place.lumel(&line).args(TINY).args(["--light", sun])).done();
    };
    let camera = "position=0,3,0.01 target=0,0,0 fov=20";
    let draw = |light: &str, more: &[&str]| {
        let line =
            format!("render floor.obj --solution {light}.npz -o a.png --size 4x4 --samples 1 --max-edge off");
        run(place.lumel(&line).args(["--exposure", "0", "--light", sun, "--camera", camera]).args(more))
            .done();
        picture(&place, "a.png").get_pixel(2, 2).0[0]
    };
    bake("off");
    bake("sh1");
    let scalar = draw("off", &[]);
    assert_eq!([draw("off", &["--normal-maps", "off"]), draw("sh1", &["--normal-maps", "off"])], [scalar; 2]);
    for shading in ["l1", "nonlinear", "zh3", "l2"] {
        let [up, down] = ["up", "down"].map(|way| draw("sh1", &["--normal-maps", way, "--shading", shading]));
        assert!(up > scalar + 5 && down + 5 < scalar, "{shading}: {up} {scalar} {down}");
    }
    run(&mut place.lumel("render floor.obj --solution sh1.npz -o a.png --normal-maps left"))
        .failed("up, down");
    // Files of glTF have green up, wherever it points in those that they are made from.
    let down = draw("sh1", &["--normal-maps", "down"]);
    for command in ["bake", "unwrap"] {
        let line = format!("{command} floor.obj -o {command}.glb --normal-maps down --max-edge off");
        let mut first = place.lumel(&line);
        if command == "bake" {
            first.args(TINY).args(["--light", sun]);
        }
        run(&mut first).done();
        let line = format!("bake {command}.glb -o b.npz --directional sh1 --max-edge off");
        run(place.lumel(&line).args(TINY).args(["--light", sun])).done();
        let line =
            format!("render {command}.glb --solution b.npz -o b.png --size 4x4 --samples 1 --max-edge off");
        run(place.lumel(&line).args(["--exposure", "0", "--light", sun, "--camera", camera])).done();
        let shown = picture(&place, "b.png").get_pixel(2, 2).0[0];
        assert!(shown.abs_diff(down) <= 2, "{command}: {shown} {down}");
    }
    run(&mut place.lumel("bake floor.obj --normal-maps off")).failed("up or down");
}

#[test]
fn a_solution_alone_is_enough_for_a_picture() {
    let place = Place::new();
    place.write("scenes/floor.obj", FLOOR);
    let lamp = "rect center=0,1,0 u=0.2,0,0 v=0,0,0.2 radiance=10,9,8 name=lamp";
    let options = ["--light", lamp, "--sky", "0.1,0.2,0.3", "--max-edge", "0.2", "--two-sided", "none"];
    let bake = |line: &str| run(place.lumel(line).args(TINY).args(options)).done();
    bake("bake scenes/floor.obj --layers lights -o a.npz");
    let size = "--size 24x18 --samples 1";
    let draw = |line: &str| run(&mut place.lumel(&format!("render {line} {size}"))).done();
    assert!(draw("a.npz").stdout.starts_with("wrote a.png, "));
    run(place.lumel(&format!("render scenes/floor.obj --solution a.npz -o b.png {size}")).args(options))
        .done();
    assert_eq!(picture(&place, "a.png"), picture(&place, "b.png"));
    assert_ne!(picture(&place, "a.png"), {
        draw("a.npz -o lamp.png --light lamp");
        picture(&place, "lamp.png")
    });
    // Both may move together; the solution knows the way.
    std::fs::create_dir(place.path("moved")).unwrap();
    for name in ["a.npz", "scenes"] {
        std::fs::rename(place.path(name), place.path(&format!("moved/{name}"))).unwrap();
    }
    draw("moved/a.npz -o c.png");
    assert_eq!(picture(&place, "a.png"), picture(&place, "c.png"));
    let failed =
        |line: &str, words: &str| run(&mut place.lumel(&format!("render {line} {size}"))).failed(words);
    failed("moved/a.npz --solution moved/a.npz", "this is a solution, not a scene");
    place.write("moved/scenes/floor.obj", &FLOOR.replace("0.5 0 -0.5", "0.5 0 -0.6"));
    let changed = failed("moved/a.npz", "the scene has changed since the bake: moved/scenes/floor.obj");
    assert!(changed.stderr.contains("bake it again"), "{}", changed.stderr);
    std::fs::remove_file(place.path("moved/scenes/floor.obj")).unwrap();
    let gone = failed("moved/a.npz", "is no longer there: moved/scenes/floor.obj");
    assert!(gone.stderr.contains("lumel render SCENE --solution moved/a.npz"), "{}", gone.stderr);
}

#[test]
fn lightmaps_and_built_in_scenes_are_remembered_too() {
    let place = Place::new();
    let tiny = TINY.join(" ");
    let line = format!("bake furnace {tiny} --basis lightmap --lumels 2000 --subdivide 1 -o map.npz");
    run(&mut place.lumel(&line)).done();
    run(&mut place.lumel(&format!("bake sphere {tiny} --adaptive 5% --max-vertices 2000 -o adaptive.npz")))
        .done();
    for (solution, scene) in [("map", "furnace --subdivide 1"), ("adaptive", "sphere")] {
        let size = "--size 24x18 --samples 1";
        run(&mut place.lumel(&format!("render {solution}.npz {size}"))).done();
        run(&mut place.lumel(&format!("render {scene} --solution {solution}.npz -o b.png {size}"))).done();
        assert_eq!(picture(&place, &format!("{solution}.png")), picture(&place, "b.png"));
    }
}
