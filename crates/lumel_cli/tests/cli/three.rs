//! Baked scenes as three.js shows them in a browser, against the pictures that lumel draws itself.
//!
//! The files are written to the folder `three` of `CARGO_TARGET_TMPDIR`, where one can look at them.

use glam::Vec3;
use lumel::{
    Baker, BounceLimit, Camera, Control, Irradiance, Light, Lighting, Lightmap, Lumels, Material, RectLight,
    Scene, SceneBuilder, Settings, Silent, SolutionSelection, SolveState, tracer_of,
};
use lumel_export::{ColorScale, LightmapTarget, write_glb, write_lightmap_glb, write_png};
use lumel_render_cpu::{Display, Picture, Resolution, ToneMapper, View, draw};
use lumel_scene::{
    AlphaMode, Encoding, PointLight, Radiance, Sides, SurfacePoint, Texture, TextureId, TextureRef,
    Transparency,
};
use lumel_testkit::mesh::{Facing, cuboid, quad};
use lumel_testkit::scene::scene;
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Both see the middle of each pixel only, so that edges are at the same places.
const RESOLUTION: Resolution = Resolution { width: 320, height: 240, samples_per_pixel: 1 };

/// Steps of 255 by which most pixels may differ: files and pictures have 8 bits.
const MAX_STEPS: u8 = 2;

/// What reads a file, the target that it is made for, and the share of pixels that may differ more: some at edges, and those
/// where bytes are coarse, or lumels that hold a texture.
const READERS: [(&str, LightmapTarget, f64); 3] = [
    ("plugin", LightmapTarget::Three, 0.001),
    ("bytes", LightmapTarget::Three, 0.01),
    ("none", LightmapTarget::Any, 0.01),
];

/// The share of pixels that may differ more where light is at vertices.
const MAX_SHARE_AT_VERTICES: f64 = 0.002;

/// A room of large triangles with walls of several colours, a block, a lamp that is a surface, one that is a rectangle and one
/// that is a point, a pane with holes and one of smoke, seen by a camera.
fn room() -> SceneBuilder {
    let sides = cuboid(Vec3::ZERO, Vec3::new(3.0, 2.0, 3.0), 1, Facing::Inward, [1, 2, 3, 0, 0, 0]);
    let block = cuboid(Vec3::new(0.7, 0.2, 0.8), Vec3::new(1.4, 1.1, 1.7), 1, Facing::Outward, [0; 6]);
    let lamp = [[1.7, 1.2], [2.3, 1.2], [2.3, 1.8], [1.7, 1.8]].map(|[x, z]| Vec3::new(x, 1.99, z));
    let lamp = quad(lamp, [1, 1], 4);
    let pane = |[x, y, z]: [f32; 3], material| {
        let corners = [[0.0, 0.0], [0.6, 0.0], [0.6, 0.6], [0.0, 0.6]];
        quad(corners.map(|[u, v]| Vec3::new(x + u, y + v, z)), [1, 1], material)
    };
    let panes = [pane([1.6, 0.1, 1.9], 5), pane([1.0, 1.0, 1.8], 6)];
    let diffuse = |name, albedo: [f32; 3]| Material::diffuse(name, albedo);
    let materials = vec![
        diffuse("white", [0.75; 3]),
        diffuse("red", [0.6, 0.05, 0.05]),
        diffuse("green", [0.1, 0.5, 0.1]),
        Material {
            albedo_texture: Some(TextureRef::plain(TextureId(0))),
            ..diffuse("floor", [0.9, 0.8, 0.7])
        },
        Material { emission: Radiance(Vec3::new(12.0, 11.0, 9.0)), ..diffuse("lamp", [0.2; 3]) },
        Material {
            albedo_texture: Some(TextureRef::plain(TextureId(1))),
            transparency: Transparency {
                mode: AlphaMode::Mask { cutoff: 0.5 },
                texture: Some(TextureRef::plain(TextureId(1))),
                ..Transparency::default()
            },
            sides: Sides::Both,
            ..diffuse("holes", [0.8; 3])
        },
        Material {
            transparency: Transparency::blend(0.4),
            sides: Sides::Both,
            ..diffuse("smoke", [0.5, 0.4, 0.2])
        },
    ];
    let holes = vec![[250, 250, 240, 255], [30, 60, 200, 0], [250, 60, 20, 0], [250, 250, 240, 255]];
    let holes = Texture::from_bytes("holes", 2, 2, holes, Encoding::Srgb).unwrap();
    let tiles = vec![[230, 60, 20, 255], [250, 250, 240, 255], [30, 60, 200, 255], [20, 20, 20, 255]];
    let tiles = Texture::from_bytes("tiles", 2, 2, tiles, Encoding::Srgb).unwrap();
    let meshes = sides.into_iter().chain(block).chain([lamp]).chain(panes).collect();
    let panel = RectLight {
        center: Vec3::new(0.01, 1.3, 0.6),
        u: Vec3::Y * 0.2,
        v: Vec3::Z * 0.3,
        radiance: Radiance(Vec3::new(1.0, 2.0, 4.0)),
        texture: None,
    };
    let bulb =
        PointLight { position: Vec3::new(2.0, 1.2, 2.4), intensity: Vec3::splat(0.4), range: f32::INFINITY };
    let camera =
        Camera::looking_at("c", Vec3::new(2.7, 1.5, 2.8), Vec3::new(1.2, 0.7, 1.0), 70_f32.to_radians());
    SceneBuilder {
        textures: vec![tiles, holes],
        lights: vec![Light::Rect(panel), Light::Point(bulb)],
        cameras: vec![camera],
        ..scene(meshes, materials, Vec::new())
    }
}

/// The room with light at its vertices, and on an atlas of pages of each size.
struct Baked {
    baker: Baker,
    state: SolveState,
    scene: Arc<Scene>,
    lightmaps: [Lightmap; 2],
}

fn baked(page_sizes: [u32; 2]) -> Baked {
    let builder = room();
    let scene = Arc::new(builder.clone().build().unwrap().0);
    let mut fine = builder;
    fine.tessellate(0.3).unwrap();
    let bounces = BounceLimit::Count(2);
    let settings = Settings { bounces, direct_samples: 16, indirect_samples: 32, ..Settings::default() };
    let (baker, mut state) = (Baker::new(Arc::new(fine.build().unwrap().0), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let lightmaps = page_sizes.map(|page_size| {
        let density = Density::PerMetre(28.0);
        let settings = UnwrapSettings { density, page_size, ..UnwrapSettings::default() };
        let atlas = unwrap(&scene, &settings, &|| Pace::Go).unwrap().atlas;
        let lumels = Lumels::new(Arc::clone(&scene), atlas);
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        let known = baker.solved_at_lumels(&state, &lumels);
        Lightmap::finished(&scene, &lumels.atlas, &lumels.coverage, &light, Some(&known), None)
    });
    Baked { baker, state, scene, lightmaps }
}

fn drawn(scene: &Scene, lighting: &dyn Lighting) -> Picture {
    let tracer = tracer_of(scene);
    let view = View::new(scene, &*tracer, lighting);
    let display = Display { tone: ToneMapper::None, ..Display::default() };
    draw(&view, &scene.cameras()[0], &RESOLUTION, &display, &AtomicBool::new(false)).unwrap()
}

/// A GLB file, where three.js is to leave its picture of it, and the one that is expected.
struct Case {
    glb: PathBuf,
    png: PathBuf,
    reader: &'static str,
    max_share: f64,
    /// The factor that is in the file already.
    exposure: f32,
    expected: Picture,
}

impl Case {
    /// What the script is told.
    fn described(&self) -> Value {
        json!({
            "glb": self.glb,
            "png": self.png,
            "reader": self.reader,
            "width": RESOLUTION.width,
            "height": RESOLUTION.height,
            "exposure": self.expected.stops().unwrap().exp2() / self.exposure,
        })
    }

    /// The share of pixels that differ by more than [`MAX_STEPS`].
    fn difference(&self) -> f64 {
        let shown = image::open(&self.png).unwrap().to_rgb8();
        assert_eq!(shown.dimensions(), (RESOLUTION.width, RESOLUTION.height));
        let pairs = self.expected.pixels().iter().zip(shown.pixels());
        let differs = |own: &[u8; 3], shown: &[u8; 3]| (0..3).any(|k| own[k].abs_diff(shown[k]) > MAX_STEPS);
        let n = pairs.filter(|(own, shown)| differs(own, &shown.0)).count();
        n as f64 / self.expected.pixels().len() as f64
    }
}

/// Whether there is a browser. In CI there must be: `cargo x test` sees to it.
fn has_browser() -> bool {
    let is_named = std::env::var_os("LUMEL_BROWSER").is_some();
    if !is_named {
        assert!(std::env::var_os("CI").is_none(), "CI must have LUMEL_BROWSER, set by `cargo x test`");
        println!("skipped: LUMEL_BROWSER names no browser; `cargo x test` fetches one");
    }
    is_named
}

/// Lets three.js draw all files, with one start of the browser.
fn draw_with_three_js(folder: &Path, cases: &[Case]) {
    let list = folder.join("pictures.json");
    std::fs::write(&list, cases.iter().map(Case::described).collect::<Value>().to_string()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/three/browser.mjs");
    let out = Command::new("node").arg(script).arg(&list).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

#[test]
fn three_js_draws_baked_scenes_as_lumel_does() {
    if !has_browser() {
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("three");
    std::fs::create_dir_all(&folder).unwrap();
    let Baked { baker, state, scene, lightmaps } = baked([512, 128]);
    assert!(lightmaps[0].atlas.pages().len() == 1 && lightmaps[1].atlas.pages().len() > 1);
    let paths =
        |name: &str| ["glb", "png", "lumel.png"].map(|ending| folder.join(format!("{name}.{ending}")));
    let mut cases = Vec::new();
    for (lightmap, pages) in lightmaps.iter().zip(["page", "pages"]) {
        let expected = drawn(&scene, &|at: SurfacePoint, _: Vec3| -> Irradiance { lightmap.at(0, at) });
        for (reader, target, max_share) in READERS {
            let [glb, png, own] = paths(&format!("{reader}-{pages}"));
            write_lightmap_glb(&glb, &scene, lightmap, target).unwrap();
            write_png(&own, expected.width(), expected.height(), expected.pixels(), &[]).unwrap();
            cases.push(Case { glb, png, reader, max_share, exposure: 1.0, expected: expected.clone() });
        }
    }
    let [glb, png, own] = paths("vertices");
    let (scene, solution) = (baker.scene(), baker.solution(&state));
    let lighting = solution.lighting(scene, &SolutionSelection::Sum).unwrap();
    let exposure = write_glb(&glb, scene, &lighting, ColorScale::Unclipped).unwrap();
    let expected = drawn(scene, &lighting);
    write_png(&own, expected.width(), expected.height(), expected.pixels(), &[]).unwrap();
    let max_share = MAX_SHARE_AT_VERTICES;
    cases.push(Case { glb, png, reader: "none", max_share, exposure, expected });
    draw_with_three_js(&folder, &cases);
    for case in &cases {
        let (share, name) = (case.difference(), case.png.display());
        println!("{:.2} % of {name} differ", 100.0 * share);
        assert!(share < case.max_share, "{} % of {name} differ by more than {MAX_STEPS}", 100.0 * share);
    }
}
