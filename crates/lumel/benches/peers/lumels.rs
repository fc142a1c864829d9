//! Lightmaps that renderers bake into one atlas.

use crate::places::Places;
use crate::scenes::{self, Detail};
use crate::{BOUNCES, CLOSE, describe, is_behind, solved, write};
use cpu_time::ProcessTime;
use glam::Vec3;
use lumel::{Baker, Basis, Control, Light, Lightmap, Lumels, Scene, Settings};
use lumel_basis::{Field, PointReceivers};
use lumel_lightmap::{Filter, LumelLighting};
use lumel_scene::{Barycentrics, SurfacePoint, TriId};
use lumel_testkit::Reference;
use lumel_transport::{CpuTransport, Plan, Transport};
use lumel_uv::{Density, Pace, UnwrapSettings, unwrap};
use serde_json::json;
use std::path::Path;
use std::sync::Arc;

/// Points of the surfaces where light is compared.
const POINTS: u32 = 4000;

/// Independent measurements of the reference.
const PASSES: u32 = 4;

/// The scene as it is given, and its lumels.
fn lumels(name: &str) -> Lumels {
    let scene = Arc::new(scenes::open(name, Places::Surfaces, Detail::Given));
    let density = Density::Budget(if name == "sponza" { 1 << 18 } else { 1 << 16 });
    let settings = UnwrapSettings { density, page_size: 2048, ..UnwrapSettings::default() };
    let atlas = unwrap(&scene, &settings, &|| Pace::Go).unwrap().atlas;
    assert_eq!(atlas.pages().len(), 1, "peers bake one page");
    Lumels::new(scene, atlas)
}

/// Writes the scene, where its corners lie on the page, and the points that are compared with their light.
pub(crate) fn export(name: &str, folder: &Path) {
    let lumels = lumels(name);
    let scene = &lumels.scene;
    let reference = reference(name, scene);
    let [Light::Rect(light)] = scene.lights() else { panic!("{name} has other lights than one rectangle") };
    let gap = CLOSE * scene.bounds().diagonal();
    let seen = |i: &usize| !is_behind(light, scene.position(reference.points()[*i]), gap);
    let compared: Vec<usize> = (0..reference.points().len()).filter(seen).collect();
    let points = || compared.iter().map(|&i| reference.points()[i]);
    let [width, height] = lumels.atlas.pages()[0];
    let size = [width, height].map(|side| side as f32);
    let corners = (0..scene.traced_count() as u32).flat_map(|tri| lumels.atlas.corners(TriId(tri)));
    std::fs::create_dir_all(folder).unwrap();
    let description = json!({
        "lumels": lumels.coverage.len(), "page": [width, height], "points": compared.len(),
        "noise": reference.noise(),
    });
    describe(name, scene, description, folder);
    let places = corners.flat_map(|at| [at.x / size[0], at.y / size[1]]);
    write(folder, "corners.f32", places.map(f32::to_le_bytes));
    write(folder, "points.u32", points().map(|at| at.tri.0.to_le_bytes()));
    write(folder, "points.f32", points().flat_map(|at| [at.bary.u, at.bary.v]).map(f32::to_le_bytes));
    let values = compared.iter().flat_map(|&i| reference.values()[i].as_vec3().to_array());
    write(folder, "reference.f32", values.map(f32::to_le_bytes));
}

/// Light at random points: many samples at each, of bounces that a finer mesh carries.
fn reference<'a>(name: &str, scene: &'a Scene) -> Reference<'a> {
    let fine = Arc::new(scenes::open(name, Places::Surfaces, Detail::Fine));
    let long = Settings { direct_samples: 256, indirect_samples: 256, ..Places::Surfaces.settings() };
    let baker = Baker::new(fine, long);
    let state = solved(&baker);
    let carried = Field::sum(baker.basis().node_count(), &state.bounces[..BOUNCES as usize]);
    let plan = Plan { direct_samples: 512, indirect_samples: 2048, ..baker.settings().plan() };
    let towards = |points: PointReceivers| -> Box<dyn Transport> {
        let (scene, tracer) = (Arc::clone(baker.scene()), Arc::clone(baker.tracer()));
        Box::new(CpuTransport::new(scene, tracer, Arc::clone(baker.basis()), Arc::new(points), plan))
    };
    Reference::measured(scene, POINTS, 7, towards, Some(&carried), PASSES)
}

/// Writes the light at the points that are compared, noisy and denoised; prints processor time of all threads from the scene and
/// the atlas to light that can be read.
pub(crate) fn bake(name: &str, folder: &Path, settings: Settings) {
    let lumels = lumels(name);
    let fine = Arc::new(scenes::open(name, Places::Surfaces, Detail::Usual));
    let (direct, indirect) = (settings.direct_samples, settings.indirect_samples);
    let start = ProcessTime::now();
    let lumels = Lumels::new(Arc::clone(&lumels.scene), (*lumels.atlas).clone());
    let baker = Baker::new(fine, settings);
    let state = solved(&baker);
    let carried = start.elapsed().as_secs_f64();
    let light = baker.light_at_lumels(&state, &lumels, &Control::default()).unwrap();
    let measured = start.elapsed().as_secs_f64();
    let Lumels { scene, atlas, coverage } = &lumels;
    let finished = |denoises: bool, name: &str| {
        let start = ProcessTime::now();
        let known = denoises.then(|| baker.solved_at_lumels(&state, &lumels));
        let map = Lightmap::finished(scene, atlas, coverage, &light, known.as_ref(), None);
        let seconds = start.elapsed().as_secs_f64();
        write_light(&map.lighting(0), folder, name);
        measured + seconds
    };
    let [noisy, denoised] =
        [(false, "noisy.f32"), (true, "denoised.f32")].map(|(is, name)| finished(is, name));
    println!(
        "{}",
        json!({
            "direct_samples": direct, "indirect_samples": indirect, "cpu_seconds": noisy,
            "denoised_cpu_seconds": denoised, "carried_cpu_seconds": carried,
        })
    );
}

/// Writes the light at the points that are compared, read from the lumels of the page, row by row.
pub(crate) fn read(name: &str, folder: &Path, page: &str, answer: &str) {
    let lumels = lumels(name);
    let values: Vec<Vec3> =
        numbers(folder, page, f32::from_le_bytes).chunks(3).map(Vec3::from_slice).collect();
    assert_eq!(values.len(), lumels.atlas.lumel_count(), "as many lumels as the page has");
    let light = LumelLighting { atlas: &lumels.atlas, values: &values, filter: Filter::Bilinear };
    write_light(&light, folder, answer);
}

fn write_light(light: &LumelLighting<'_>, folder: &Path, name: &str) {
    let tris = numbers(folder, "points.u32", u32::from_le_bytes);
    let barys = numbers(folder, "points.f32", f32::from_le_bytes);
    let points = tris.into_iter().zip(barys.chunks(2));
    let points =
        points.map(|(tri, at)| SurfacePoint { tri: TriId(tri), bary: Barycentrics { u: at[0], v: at[1] } });
    let values = points.flat_map(|at| light.at(at).0.to_array());
    write(folder, name, values.map(f32::to_le_bytes));
}

fn numbers<T>(folder: &Path, name: &str, from: fn([u8; 4]) -> T) -> Vec<T> {
    let bytes = std::fs::read(folder.join(name)).unwrap();
    bytes.chunks(4).map(|bytes| from(bytes.try_into().unwrap())).collect()
}
