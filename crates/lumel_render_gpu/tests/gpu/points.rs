//! Light at scattered points.

use crate::common::{
    Subject, Uploaded, differences, irradiance, keep, looks, radiance, renderer, share_beyond,
};
use crate::scenes;
use glam::Vec3;
use lumel_basis::{
    Basis, CloudLighting, CloudPoint, Field, MeshlessBasis, Obstacle, Obstacles, PointCloud, SurfaceSample,
};
use lumel_render_cpu::{Picture, ToneMapper};
use lumel_render_gpu::{Frame, Lit, Look, PointBuffer, Samples, Values};
use lumel_scene::{Barycentrics, SurfacePoint, TriId};
use std::sync::Arc;

const SIZE: [u32; 2] = [173, 120];

/// Of the pixels; the rest are those whose centre lies on an edge.
const EXCEPTIONS: f64 = 0.01;

/// Points of three levels on a subject's scene, and light that changes from point to point.
struct Points {
    cloud: PointCloud,
    values: Vec<Vec3>,
}

impl Points {
    fn new(subject: &Subject) -> Self {
        let scene = Arc::new(subject.scene.clone());
        let spacing = MeshlessBasis::spacing_for(&scene, 3000);
        let basis = MeshlessBasis::with_levels(scene, spacing, 3);
        let level =
            |i: usize, salt: u32| 0.2 + ((i as u32).wrapping_mul(2_654_435_761) >> salt) as f32 % 97.0 / 60.0;
        let value = |i: usize| Vec3::new(level(i, 3), level(i, 9), level(i, 15));
        let mut field = Field::from_values((0..basis.node_count()).map(value).collect());
        basis.hierarchy().unwrap().analyze(&mut field, None);
        Self { cloud: PointCloud::of(&basis), values: field.values().to_vec() }
    }

    fn lighting<'a>(&'a self, subject: &'a Subject, finest: u32) -> CloudLighting<'a> {
        let Self { cloud, values } = self;
        CloudLighting { scene: &subject.scene, cloud, values, finest, vertices: subject.lighting() }
    }

    fn on(&self, uploaded: &Uploaded<'_>) -> PointBuffer {
        let points = uploaded.renderer.points(&self.cloud).unwrap();
        uploaded.renderer.set_points(&points, &self.values);
        points
    }
}

/// A frame of points on all levels up to one.
fn frame<'a>(uploaded: &'a Uploaded<'_>, points: &'a PointBuffer, finest: u32, look: Look) -> Frame<'a> {
    let light = Lit::One(Values::Points { points, finest, vertices: &uploaded.light });
    Frame { light, ..uploaded.frame(look) }
}

fn assert_alike(device: &Picture, cpu: &Picture, what: &str) {
    let share = share_beyond(device, cpu, 2);
    println!("{what}: {:.3} % beyond 2/255", 100.0 * share);
    if share > EXCEPTIONS {
        keep("points device", device);
        keep("points cpu", cpu);
        panic!("{what}: {:.2} % of the pixels differ by more than 2/255", 100.0 * share);
    }
}

#[test]
fn light_of_points_looks_as_on_the_cpu() {
    let Some(renderer) = renderer() else { return };
    for subject in [scenes::cornell(), &scenes::everything()] {
        let points = Points::new(subject);
        let uploaded = subject.on(renderer);
        let buffer = points.on(&uploaded);
        for look in looks(-0.5, [0.2, 7.0]) {
            let device = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &buffer, u32::MAX, look));
            let cpu = subject.traced_under(&points.lighting(subject, u32::MAX), SIZE, look);
            assert_alike(&device, &cpu, &format!("{} {look:?}", subject.scene.name()));
        }
    }
}

/// A wall across the scene that nobody sees.
struct Wall(f32);

impl Obstacles for Wall {
    fn first(&self, from: &SurfaceSample, toward: Vec3, _: f32, reach: f32) -> Option<Obstacle> {
        let distance = (self.0 - from.position.x) / toward.x;
        (0.0..reach).contains(&distance).then_some(Obstacle { distance, normal: Vec3::X })
    }
}

#[test]
fn light_of_points_does_not_pass_walls() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let open = Points::new(subject);
    let surface =
        |_: &CloudPoint| Some(SurfacePoint { tri: TriId(0), bary: Barycentrics { u: 0.0, v: 0.0 } });
    let wall = Wall(subject.scene.bounds().center().x);
    let points = Points { cloud: open.cloud.clone().around_obstacles(&wall, surface), ..open };
    assert!(points.cloud.clearances().count() > 100);
    let (uploaded, look) = (subject.on(renderer), irradiance(-0.5));
    let draw = |points: &Points| {
        let buffer = points.on(&uploaded);
        uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &buffer, u32::MAX, look))
    };
    let device = draw(&points);
    let cpu = subject.traced_under(&points.lighting(subject, u32::MAX), SIZE, look);
    assert_alike(&device, &cpu, "a wall");
    assert!(share_beyond(&device, &draw(&Points::new(subject)), 2) > 0.02, "and it makes a difference");
}

#[test]
fn levels_beyond_the_finest_that_is_wanted_are_left_out() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let (points, uploaded, look) = (Points::new(subject), subject.on(renderer), irradiance(-0.5));
    let buffer = points.on(&uploaded);
    let mut before = None;
    for finest in 0..3 {
        let device = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &buffer, finest, look));
        let cpu = subject.traced_under(&points.lighting(subject, finest), SIZE, look);
        assert_alike(&device, &cpu, &format!("up to level {finest}"));
        let coarser = before.replace(device.clone());
        assert!(coarser.is_none_or(|coarser| share_beyond(&device, &coarser, 8) > 0.1), "level {finest}");
    }
}

#[test]
fn edges_between_samples_have_light_of_the_surfaces_that_meet_there() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let (points, uploaded) = (Points::new(subject), subject.on(renderer));
    let (buffer, look) = (points.on(&uploaded), radiance(-0.5, ToneMapper::default()));
    // Four times as many pixels, of which four make one.
    let [width, height] = SIZE;
    let fine =
        uploaded.draw([2 * width, 2 * height], Samples::Four, &frame(&uploaded, &buffer, u32::MAX, look));
    let mean = |x: u32, y: u32| {
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| fine.pixel(2 * x + i, 2 * y + j).unwrap());
        [0, 1, 2].map(|c| (four.iter().map(|pixel| u32::from(pixel[c])).sum::<u32>() / 4) as u8)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| mean(x, y))).collect();
    let fine = Picture::new(width, height, pixels).unwrap();
    let smooth = uploaded.draw(SIZE, Samples::Four, &frame(&uploaded, &buffer, u32::MAX, look));
    let worst = |picture: &Picture| share_beyond(picture, &fine, 24);
    let jagged = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &buffer, u32::MAX, look));
    println!("beyond 24/255: {} with four samples, {} with one", worst(&smooth), worst(&jagged));
    assert!(worst(&smooth) < 0.25 * worst(&jagged), "{} and {}", worst(&smooth), worst(&jagged));
}

#[test]
fn halves_of_a_picture_show_points_and_vertices() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let (points, uploaded, look) = (Points::new(subject), subject.on(renderer), irradiance(-0.5));
    let buffer = points.on(&uploaded);
    let draw = |light| uploaded.draw(SIZE, Samples::One, &Frame { light, ..uploaded.frame(look) });
    let left = Values::Points { points: &buffer, finest: u32::MAX, vertices: &uploaded.light };
    let right = Values::Vertices(&uploaded.light);
    let split = draw(Lit::Split { left, right, at: 0.5 });
    let [left, right] = [Lit::One(left), Lit::One(right)].map(draw);
    let middle = (0.5 * SIZE[0] as f32).round() as u32;
    for (picture, is_left) in [(&left, true), (&right, false)] {
        let differs = |i: usize| (i as u32 % SIZE[0] < middle) == is_left;
        let worst = differences(&split, picture).into_iter().enumerate().filter(|(i, _)| differs(*i));
        assert_eq!(worst.map(|(_, d)| d).max(), Some(0));
    }
    renderer.set_points(&buffer, &[Vec3::NAN; 7]);
    let dark =
        draw(Lit::One(Values::Points { points: &buffer, finest: u32::MAX, vertices: &uploaded.light }));
    assert_eq!(share_beyond(&dark, &right, 1), 0.0, "points without light add none");
}

#[test]
fn a_cloud_without_points_shows_the_vertices() {
    let Some(renderer) = renderer() else { return };
    let subject = scenes::cornell();
    let (uploaded, look) = (subject.on(renderer), irradiance(0.0));
    let none = renderer.points(&PointCloud::new(vec![])).unwrap();
    assert!(none.is_empty());
    let device = uploaded.draw(SIZE, Samples::One, &frame(&uploaded, &none, u32::MAX, look));
    assert_eq!(share_beyond(&device, &uploaded.show(SIZE, Samples::One, look), 1), 0.0);
}
