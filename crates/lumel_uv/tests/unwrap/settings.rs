//! What can be asked for.

use crate::meshes::{room, soup};
use crate::{built, settings, unwrapped};
use glam::Vec2;
use lumel_scene::TriId;
use lumel_uv::{Density, Pace, UnwrapSettings, UvError, check, unwrap};

#[test]
fn a_budget_is_used_but_not_exceeded() {
    let scene = built(room());
    for budget in [1 << 14, 1 << 16, 1 << 19] {
        let settings = UnwrapSettings { density: Density::Budget(budget), page_size: 1024, ..settings() };
        let used = unwrapped(&scene, &settings).atlas.lumel_count() as f64 / f64::from(budget);
        assert!((0.85..=1.0).contains(&used), "{used} of {budget}");
    }
}

#[test]
fn a_budget_below_what_all_charts_need_gives_a_warning() {
    let scene = built(soup(2000));
    let out = unwrapped(&scene, &UnwrapSettings { density: Density::Budget(1000), ..settings() });
    let used = out.atlas.lumel_count();
    // Nearly all have the smallest boxes, four lumels; some are merged.
    assert!((2000 * 3..2000 * 6).contains(&used), "{used}");
    let finding = out.report.findings[0].to_string();
    assert!(finding.contains(" charts have ") && finding.contains("above the budget of 1000"), "{finding}");
}

#[test]
fn what_does_not_fit_on_one_page_has_several() {
    let scene = built(room());
    let settings = UnwrapSettings { density: Density::PerMetre(80.0), page_size: 256, ..settings() };
    let out = unwrapped(&scene, &settings);
    assert!(out.atlas.pages().len() > 8, "{:?}", out.atlas.pages());
    assert_eq!(check(&out.atlas, &scene), []);
    assert!(out.report.findings.is_empty(), "walls of many faces are cut: {:?}", out.report.findings);
    assert_eq!(out.atlas.density(), 80.0);
}

#[test]
fn a_triangle_longer_than_a_page_has_fewer_lumels_and_is_told_of() {
    let scene = built(lumel_testkit::scene::cube(1, [0; 6].map(|_| lumel_testkit::scene::grey(0.5, 0.0))));
    let settings = UnwrapSettings { density: Density::PerMetre(100.0), page_size: 64, ..settings() };
    let out = unwrapped(&scene, &settings);
    assert_eq!(check(&out.atlas, &scene), []);
    assert_eq!(out.report.findings.len(), 6);
    let message = &out.report.findings[0].message;
    assert!(message.starts_with("a triangle is longer than a page of 64 lumels and has"), "{message}");
    assert!(out.report.objects.iter().all(|object| object.density < 60.0));
}

#[test]
fn a_factor_makes_the_lumels_of_its_object_finer() {
    let mut builder = room();
    builder.objects[2].density_factor = Some(3.0);
    let scene = built(builder);
    for (factors, expected) in
        [(vec![1.0, 2.0], [10.0, 20.0, 30.0]), (vec![1.0, 2.0, 4.0], [10.0, 20.0, 40.0])]
    {
        let out =
            unwrapped(&scene, &UnwrapSettings { factors, density: Density::PerMetre(10.0), ..settings() });
        let densities: Vec<f32> = out.report.objects.iter().map(|object| object.density).collect();
        assert_eq!(densities[..3], expected);
        assert_eq!(check(&out.atlas, &scene), []);
    }
}

#[test]
fn blocks_of_four_lumels_belong_to_one_chart() {
    let scene = built(room());
    for gutter in [2, 3] {
        let settings = UnwrapSettings { align: 4, gutter, ..settings() };
        let out = unwrapped(&scene, &settings);
        assert_eq!(check(&out.atlas, &scene), []);
        let mut owners = std::collections::BTreeMap::new();
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            // Lumels that a bilinear reader reads are in the chart's own blocks, too.
            let reads = out.atlas.corners(tri).map(|c| [c - 0.5, c + 0.5]);
            let blocks = reads.as_flattened().iter().map(|c| (*c / 4.0).floor());
            let (min, max) = blocks.fold((Vec2::INFINITY, Vec2::ZERO), |(a, b), c| (a.min(c), b.max(c)));
            let place = out.atlas.chart(tri);
            // Walls are rectangles: they fill the bounds of their triangles.
            for y in min.y as u32..=max.y as u32 {
                for x in min.x as u32..=max.x as u32 {
                    assert_eq!(*owners.entry((out.atlas.page(tri), x, y)).or_insert(place), place);
                }
            }
        }
    }
}

#[test]
fn a_wide_gutter_is_kept() {
    let scene = built(soup(300));
    for gutter in [0, 1, 3, 8] {
        let out = unwrapped(&scene, &UnwrapSettings { gutter, ..settings() });
        assert_eq!(check(&out.atlas, &scene), [], "gutter {gutter}");
    }
}

#[test]
fn settings_outside_their_bounds_are_named() {
    let scene = built(room());
    let refused = |settings: UnwrapSettings| {
        let error = unwrap(&scene, &settings, &|| Pace::Go).err();
        error.map(|error| error.to_string()).unwrap_or_default()
    };
    let density = |density| refused(UnwrapSettings { density, ..settings() });
    assert_eq!(density(Density::PerMetre(0.0)), "the density is 0; it must be above 0");
    assert_eq!(density(Density::PerMetre(f32::NAN)), "the density is NaN; it must be above 0");
    assert_eq!(density(Density::Budget(0)), "the number of lumels is 0; it must be above 0");
    let fine = UnwrapSettings { density: Density::PerMetre(1e5), page_size: 16384, ..settings() };
    assert!(refused(fine).starts_with("the atlas would have "));
    assert_eq!(refused(UnwrapSettings { align: 3, ..settings() }), "the alignment is 3; it must be 1 or 4");
    let page = refused(UnwrapSettings { page_size: 1001, ..settings() });
    assert_eq!(page, "the page size is 1001; it must be a multiple of 4 from 64 to 16384");
    let factors = vec![1.0, -1.0];
    assert_eq!(
        refused(UnwrapSettings { factors, ..settings() }),
        "the density factor is -1; it must be above 0"
    );
}

#[test]
fn stop_stops() {
    let scene = built(soup(100));
    assert_eq!(unwrap(&scene, &settings(), &|| Pace::Stop).err(), Some(UvError::Stopped));
}
