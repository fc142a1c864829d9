//! Lightmaps as three.js shows them in a browser, against the pictures that lumel draws itself.
//!
//! The files are written to `target/tmp/three`, where one can look at them.

use glam::Vec3;
use lumel::{
    Baker, BounceLimit, Camera, Control, Irradiance, Lightmap, Lumels, Material, Scene, SceneBuilder,
    Settings, Silent, SolveState, tracer_of,
};
use lumel_export::{LightmapTarget, write_lightmap_glb, write_png};
use lumel_render_cpu::{Display, Picture, Resolution, ToneMapper, View, draw};
use lumel_scene::{Encoding, Radiance, SurfacePoint, Texture, TextureId, TextureRef};
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

/// A room of large triangles with walls of several colours, a block, and a lamp that is a surface.
fn room() -> SceneBuilder {
    let sides = cuboid(Vec3::ZERO, Vec3::new(3.0, 2.0, 3.0), 1, Facing::Inward, [1, 2, 3, 0, 0, 0]);
    let block = cuboid(Vec3::new(0.7, 0.2, 0.8), Vec3::new(1.4, 1.1, 1.7), 1, Facing::Outward, [0; 6]);
    let lamp = [[1.7, 1.2], [2.3, 1.2], [2.3, 1.8], [1.7, 1.8]].map(|[x, z]| Vec3::new(x, 1.99, z));
    let lamp = quad(lamp, [1, 1], 4);
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
    ];
    let tiles = vec![[230, 60, 20, 255], [250, 250, 240, 255], [30, 60, 200, 255], [20, 20, 20, 255]];
    let tiles = Texture::from_bytes("tiles", 2, 2, tiles, Encoding::Srgb).unwrap();
    let meshes = sides.into_iter().chain(block).chain([lamp]).collect();
    SceneBuilder { textures: vec![tiles], ..scene(meshes, materials, Vec::new()) }
}

fn camera() -> Camera {
    Camera::looking_at("c", Vec3::new(2.7, 1.5, 2.8), Vec3::new(1.2, 0.7, 1.0), 70_f32.to_radians())
}

/// The room with light on an atlas of pages of each size.
fn baked(page_sizes: [u32; 2]) -> (Arc<Scene>, [Lightmap; 2]) {
    let builder = room();
    let scene = Arc::new(builder.clone().build().unwrap().0);
    let mut fine = builder;
    fine.tessellate(0.3).unwrap();
    let bounces = BounceLimit::Count(2);
    let settings = Settings { bounces, direct_samples: 16, indirect_samples: 32, ..Settings::default() };
    let (baker, mut state) = (Baker::new(Arc::new(fine.build().unwrap().0), settings), SolveState::new());
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    let lightmaps = page_sizes.map(|page_size| {
        let density = Density::PerMetre(20.0);
        let settings = UnwrapSettings { density, page_size, ..UnwrapSettings::default() };
        let atlas = unwrap(&scene, &settings, &|| Pace::Go).unwrap().atlas;
        let lumels = Lumels::new(Arc::clone(&scene), atlas);
        let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
        let known = baker.solved_at_lumels(&state, &lumels);
        Lightmap::finished(&scene, &lumels.atlas, &lumels.coverage, &light, Some(&known), None)
    });
    (scene, lightmaps)
}

fn drawn(scene: &Scene, lightmap: &Lightmap) -> Picture {
    let tracer = tracer_of(scene);
    let lighting = |at: SurfacePoint, _: Vec3| -> Irradiance { lightmap.at(0, at) };
    let view = View::new(scene, &*tracer, &lighting);
    let display = Display { tone: ToneMapper::None, ..Display::default() };
    draw(&view, &camera(), &RESOLUTION, &display, &AtomicBool::new(false)).unwrap()
}

/// A GLB file, where three.js is to leave its picture of it, and the one that is expected.
struct Case {
    glb: PathBuf,
    png: PathBuf,
    reader: &'static str,
    max_share: f64,
    expected: Picture,
}

impl Case {
    /// What the script is told.
    fn described(&self) -> Value {
        let Camera { position, forward, fov_y, .. } = camera();
        json!({
            "glb": self.glb,
            "png": self.png,
            "reader": self.reader,
            "width": RESOLUTION.width,
            "height": RESOLUTION.height,
            "stops": self.expected.stops(),
            "fov_deg": fov_y.to_degrees(),
            "position": position.to_array(),
            "target": (position + forward).to_array(),
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
fn three_js_draws_lightmaps_as_lumel_does() {
    if !has_browser() {
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("three");
    std::fs::create_dir_all(&folder).unwrap();
    let (scene, lightmaps) = baked([512, 128]);
    assert!(lightmaps[0].atlas.pages().len() == 1 && lightmaps[1].atlas.pages().len() > 1);
    let mut cases = Vec::new();
    for (lightmap, pages) in lightmaps.iter().zip(["page", "pages"]) {
        let expected = drawn(&scene, lightmap);
        for (reader, target, max_share) in READERS {
            let [glb, png, own] =
                ["glb", "png", "lumel.png"].map(|ending| folder.join(format!("{reader}-{pages}.{ending}")));
            write_lightmap_glb(&glb, &scene, lightmap, target).unwrap();
            write_png(&own, expected.width(), expected.height(), expected.pixels(), &[]).unwrap();
            cases.push(Case { glb, png, reader, max_share, expected: expected.clone() });
        }
    }
    draw_with_three_js(&folder, &cases);
    for case in &cases {
        let (share, name) = (case.difference(), case.png.display());
        println!("{:.2} % of {name} differ", 100.0 * share);
        assert!(share < case.max_share, "{} % of {name} differ by more than {MAX_STEPS}", 100.0 * share);
    }
}
