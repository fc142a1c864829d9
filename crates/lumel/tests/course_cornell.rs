//! Our light against the solution handed out with a university course, computed by another program in 2024.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests")]

use glam::{DVec3, Vec3};
use lumel::{
    Baker, BounceLimit, Control, Light, Method, Projection, RectLight, Scene, Settings, Silent, SolveState,
};
use lumel_export::RadFile;
use lumel_scene::Radiance;
use lumel_testkit::shared;
use std::path::Path;
use std::sync::Arc;

/// Light `2024/1` of the course's `presets.json`.
fn light_2024_1() -> RectLight {
    let half_size = 0.188_198_64;
    let towards = Vec3::new(0.508_129_66, -0.577_200_23, -0.639_252_84);
    // The course's light shines towards minus its z axis: turn the x axis round so that u × v points there.
    let u = -half_size * Vec3::new(0.782_819_87, 0.0, 0.622_248_3);
    let v = half_size * Vec3::new(0.359_161_88, 0.816_602_7, -0.451_843_86);
    let center = Vec3::new(-0.664_146_36, 0.720_128_5, 0.722_028);
    let light = RectLight { center, u, v, radiance: Radiance::splat(100.0), texture: None };
    assert!((light.normal().unwrap() - towards).length() < 1e-5);
    light
}

fn open(mesh: &Path) -> Arc<Scene> {
    let mut opened = lumel::open(
        &mesh,
        &lumel::OpenOptions {
            max_edge: Some(lumel::MaxEdge::Off),
            two_sided: vec!["none".to_owned()],
            ..Default::default()
        },
    )
    .unwrap();
    opened.builder.lights = vec![Light::Rect(light_2024_1())];
    Arc::new(opened.builder.build().unwrap().0)
}

fn mean(values: &[Vec3]) -> DVec3 {
    values.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / values.len() as f64
}

/// Pearson's correlation of all channels taken together.
fn correlation(a: &[Vec3], b: &[Vec3]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a.as_dvec3() - mean_a, b.as_dvec3() - mean_b);
        ab += a.dot(b);
        aa += a.dot(a);
        bb += b.dot(b);
    }
    ab / (aa * bb).sqrt()
}

#[test]
fn two_bounces_agree_with_the_solution_of_the_course() {
    let Some(folder) = shared::path_or_skip("scenes/course-cornell") else { return };
    let scene = open(&folder.join("cornell-tessellated.obj"));
    let theirs = RadFile::read(&folder.join("cornell-2bounces.rad")).unwrap();
    assert!(theirs.matches(&scene), "vertices must come in the order of the file");
    let settings = Settings {
        // The course measures light at the vertices.
        projection: Projection::Point,
        bounces: BounceLimit::Count(2),
        direct_samples: 64,
        indirect_samples: 256,
        ..Settings::default()
    };
    let baker = Baker::new(Arc::clone(&scene), settings);
    assert!(matches!(baker.method(), Method::Cached { .. }), "the default: {}", baker.method());
    let mut state = SolveState::new();
    baker.run(&mut state, &Control::default(), &Silent).unwrap();
    // Vertices under the boxes see nothing and are dark in the course's solution; ours have the light of their
    // neighbours there, on purpose.
    let solution = baker.solution(&state);
    let measured = |values: &[Vec3]| -> Vec<Vec3> {
        values.iter().zip(&solution.valid).filter(|(_, valid)| **valid).map(|(value, _)| *value).collect()
    };
    let n_hidden = solution.valid.iter().filter(|valid| !**valid).count();
    let (ours, theirs) = (measured(&solution.irradiance), measured(&theirs.irradiance()));
    assert!(n_hidden < scene.vertex_count() / 20, "{n_hidden} hidden vertices");
    let ratio = mean(&ours) / mean(&theirs);
    println!(
        "{n_hidden} hidden, means {} and {}, ratio {ratio}, correlation {}",
        mean(&ours),
        mean(&theirs),
        correlation(&ours, &theirs)
    );
    assert!((ratio - DVec3::ONE).abs().max_element() < 0.005, "ratio of means {ratio}");
    assert!(correlation(&ours, &theirs) > 0.99, "{}", correlation(&ours, &theirs));
}
