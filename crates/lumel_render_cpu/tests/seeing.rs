//! What is seen where.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod support;

use glam::{Vec2, Vec3};
use lumel_accel::{BruteForce, Bvh};
use lumel_basis::{IncidentRadiance, Lighting, Shading, VertexLighting, spherical_harmonics};
use lumel_render_cpu::*;
use lumel_scene::{
    Camera, Encoding, Irradiance, Light, Material, NormalMap, Radiance, Scene, SceneBuilder, Sides,
    SurfacePoint, Texture, TextureId, TextureRef, TriId, UvTransform,
};
use std::sync::atomic::AtomicBool;
use support::*;

const DARK: &dyn Lighting = &(|_: SurfacePoint, _: Vec3| Irradiance::ZERO);

/// Irradiance that makes a white surface's radiance 1.
fn bright(_: SurfacePoint, _: Vec3) -> Irradiance {
    Radiance::splat(1.0).cosine_sample()
}

fn colored(albedo: Vec3) -> Material {
    Material::diffuse("colour", albedo)
}

#[test]
fn a_known_point_is_drawn_at_its_pixel() {
    // 90° high, 5 m away, 100 pixels: 0.1 m each. The square covers x 2..2.1 and y 1..1.1 (right of the middle, up).
    let corners = [[2.0, 1.0], [2.1, 1.0], [2.1, 1.1], [2.0, 1.1]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let scene = built(scene(vec![quad(corners, 0)], vec![grey(0.5)]));
    let picture = picture(&scene, DARK, 100, &Display::of(Show::Albedo));
    let lit: Vec<usize> = (0..10_000).filter(|&i| picture.pixels()[i] != [0; 3]).collect();
    assert_eq!(lit, [39 * 100 + 70]);
    assert_eq!(picture.pixel(70, 39), Some([188; 3]));
}

#[test]
fn the_field_of_view_is_vertical() {
    let scene = built(scene(vec![square(0.0, 2.5, 0)], vec![grey(0.5)]));
    let tracer = BruteForce::new(&scene);
    let view = View::new(&scene, &tracer, DARK);
    for (width, height) in [(40, 40), (80, 40), (20, 40)] {
        let resolution = Resolution::new(width, height);
        let display = Display::of(Show::Albedo);
        let picture = draw(&view, &camera(), &resolution, &display, &AtomicBool::new(false)).unwrap();
        // 5 m of 10 m: rows 10 to 30, and as many columns.
        let rows = (0..height).filter(|&y| picture.pixel(width / 2, y) != Some([0; 3])).count();
        let columns = (0..width).filter(|&x| picture.pixel(x, height / 2) != Some([0; 3])).count();
        assert_eq!((rows, columns), (20, 20.min(width as usize)), "{width} x {height}");
    }
}

#[test]
fn albedo_shows_both_colours_of_two_materials() {
    let (mut left, mut right) = (square(0.0, 9.0, 0), square(0.0, 9.0, 1));
    left.positions.iter_mut().for_each(|p| p.x = p.x.min(0.0));
    right.positions.iter_mut().for_each(|p| p.x = p.x.max(0.0));
    let materials = vec![colored(Vec3::new(0.5, 0.18, 0.0)), colored(Vec3::new(0.0, 0.18, 0.5))];
    let scene = built(scene(vec![left, right], materials));
    let picture = picture(&scene, DARK, 10, &Display::of(Show::Albedo));
    assert_eq!(picture.pixel(2, 5), Some([188, 118, 0]));
    assert_eq!(picture.pixel(7, 5), Some([0, 118, 188]));
}

#[test]
fn irradiance_is_linear_over_a_big_triangle() {
    // Red, green and blue light at one corner each: a pixel's channels are its barycentric weights.
    let mut mesh = square(0.0, 4.0, 0);
    mesh.faces.truncate(1);
    let scene = built(scene(vec![mesh], vec![grey(0.5)]));
    let [a, b, c] = scene.triangle_positions(TriId(0));
    let mut light = vec![Vec3::ZERO; scene.vertex_count()];
    for (vertex, color) in scene.triangle(TriId(0)).into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        light[vertex as usize] = Radiance(color).cosine_sample().0;
    }
    let lighting = VertexLighting::new(&scene, &light).unwrap();
    let tracer = BruteForce::new(&scene);
    let display = Display { show: Show::Irradiance, ..plain() };
    let resolution = Resolution { samples_per_pixel: 1, ..Resolution::new(50, 50) };
    let view = View::new(&scene, &tracer, &lighting);
    let picture = draw(&view, &camera(), &resolution, &display, &AtomicBool::new(false)).unwrap();
    // Weights that differ from each other, so that none can be swapped.
    for weights in [[0.55, 0.3, 0.15], [0.1, 0.25, 0.65], [0.2, 0.7, 0.1]] {
        let p = a * weights[0] + b * weights[1] + c * weights[2];
        let (x, y) = ((p.x + 5.0) / 0.2, (5.0 - p.y) / 0.2);
        // The weights at the pixel's centre, from areas.
        let center = Vec3::new((x.floor() + 0.5) * 0.2 - 5.0, 5.0 - (y.floor() + 0.5) * 0.2, 0.0);
        let area = |p: Vec3, q: Vec3, r: Vec3| (q - p).cross(r - p).z / (b - a).cross(c - a).z;
        let exact = [area(center, b, c), area(a, center, c), area(a, b, center)];
        let pixel = picture.pixel(x as u32, y as u32).unwrap();
        for (byte, weight) in pixel.into_iter().zip(exact) {
            assert!(byte.abs_diff(srgb_byte(weight)) <= 1, "{pixel:?} {exact:?}");
        }
    }
}

#[test]
fn light_that_changes_within_a_triangle_is_drawn_at_every_pixel() {
    // Rings around the middle of two triangles whose corners all have the same light.
    let rings = |p: Vec3| 0.5 + 0.5 * (3.0 * p.x.hypot(p.y)).sin();
    let scene = built(scene(vec![square(0.0, 4.0, 0)], vec![grey(0.5)]));
    let lighting = |at: SurfacePoint, _: Vec3| Radiance::splat(rings(scene.position(at))).cosine_sample();
    let tracer = BruteForce::new(&scene);
    let view = View::new(&scene, &tracer, &lighting);
    let resolution = Resolution { samples_per_pixel: 1, ..Resolution::new(50, 50) };
    let center = |pixel: u32| (pixel as f32 + 0.5) * 0.2 - 5.0;
    for (show, albedo) in [(Show::Irradiance, 1.0), (Show::Radiance, 0.5)] {
        let display = Display { show, ..plain() };
        let picture = draw(&view, &camera(), &resolution, &display, &AtomicBool::new(false)).unwrap();
        for (x, y) in (5..45).flat_map(|y| (5..45).map(move |x| (x, y))) {
            let expected = srgb_byte(albedo * rings(Vec3::new(center(x), -center(y), 0.0)));
            let pixel = picture.pixel(x, y).unwrap()[0];
            assert!(pixel.abs_diff(expected) <= 1, "{show} {x} {y}: {pixel} instead of {expected}");
        }
    }
}

#[test]
fn radiance_is_emission_and_reflection() {
    let mut material = colored(Vec3::new(0.5, 0.18, 0.0));
    material.emission = Radiance(Vec3::new(0.0, 0.0, 0.5));
    let scene = built(scene(vec![square(0.0, 9.0, 0)], vec![material]));
    assert_eq!(picture(&scene, &bright, 3, &plain()).pixel(1, 1), Some([188, 118, 188]));
    assert_eq!(picture(&scene, DARK, 3, &plain()).pixel(1, 1), Some([0, 0, 188]));
}

#[test]
fn textures_are_seen_upright() {
    // White in the image's top right corner only.
    let texels = vec![[0, 0, 0, 255], [255; 4], [0, 0, 0, 255], [0, 0, 0, 255]];
    let mut texture = Texture::from_bytes("corner", 2, 2, texels, Encoding::Srgb).unwrap();
    (texture.wrap_u, texture.wrap_v) = (lumel_scene::Wrap::Clamp, lumel_scene::Wrap::Clamp);
    let mut material = grey(0.5);
    material.albedo_texture = Some(TextureRef::plain(TextureId(0)));
    let builder = scene(vec![square(0.0, 5.0, 0)], vec![material]);
    let scene = built(SceneBuilder { textures: vec![texture], ..builder });
    let picture = picture(&scene, DARK, 8, &Display::of(Show::Albedo));
    let corners = [(0, 0), (7, 0), (0, 7), (7, 7)].map(|(x, y)| picture.pixel(x, y).unwrap()[0]);
    assert_eq!(corners, [0, 188, 0, 0]);
}

#[test]
fn both_sides_of_a_two_sided_square_show_their_own_light() {
    let mut material = grey(0.5);
    material.sides = Sides::Both;
    for mesh in [square(0.0, 9.0, 0), square_from_behind(0.0, 9.0, 0)] {
        let scene = built(scene(vec![mesh], vec![material.clone()]));
        // Light on the side whose normal is +z, the one the camera sees.
        let lit = |n: &Vec3| if n.z > 0.0 { Radiance::splat(1.0).cosine_sample().0 } else { Vec3::ZERO };
        let light: Vec<Vec3> = scene.normals().iter().map(lit).collect();
        let light = VertexLighting::new(&scene, &light).unwrap();
        assert_eq!(picture(&scene, &light, 3, &plain()).pixel(1, 1), Some([188; 3]));
    }
}

fn seen_through(objects: Vec<lumel_scene::ObjectMesh>, backfaces: Backfaces) -> [u8; 3] {
    let materials = vec![colored(Vec3::new(0.5, 0.0, 0.0)), colored(Vec3::new(0.0, 0.5, 0.0))];
    // It may warn of faces in one place.
    let scene = scene(objects, materials).build().unwrap().0;
    let tracer = Bvh::build(&scene);
    let view = View { backfaces, ..View::new(&scene, &tracer, &bright) };
    shoot(&view, &camera(), 3, &plain()).unwrap().pixel(1, 1).unwrap()
}

#[test]
fn backs_of_one_sided_faces_are_looked_through_or_black() {
    let behind = || vec![square_from_behind(1.0, 9.0, 1), square(0.0, 9.0, 0)];
    assert_eq!(seen_through(behind(), Backfaces::Through), [188, 0, 0]);
    assert_eq!(seen_through(behind(), Backfaces::Black), [0, 0, 0]);
    // Many layers, and no end to them.
    let mut layers: Vec<_> = (1..=100).map(|i| square_from_behind(i as f32 * 0.04, 9.0, 1)).collect();
    layers.push(square(0.0, 9.0, 0));
    assert_eq!(seen_through(layers, Backfaces::Through), [188, 0, 0]);
}

#[test]
fn walls_of_two_faces_in_one_place_hide_what_is_behind() {
    for backfaces in [Backfaces::Through, Backfaces::Black] {
        let wall = [square(1.0, 9.0, 0), square_from_behind(1.0, 9.0, 1)];
        // Either may come first, and so be what a ray meets.
        for order in [[0, 1], [1, 0]] {
            let mut objects = order.map(|i| wall[i].clone()).to_vec();
            objects.push(square(0.0, 9.0, 1));
            assert_eq!(seen_through(objects, backfaces), [188, 0, 0], "{order:?} {backfaces}");
        }
    }
}

/// A rectangle light above the middle of a dark floor, seen by a camera above or below it.
fn light_pixel(lights: Vec<Light>, textures: Vec<Texture>, eye: Vec3, up: Vec3) -> Picture {
    let floor = [[-9.0, 9.0], [9.0, 9.0], [9.0, -9.0], [-9.0, -9.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    let builder = scene(vec![quad(floor, 0)], vec![grey(0.5)]);
    let scene = built(SceneBuilder { lights, textures, sky: Radiance::ZERO.into(), ..builder });
    let tracer = BruteForce::new(&scene);
    let camera = Camera { up, ..Camera::looking_at("c", eye, Vec3::new(0.0, 2.0, 0.0), 60_f32.to_radians()) };
    shoot(&View::new(&scene, &tracer, DARK), &camera, 9, &plain()).unwrap()
}

#[test]
fn rect_lights_are_seen_from_their_front_only_and_not_through_walls() {
    let at = |height| rect_light(Vec3::new(0.0, height, 0.0), Vec3::X, Vec3::Z);
    let middle = |lights, eye| light_pixel(lights, vec![], eye, Vec3::Z).pixel(4, 4).unwrap();
    let (below, above) = (Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 4.0, 0.0));
    assert_eq!(middle(vec![at(2.0)], below), [255; 3]);
    assert_eq!(middle(vec![at(2.0)], above), [0; 3]);
    // Through the floor's back one looks, but not through its front.
    assert_eq!(middle(vec![at(2.0)], Vec3::new(0.0, -1.0, 0.0)), [255; 3]);
    assert_eq!(middle(vec![rect_light(Vec3::new(0.0, -1.0, 0.0), Vec3::Z, Vec3::X)], above), [0; 3]);
    // In the plane of the floor it is seen.
    assert_eq!(middle(vec![rect_light(Vec3::ZERO, Vec3::Z, Vec3::X)], above), [255; 3]);
    // Of two, the nearer one.
    let Light::Rect(mut dim) = at(1.5) else { unreachable!() };
    dim.radiance = Radiance::splat(0.5);
    for lights in [vec![at(2.0), Light::Rect(dim)], vec![Light::Rect(dim), at(2.0)]] {
        assert_eq!(middle(lights, below), [188; 3]);
    }
}

#[test]
fn rect_lights_have_their_size_and_their_texture() {
    // Seen from below with +z up in the picture, +x is on the right: the image is upright.
    let light = Light::Rect(lumel_scene::RectLight {
        center: Vec3::new(0.0, 2.0, 0.0),
        u: 0.5 * Vec3::X,
        v: 0.25 * Vec3::Z,
        radiance: Radiance::splat(1.0),
        texture: Some(TextureId(0)),
    });
    // Image: left column red, right column green; top row bright.
    let texels = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]];
    let mut texture = Texture::from_floats("colours", 2, 2, texels).unwrap();
    (texture.wrap_u, texture.wrap_v) = (lumel_scene::Wrap::Clamp, lumel_scene::Wrap::Clamp);
    // One metre ahead the picture is 2 tan 30° = 1.155 m high, 0.128 m per pixel.
    let picture = light_pixel(vec![light], vec![texture], Vec3::new(0.0, 1.0, 0.0), Vec3::Z);
    let lit = |x, y| picture.pixel(x, y).unwrap() != [0; 3];
    assert_eq!((0..9).filter(|&x| lit(x, 4)).count(), 9 - 2 * ((0.577_f32 - 0.5) / 0.1283) as usize);
    assert_eq!((0..9).filter(|&y| lit(4, y)).count(), 5);
    let (red, green) = (picture.pixel(1, 3).unwrap(), picture.pixel(7, 3).unwrap());
    assert!(red[0] > 200 && red[1] == 0 && green[1] > 200 && green[0] == 0, "{red:?} {green:?}");
    let (bright, dim) = (picture.pixel(1, 3).unwrap()[0], picture.pixel(1, 5).unwrap()[0]);
    assert!(bright > 200 && dim < 120, "{bright} {dim}");
}

#[test]
fn the_sky_is_the_background_of_radiance_only() {
    let mut builder = scene(vec![square(0.0, 1.0, 0)], vec![grey(0.5)]);
    builder.sky = Radiance(Vec3::new(0.18, 0.5, 1.0)).into();
    let scene = built(builder);
    for &show in Show::ALL {
        let corner = picture(&scene, DARK, 9, &Display { show, ..plain() }).pixel(0, 0);
        assert_eq!(corner, Some(if show == Show::Radiance { [118, 188, 255] } else { [0; 3] }), "{show}");
    }
}

fn normal_pixel(scene: &Scene) -> [u8; 3] {
    picture(scene, DARK, 3, &Display::of(Show::Normals)).pixel(1, 1).unwrap()
}

#[test]
fn normals_are_colours() {
    assert_eq!(normal_pixel(&built(scene(vec![square(0.0, 9.0, 0)], vec![grey(0.5)]))), [128, 128, 255]);
    // A square turned by 45° about y looks at +x and +z.
    let mut turned = square(0.0, 9.0, 0);
    turned.positions.iter_mut().for_each(|p| p.z = -p.x);
    assert_eq!(normal_pixel(&built(scene(vec![turned], vec![grey(0.5)]))), [218, 128, 218]);
}

/// The pixel of a square with a normal map of a single texel.
fn mapped(texel: [f32; 3], rotation: f32, back: bool) -> [u8; 3] {
    let mut material = grey(0.5);
    material.sides = Sides::Both;
    let transform = UvTransform { rotation, offset: Vec2::ZERO, scale: Vec2::ONE };
    material.normal_texture = Some(NormalMap::new(TextureRef { texture: TextureId(0), transform }));
    let mesh = if back { square_from_behind(0.0, 9.0, 0) } else { square(0.0, 9.0, 0) };
    let texture = Texture::from_floats("normals", 1, 1, vec![texel]).unwrap();
    normal_pixel(&built(SceneBuilder { textures: vec![texture], ..scene(vec![mesh], vec![material]) }))
}

#[test]
fn normal_maps_turn_normals_in_the_frame_of_their_texture() {
    // (5/13, 0, 12/13) as texels, and the bytes of 5/13, -5/13 and 12/13.
    let (flat, right, top) =
        ([0.5, 0.5, 1.0], [9.0 / 13.0, 0.5, 12.5 / 13.0], [0.5, 9.0 / 13.0, 12.5 / 13.0]);
    let (more, less, up) = (177, 78, 245);
    assert_eq!(mapped(flat, 0.0, false), [128, 128, 255]);
    // Red leans to the image's right, +x here, green to its top, +y.
    assert_eq!(mapped(right, 0.0, false), [more, 128, up]);
    assert_eq!(mapped(top, 0.0, false), [128, more, up]);
    // Turned by 90° the coordinates are u' = v: the image's right is where v grows, downwards.
    assert_eq!(mapped(right, 90_f32.to_radians(), false), [128, less, up]);
    // From behind: the front's image has its right at -x, and all of the front's normal is reversed.
    assert_eq!(mapped(flat, 0.0, true), [128, 128, 255]);
    assert_eq!(mapped(right, 0.0, true), [more, 128, up]);
    assert_eq!(mapped(top, 0.0, true), [128, less, up]);
}

#[test]
fn light_is_read_with_the_normal_that_is_shown() {
    let mut material = grey(0.5);
    material.normal_texture = Some(NormalMap::new(TextureRef::plain(TextureId(0))));
    let texture = Texture::from_floats("normals", 1, 1, vec![[9.0 / 13.0, 0.5, 12.5 / 13.0]]).unwrap();
    let builder = scene(vec![square(0.0, 9.0, 0)], vec![material]);
    let scene = built(SceneBuilder { textures: vec![texture], ..builder });
    // As much as the normal is turned to +x.
    let lighting = |_: SurfacePoint, normal: Vec3| Radiance::splat(normal.x).cosine_sample();
    let display = Display { show: Show::Irradiance, ..plain() };
    assert_eq!(picture(&scene, &lighting, 3, &display).pixel(1, 1), Some([srgb_byte(5.0 / 13.0); 3]));
}

#[test]
fn normal_maps_without_texture_coordinates_are_left_out() {
    let mut material = grey(0.5);
    material.normal_texture = Some(NormalMap::new(TextureRef::plain(TextureId(0))));
    let mut mesh = square(0.0, 9.0, 0);
    mesh.uvs.clear();
    let texture = Texture::from_floats("normals", 1, 1, vec![[1.0, 0.5, 0.5]]).unwrap();
    let builder = SceneBuilder { textures: vec![texture], ..scene(vec![mesh], vec![material]) };
    let (scene, warnings) = builder.build().unwrap();
    assert_eq!((normal_pixel(&scene), warnings.len()), ([128, 128, 255], 1));
}

/// Light from one direction, whose irradiance is 1 on a surface that faces it.
struct Sun(Vec3);

impl Lighting for Sun {
    fn irradiance(&self, _: SurfacePoint, normal: Vec3) -> Irradiance {
        Irradiance::splat(self.0.dot(normal).max(0.0))
    }

    fn incident(&self, _: SurfacePoint) -> Option<IncidentRadiance> {
        IncidentRadiance::new(&spherical_harmonics(self.0).map(Vec3::splat))
    }
}

/// What is shown of half the irradiance on a square with a normal map of one texel.
fn relief(texel: [u8; 3], relief: Relief, lighting: &dyn Lighting) -> u8 {
    let mut material = grey(0.5);
    material.normal_texture = Some(NormalMap::new(TextureRef::plain(TextureId(0))));
    let [r, g, b] = texel;
    let texture = Texture::from_bytes("normals", 1, 1, vec![[r, g, b, 255]], Encoding::Linear).unwrap();
    let builder = scene(vec![square(0.0, 9.0, 0)], vec![material]);
    let scene = built(SceneBuilder { textures: vec![texture], ..builder });
    let tracer = BruteForce::new(&scene);
    let view = View { relief, ..View::new(&scene, &tracer, lighting) };
    // White surfaces of irradiance 1 have a radiance of 1/2.
    let stops = Exposure::Stops(Radiance::splat(0.5).cosine_sample().0.x.log2());
    let display = Display { exposure: stops, show: Show::Irradiance, ..plain() };
    shoot(&view, &camera(), 3, &display).unwrap().pixel(1, 1).unwrap()[0]
}

#[test]
fn bumps_are_lit_from_the_side_of_the_light() {
    let sun = Sun(Vec3::new(0.6, 0.0, 0.8));
    let [flat, right, left, up] = [[128, 128, 255], [177, 128, 245], [78, 128, 245], [128, 177, 245]];
    let show = |texel, shading| relief(texel, Relief { shading, ..Relief::default() }, &sun);
    let scalar = srgb_byte(0.4);
    for shading in Shading::ALL {
        assert!(show(flat, shading).abs_diff(scalar) <= 1, "{shading}");
        assert!(show(right, shading) > scalar + 8 && show(left, shading) < scalar - 8, "{shading}");
        assert!(show(up, shading) < scalar && show(up, shading) > show(left, shading), "{shading}");
    }
    // The whole range of normals gets more or less what it should.
    let truth = srgb_byte(0.5 * Vec3::new(5.0, 0.0, 12.0).normalize().dot(sun.0));
    assert!(show(right, Shading::NonLinear).abs_diff(truth) < 12, "{truth}");
    let off = Relief { maps: NormalMaps::Off, ..Relief::default() };
    assert_eq!(relief(right, off, &sun), scalar);
    // Where directions are not known, the map changes nothing.
    let even = |_: SurfacePoint, _: Vec3| Irradiance::splat(0.8);
    assert_eq!(relief(right, Relief::default(), &even), scalar);
}

#[test]
fn green_points_up_or_down_as_asked() {
    let sun = Sun(Vec3::new(0.0, 0.6, 0.8));
    let show = |maps| relief([128, 177, 245], Relief { maps, ..Relief::default() }, &sun);
    let [off, up, down] = [NormalMaps::Off, NormalMaps::Up, NormalMaps::Down].map(show);
    assert!(up > off + 8 && down < off - 8, "{up} {off} {down}");
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let scene = lumel_builtin::scene("cornell-box", 0).unwrap().build().unwrap().0;
    let tracer = Bvh::build(&scene);
    let lighting = |at: SurfacePoint, _: Vec3| Irradiance(scene.position(at));
    let view = View::new(&scene, &tracer, &lighting);
    for &show in Show::ALL {
        let with = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| shoot(&view, &scene.cameras()[0], 50, &Display::of(show)).unwrap())
        };
        assert_eq!(with(1), with(3), "{show}");
    }
}

#[test]
fn cancelled_and_impossible_pictures_are_errors() {
    let scene = built(scene(vec![square(0.0, 9.0, 0)], vec![grey(0.5)]));
    let tracer = BruteForce::new(&scene);
    let view = View::new(&scene, &tracer, DARK);
    let try_draw = |camera: &Camera, resolution: Resolution, cancel: bool| {
        draw(&view, camera, &resolution, &plain(), &AtomicBool::new(cancel)).map(|_| ())
    };
    let small = Resolution::new(4, 4);
    assert_eq!(try_draw(&camera(), small, false), Ok(()));
    assert_eq!(try_draw(&camera(), small, true), Err(PictureError::Cancelled));
    let huge = Resolution::new(u32::MAX, u32::MAX);
    assert!(matches!(try_draw(&camera(), huge, false), Err(PictureError::Size { .. })));
    let nowhere = Camera { forward: Vec3::ZERO, ..camera() };
    assert!(matches!(try_draw(&nowhere, small, false), Err(PictureError::Camera { .. })));
}
