//! Charts, places and sizes.

use crate::meshes::{self, all, room};
use crate::{built, settings, unwrapped};
use glam::{DVec2, Quat, Vec3};
use lumel_scene::{FaceSide, Scene, SurfacePoint, TriId};
use lumel_testkit::scene::{placed, reordered};
use lumel_uv::{Atlas, Density, Fault, Method, Pace, UnwrapSettings, check, unwrap};

fn area(atlas: &Atlas, tri: TriId) -> f64 {
    let [a, b, c] = atlas.corners(tri).map(|corner| corner.as_dvec2());
    0.5 * (b - a).perp_dot(c - a)
}

/// Points of a triangle on its page, no further apart than half a lumel.
fn points_of(atlas: &Atlas, tri: TriId) -> Vec<DVec2> {
    let [a, b, c] = atlas.corners(tri).map(|corner| corner.as_dvec2());
    let n = (2.0 * [a.distance(b), b.distance(c), c.distance(a)].into_iter().fold(0.0, f64::max)) as u32 + 1;
    let weights = (0..=n).flat_map(|i| (0..=n - i).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(n))));
    weights.map(|[u, v]| a * u + b * v + c * (1.0 - u - v)).collect()
}

#[test]
fn nothing_is_mirrored_overlaps_or_comes_too_near_in_any_scene() {
    for (name, builder) in all() {
        let scene = built(builder);
        let out = unwrapped(&scene, &settings());
        assert_eq!(check(&out.atlas, &scene), [], "{name}");
        let mut findings = out.report.findings.iter();
        assert!(findings.all(|finding| finding.object.is_none()), "{name}: {:?}", out.report.findings);
        assert!(out.report.objects.iter().all(|object| object.method == Method::Conformal), "{name}");
    }
}

#[test]
fn lumels_that_are_read_for_one_chart_are_read_for_no_other_by_another_count() {
    for (name, builder) in all().into_iter().filter(|(name, _)| *name != "soup") {
        let scene = built(builder);
        for gutter in [2, 3] {
            let atlas = unwrapped(&scene, &UnwrapSettings { gutter, ..settings() }).atlas;
            let near = 0.5 * f64::from(gutter);
            let mut owners = std::collections::BTreeMap::new();
            for tri in (0..scene.triangle_count() as u32).map(TriId) {
                for point in points_of(&atlas, tri) {
                    // Those whose centres are nearer than half of the gutter, along both axes.
                    let first = (point - 0.5 - near).floor() + 1.0;
                    let last = (point - 0.5 + near).ceil() - 1.0;
                    for y in first.y as i64..=last.y as i64 {
                        for x in first.x as i64..=last.x as i64 {
                            let owner = owners.entry((x, y, atlas.page(tri))).or_insert(atlas.chart(tri));
                            assert_eq!(*owner, atlas.chart(tri), "{name}: lumel ({x}, {y})");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn triangles_have_the_lumels_that_the_density_asks_for() {
    for (name, builder) in all() {
        let scene = built(builder);
        let atlas = unwrapped(&scene, &settings()).atlas;
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            let density = f64::from(atlas.charts()[atlas.chart(tri)].density);
            assert!((density - f64::from(atlas.density())).abs() < 1e-3 * density, "{name}");
            let asked = f64::from(scene.area(tri)) * density * density;
            let stretch = area(&atlas, tri) / asked;
            // A sphere cannot be flat; coordinates on a page have 24 bits, so that slivers are not exact.
            let bounds = if name == "sphere" { 0.67..1.5 } else { 0.99..1.01 };
            assert!(asked < 1.0 || bounds.contains(&stretch), "{name}: {stretch} of {asked}");
        }
    }
}

#[test]
fn no_corner_is_nearer_to_the_border_of_its_page_than_a_reader_reaches() {
    for (name, builder) in all() {
        let scene = built(builder);
        let atlas = unwrapped(&scene, &settings()).atlas;
        assert!(atlas.pages().iter().flatten().all(|&side| side <= 512 && side % 4 == 0), "{name}");
        for tri in (0..scene.triangle_count() as u32).map(TriId) {
            let [width, height] = atlas.pages()[atlas.page(tri)].map(f64::from);
            let inside = |c: DVec2| (0.5..=width - 0.5).contains(&c.x) && (0.5..=height - 0.5).contains(&c.y);
            assert!(atlas.corners(tri).iter().all(|c| inside(c.as_dvec2())), "{name}");
            assert!(
                atlas.texture_coordinates(tri).iter().all(|c| c.min_element() > 0.0 && c.max_element() < 1.0)
            );
        }
    }
}

#[test]
fn a_cube_has_six_charts_and_a_finely_divided_room_one_for_each_wall() {
    let count = |builder| unwrapped(&built(builder), &settings()).report.chart_count();
    assert_eq!(count(all().remove(0).1), 6);
    assert_eq!(count(room()), 12);
}

#[test]
fn corners_that_continue_each_other_lie_together_in_a_chart() {
    // Neighbours of a wall share a vertex of the scene, and its place.
    let scene = built(room());
    let atlas = unwrapped(&scene, &settings()).atlas;
    let mut places = std::collections::BTreeMap::new();
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        for (vertex, corner) in scene.triangle(tri).into_iter().zip(atlas.corners(tri)) {
            let place = *places.entry((vertex, atlas.chart(tri))).or_insert(corner);
            assert_eq!(place, corner, "vertex {vertex}");
        }
    }
    assert_eq!(places.len(), scene.vertex_count());
}

#[test]
fn the_two_sides_of_a_sheet_lie_apart_and_are_mirror_images() {
    let scene = built(meshes::sheet());
    let atlas = unwrapped(&scene, &settings()).atlas;
    assert_eq!(atlas.charts().len(), 2);
    for tri in (0..scene.traced_count() as u32).map(TriId) {
        let at = SurfacePoint { tri, ..SurfacePoint::default() };
        let back = scene.seen_side(at, FaceSide::Back).unwrap().tri;
        assert_ne!(atlas.chart(tri), atlas.chart(back));
        assert!((area(&atlas, tri) / area(&atlas, back) - 1.0).abs() < 1e-3);
    }
}

fn chart_areas(scene: &Scene) -> Vec<f64> {
    let settings = UnwrapSettings { density: Density::PerMetre(20.0), ..settings() };
    let atlas = unwrapped(scene, &settings).atlas;
    let mut areas = vec![0.0; atlas.charts().len()];
    for tri in (0..scene.triangle_count() as u32).map(TriId) {
        areas[atlas.chart(tri)] += area(&atlas, tri);
    }
    areas.sort_by(f64::total_cmp);
    areas
}

#[test]
fn a_scene_far_away_turned_or_in_another_order_has_the_same_charts() {
    let expected = chart_areas(&built(room()));
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    for builder in [
        reordered(room()),
        placed(room(), turn, Vec3::ZERO),
        placed(room(), Quat::IDENTITY, Vec3::new(1e3, -300.0, 2e3)),
    ] {
        let found = chart_areas(&built(builder));
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(&expected) {
            assert!((a / b - 1.0).abs() < 2e-3, "{a} {b}");
        }
    }
}

#[test]
fn a_scene_in_other_units_has_the_same_atlas_at_the_same_budget() {
    let scale = |factor: f32| {
        let mut builder = room();
        builder.objects.iter_mut().flat_map(|o| &mut o.positions).for_each(|p| *p *= factor);
        unwrapped(&built(builder), &settings())
    };
    let (metres, others) = (scale(1.0), scale(1024.0));
    assert_eq!(metres.atlas.pages(), others.atlas.pages());
    assert!((metres.atlas.density() / others.atlas.density() - 1024.0).abs() < 1e-2);
    for tri in (0..metres.atlas.triangle_count() as u32).map(TriId) {
        for (a, b) in metres.atlas.corners(tri).iter().zip(others.atlas.corners(tri)) {
            assert!(a.distance(b) < 1e-2, "{a} {b}");
        }
    }
}

#[test]
fn any_number_of_threads_makes_the_same_bits() {
    for (name, builder) in all() {
        let scene = built(builder);
        let identity = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| unwrapped(&scene, &settings()).atlas.identity())
        };
        assert_eq!(identity(1), identity(3), "{name}");
    }
}

#[test]
fn the_identity_knows_where_lumels_are() {
    let scene = built(room());
    let identity = |settings: &UnwrapSettings| unwrapped(&scene, settings).atlas.identity();
    let usual = settings();
    assert_eq!(identity(&usual), identity(&usual.clone()));
    assert_ne!(identity(&usual), identity(&UnwrapSettings { gutter: 3, ..usual.clone() }));
    assert_ne!(identity(&usual), identity(&UnwrapSettings { density: Density::Budget(1 << 15), ..usual }));
}

#[test]
fn when_time_is_up_simple_charts_are_without_fault_too_and_are_told_of() {
    let scene = built(all().remove(1).1);
    let out = unwrap(&scene, &settings(), &|| Pace::Hurry).unwrap();
    assert_eq!(check(&out.atlas, &scene), []);
    assert_eq!(out.report.objects[0].method, Method::Planar);
    let finding = out.report.findings[0].to_string();
    assert_eq!(finding, "object \"sphere\": it has planar charts: time was up");
    assert!(out.report.stretch[0] > 0.9 && out.report.stretch[2] < 1.12, "{:?}", out.report.stretch);
}

#[test]
fn an_atlas_of_another_scene_is_a_fault() {
    let (room, sheet) = (built(room()), built(meshes::sheet()));
    let atlas = unwrapped(&sheet, &settings()).atlas;
    assert_eq!(check(&atlas, &room), [Fault::OtherScene]);
}
