//! Skies that are not the same all around.

use glam::Vec3;
use lumel_scene::{Light, Radiance, SceneBuilder, Sky, SkyGradient, SkyImage, Texture};
use lumel_testkit::mesh::quad;
use lumel_testkit::scene::{ceiling_light, grey, scene};
use lumel_testkit::{
    AtPoints, Combination, Estimate, Method, Solver, Stage, assert_nodes_near, form_factor, measure,
    replicates,
};
use lumel_transport::{EmitterMask, Plan, Source};
use std::f64::consts::{FRAC_PI_2, PI};

const SIZE: [u32; 2] = [64, 32];

/// An image whose texels are a function of column and row.
fn image(texel: impl Fn(u32, u32) -> f32, rotation: f32) -> Sky {
    let [width, height] = SIZE;
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels = texels.map(|(x, y)| [texel(x, y); 3]).collect();
    SkyImage::new(Texture::from_floats("sky", width, height, texels).expect("it has texels"), rotation, 1.0)
        .into()
}

/// A floor that faces up, under a sky.
fn under(sky: Sky) -> SceneBuilder {
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    SceneBuilder { sky, ..scene(vec![quad(corners, [2, 2], 0)], vec![grey(0.0, 0.0)], Vec::new()) }
}

/// Irradiance above the floor with a normal, by every solver and sampler.
fn lit(builder: &SceneBuilder, normal: Vec3, samples: [u32; 2], check: impl Fn(&Estimate, String)) {
    let stage = Stage::new(builder.clone());
    for combination in AtPoints::all() {
        let plan = combination.estimator.plan(samples[0], samples[1]);
        let transport = stage.points(combination.solver, &[(Vec3::new(0.5, 0.1, 0.5), normal)], plan);
        let fields = replicates(&*transport, Source::Emitters(None), 32);
        check(&Estimate::of_node(&fields, 0), combination.to_string());
    }
}

#[test]
fn a_uniform_image_is_a_uniform_sky_in_every_combination() {
    let stage = Stage::new(under(image(|_, _| 0.5, 1.0)));
    for combination in Combination::all() {
        let operator = stage.operator(combination.method, combination.estimator.plan(16, 64));
        let expected = stage.expected(&operator, &|_, _| 0.5 * PI);
        let fields = replicates(&*operator.transport, Source::Emitters(None), 32);
        assert_nodes_near(&fields, &expected, 1e-4, combination);
    }
}

#[test]
fn gradients_have_closed_forms_whichever_way_a_surface_faces() {
    let [zenith, horizon, ground] = [3.0, 1.0, 0.25].map(Radiance::splat);
    let builder = under(SkyGradient { zenith, horizon, ground }.into());
    let up = PI * (1.0 + 2.0 * 3.0) / 3.0;
    lit(&builder, Vec3::Y, [1, 256], |estimate, what| estimate.assert_near(up, 1e-4, what));
    let stage = Stage::new(builder);
    // So far away that the floor hides nothing.
    let aside = |normal| (Vec3::new(0.5, -5000.0, 0.5), normal);
    for (normal, e) in [
        (-Vec3::Y, PI * (1.0 + 2.0 * 0.25) / 3.0),
        (Vec3::X, PI + (2.0 - 0.75) * 2.0 / 3.0),
        (Vec3::Z, PI + (2.0 - 0.75) * 2.0 / 3.0),
    ] {
        let transport = stage.points(Solver::Traced, &[aside(normal)], Plan::default());
        let fields = replicates(&*transport, Source::Emitters(None), 32);
        Estimate::of_node(&fields, 0).assert_near(e, 1e-4, normal);
    }
    for method in Method::ALL {
        let operator = stage.operator(method, Plan { indirect_samples: 256, ..Plan::default() });
        let fields = replicates(&*operator.transport, Source::Emitters(None), 32);
        let expected = stage.expected(&operator, &|_, _| PI * 7.0 / 3.0);
        assert_nodes_near(&fields, &expected, 1e-4, method);
    }
}

/// The integral of the cosine to +Y over a texel of this row, sr.
fn projected_texel(row: u32) -> f64 {
    let height = |edge: u32| (PI * f64::from(edge) / f64::from(SIZE[1])).cos();
    PI / f64::from(SIZE[0]) * (height(row).powi(2) - height(row + 1).powi(2))
}

#[test]
fn one_bright_texel_is_found_by_few_rays() {
    let (bright, dim) = (1e5f32, 0.1f32);
    let sky = image(|x, y| if (x, y) == (20, 9) { bright } else { dim }, 0.3);
    let e = f64::from(bright - dim) * projected_texel(9) + PI * f64::from(dim);
    lit(&under(sky), Vec3::Y, [16, 64], |estimate, what| {
        estimate.assert_near(e, 1e-5 * e, &what);
        // Of one measurement: uniform directions would have an error of several hundred percent.
        let one = estimate.error * (estimate.count as f64).sqrt();
        assert!(one < 0.05 * e, "{what}: {one} of {e}");
    });
}

#[test]
fn a_dim_sky_beside_a_sun_keeps_the_noise_of_hemisphere_rays() {
    let (bright, dim) = (3e3f32, 1.0f32);
    // The sun is below the horizon, where it takes half of all shadow rays for itself.
    let sky = image(|x, y| if (x, y) == (20, 25) { bright } else { dim }, 0.0);
    lit(&under(sky), Vec3::Y, [16, 256], |estimate, what| {
        estimate.assert_near(PI, 1e-3, &what);
        let one = estimate.error * (estimate.count as f64).sqrt();
        assert!(one < 0.01 * PI, "{what}: {one}");
    });
}

#[test]
fn rotation_turns_the_sky_counter_clockwise_about_y() {
    // A band around the middle of the image, -z.
    let texel = |x: u32, _| if x.abs_diff(32) < 4 { 1.0 } else { 0.0 };
    let seen = |rotation: f64, normal: Vec3| {
        let stage = Stage::new(under(image(texel, rotation as f32)));
        let transport = stage.points(Solver::Traced, &[(Vec3::Y * 5000.0, normal)], Plan::default());
        Estimate::of_node(&replicates(&*transport, Source::Emitters(None), 8), 0).mean
    };
    let ahead = seen(0.0, -Vec3::Z);
    assert!(ahead > 0.5, "{ahead}");
    for (rotation, normal) in
        [(FRAC_PI_2, -Vec3::X), (PI, Vec3::Z), (-FRAC_PI_2, Vec3::X), (4.0 * PI, -Vec3::Z)]
    {
        let turned = seen(rotation, normal);
        assert!((turned / ahead - 1.0).abs() < 0.01, "{rotation}: {turned} {ahead}");
        assert!(seen(rotation, -normal) < 1e-6, "{rotation}");
    }
}

#[test]
fn half_a_sky_is_half_the_light() {
    let sky = image(|x, _| if x >= SIZE[0] / 2 { 1.0 } else { 0.0 }, 0.0);
    let builder = under(sky);
    lit(&builder, Vec3::Y, [64, 256], |estimate, what| estimate.assert_near(0.5 * PI, 1e-4, what));
    let stage = Stage::new(builder);
    for (normal, e) in [(Vec3::X, PI), (-Vec3::X, 0.0)] {
        let transport = stage.points(Solver::Stored, &[(Vec3::Y * 5000.0, normal)], Plan::default());
        let fields = replicates(&*transport, Source::Emitters(None), 32);
        Estimate::of_node(&fields, 0).assert_near(e, 1e-4, normal);
    }
}

#[test]
fn what_hides_the_sun_of_an_image_makes_a_shadow() {
    let sky = image(|x, y| if (x, y) == (20, 3) { 1e5 } else { 0.0 }, 0.0);
    let mut builder = under(sky);
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, z]| Vec3::new(x, 2.0, z));
    builder.objects.push(quad(corners, [1, 1], 0));
    for method in Method::ALL {
        let stage = Stage::new(builder.clone());
        let operator = stage.operator(method, Plan { direct_samples: 16, ..Plan::default() });
        let field = measure(&*operator.transport, Source::Emitters(None), 0).field;
        for ((point, _), e) in stage.nodes().iter().zip(field.values()).filter(|((p, _), _)| p.y < 1.0) {
            assert_eq!(*e, Vec3::ZERO, "{method} at {point}");
        }
    }
}

#[test]
fn images_add_to_few_and_to_many_lights() {
    for n in [1, 12] {
        let rects: Vec<_> = (0..n)
            .map(|i| ceiling_light(Vec3::new(0.3 * i as f32 - 1.0, 0.2, 1.0), 0.5, 0.4, 1.0 + i as f32))
            .collect();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let lights = rects.iter().map(|&rect| Light::Rect(rect)).collect();
        let floor = scene(vec![quad(corners, [2, 2], 0)], vec![grey(0.0, 0.0)], lights);
        let stage = Stage::new(SceneBuilder { sky: image(|_, _| 0.5, 0.0), ..floor });
        for method in Method::ALL {
            let plan = Plan { direct_samples: 64, indirect_samples: 128, ..Plan::default() };
            let operator = stage.operator(method, plan);
            let expected = stage.expected(&operator, &|p, normal| {
                let rect = |rect: &lumel_scene::RectLight| {
                    let corners = rect.corners().map(|p| p.as_dvec3());
                    f64::from(rect.radiance.0.x) * form_factor::polygon(&corners, p, normal)
                };
                PI * (0.5 + rects.iter().map(rect).sum::<f64>())
            });
            let fields = replicates(&*operator.transport, Source::Emitters(None), 48);
            assert_nodes_near(&fields, &expected, 5e-3, format!("{method}, {n} lights"));
        }
    }
}

#[test]
fn a_masked_sky_is_dark() {
    let stage = Stage::new(under(image(|_, _| 1.0, 0.0)));
    let none = EmitterMask::only(stage.scene(), &[]);
    for method in Method::ALL {
        let operator = stage.operator(method, Plan::default());
        let field = measure(&*operator.transport, Source::Emitters(Some(&none)), 0).field;
        assert!(field.values().iter().all(|e| *e == Vec3::ZERO), "{method}");
    }
}
