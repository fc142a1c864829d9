//! The Cornell box with the measurements of Cornell University's Program of Computer Graphics.
//!
//! Positions are those published in millimetres, here in metres. Albedos and light are the published spectra,
//! integrated with the CIE 1931 observer and turned into linear Rec. 709 under D65; triples found elsewhere differ.

use crate::shapes::{add_quad, object};
use glam::Vec3;
use lumel_scene::{Camera, Light, Material, MaterialId, ObjectMesh, Radiance, RectLight, SceneBuilder};

const WHITE: Vec3 = Vec3::new(0.738_259, 0.735_978, 0.738_681);
const RED: Vec3 = Vec3::new(0.493_887, 0.048_868, 0.051_164);
const GREEN: Vec3 = Vec3::new(0.068_418, 0.398_456, 0.086_567);

/// Luminance of the measured lamp, W·m⁻²·sr⁻¹, in every channel: the picture is balanced to the light's white.
const LIGHT: f32 = 12.37;

/// Cells along an edge of the room: 14 mm each.
const ROOM_CELLS: u32 = 40;
/// Cells along the sides of a block's top, and along the height of the short one.
const BLOCK_CELLS: u32 = 12;

const MATERIALS: [(&str, Vec3); 3] = [("white", WHITE), ("red", RED), ("green", GREEN)];
const WHITE_ID: MaterialId = MaterialId(0);
const RED_ID: MaterialId = MaterialId(1);
const GREEN_ID: MaterialId = MaterialId(2);

/// The name of the wall across from the camera.
pub(crate) const BACK_WALL: &str = "back wall";

/// Walls: name, material and corners (mm), counter-clockwise seen from inside.
const WALLS: [(&str, MaterialId, [[f32; 3]; 4]); 5] = [
    ("floor", WHITE_ID, [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]]),
    (
        "ceiling",
        WHITE_ID,
        [[556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0], [556.0, 548.8, 0.0]],
    ),
    (
        BACK_WALL,
        WHITE_ID,
        [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]],
    ),
    ("right wall", GREEN_ID, [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]]),
    (
        "left wall",
        RED_ID,
        [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]],
    ),
];

/// Blocks: name, height and (x, z) of the corners of the top (mm), cells along the height.
const BLOCKS: [(&str, f32, [[f32; 2]; 4], u32); 2] = [
    ("short block", 165.0, [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]], BLOCK_CELLS),
    ("tall block", 330.0, [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]], 2 * BLOCK_CELLS),
];

/// The box: five walls, open in front, two blocks without undersides (they stand on the floor), one light.
///
/// The camera looks along +z, and so has +x on its left: the red wall.
pub(crate) fn cornell_box(subdivide: u32) -> SceneBuilder {
    let fine = 1 << subdivide;
    let mut objects = Vec::new();
    for (name, material, corners) in WALLS {
        let mut wall = object(name);
        add_quad(&mut wall, material, corners.map(metres), [ROOM_CELLS * fine; 2]);
        objects.push(wall);
    }
    for (name, height, top, storeys) in BLOCKS {
        objects.push(block(name, height, top, [BLOCK_CELLS * fine, storeys * fine]));
    }
    SceneBuilder {
        name: "cornell-box".to_owned(),
        objects,
        materials: MATERIALS.iter().map(|(name, albedo)| Material::diffuse(name, *albedo)).collect(),
        lights: vec![Light::Rect(ceiling_light())],
        light_names: vec!["ceiling".to_owned()],
        cameras: vec![front_camera()],
        ..SceneBuilder::default()
    }
}

fn block(name: &str, height: f32, top: [[f32; 2]; 4], cells: [u32; 2]) -> ObjectMesh {
    let mut mesh = object(name);
    let at = |k: usize, y: f32| metres([top[k % 4][0], y, top[k % 4][1]]);
    add_quad(&mut mesh, WHITE_ID, [0, 1, 2, 3].map(|k| at(k, height)), [cells[0]; 2]);
    for k in 0..4 {
        let side = [at(k, 0.0), at(k + 1, 0.0), at(k + 1, height), at(k, height)];
        add_quad(&mut mesh, WHITE_ID, side, cells);
    }
    mesh
}

/// The measured opening of the lamp, 130 mm × 105 mm, half a millimetre below the ceiling it would coincide with.
fn ceiling_light() -> RectLight {
    RectLight {
        center: metres([278.0, 548.3, 279.5]),
        u: metres([65.0, 0.0, 0.0]),
        v: metres([0.0, 0.0, 52.5]),
        radiance: Radiance::splat(LIGHT),
        texture: None,
    }
}

/// The measured camera: focal length 35 mm, film 25 mm square.
fn front_camera() -> Camera {
    let position = metres([278.0, 273.0, -800.0]);
    Camera::looking_at("front", position, position + Vec3::Z, 2.0 * (0.0125_f32 / 0.035).atan())
}

fn metres(mm: [f32; 3]) -> Vec3 {
    Vec3::from(mm) / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::{Scene, TriId};

    fn built() -> Scene {
        cornell_box(0).build().unwrap().0
    }

    fn triangles_of<'a>(scene: &'a Scene, object: &str) -> impl Iterator<Item = TriId> + 'a {
        let id = scene.object_names().iter().position(|n| n == object).unwrap();
        (0..scene.triangle_count() as u32).map(TriId).filter(move |&t| scene.object_id(t).index() == id)
    }

    fn area_of(scene: &Scene, object: &str) -> f64 {
        triangles_of(scene, object).map(|t| f64::from(scene.area(t))).sum()
    }

    /// Where a point is in the picture: right and up, ±1 at the edges.
    fn in_picture(camera: &Camera, p: Vec3) -> [f32; 2] {
        let [right, up, forward] = camera.axes().unwrap();
        let d = p - camera.position;
        let scale = 1.0 / (d.dot(forward) * (0.5 * camera.fov_y).tan());
        [d.dot(right) * scale, d.dot(up) * scale]
    }

    #[test]
    fn the_measured_corners_are_vertices() {
        let scene = built();
        let has = |p: [f32; 3]| scene.positions().contains(&metres(p));
        for (_, _, corners) in WALLS {
            assert!(corners.into_iter().all(has));
        }
        for (_, height, top, _) in BLOCKS {
            assert!(top.iter().all(|&[x, z]| has([x, height, z]) && has([x, 0.0, z])));
        }
    }

    #[test]
    fn areas_are_those_of_the_measured_quadrilaterals() {
        let scene = built();
        let near = |object: &str, mm2: f64| {
            let area = area_of(&scene, object) * 1e6;
            assert!((area / mm2 - 1.0).abs() < 1e-4, "{object}: {area} mm2");
        };
        near("floor", 0.5 * (552.8 + 549.6) * 559.2);
        near("ceiling", 556.0 * 559.2);
        near("back wall", 0.5 * (549.6 + 556.0) * 548.8);
        near("right wall", 548.8 * 559.2);
        // Top by the shoelace formula, sides as perimeter times height.
        near("short block", 27_633.0 + 165.0 * perimeter(BLOCKS[0].2));
        near("tall block", 27_626.5 + 330.0 * perimeter(BLOCKS[1].2));
    }

    fn perimeter(top: [[f32; 2]; 4]) -> f64 {
        let corner = |k: usize| glam::Vec2::from(top[k % 4]);
        (0..4).map(|k| f64::from(corner(k).distance(corner(k + 1)))).sum()
    }

    #[test]
    fn every_face_looks_into_the_room_or_out_of_its_block() {
        let scene = built();
        let room = metres([278.0, 274.4, 279.6]);
        for (object, from, sign) in WALLS.map(|w| (w.0, room, -1.0)).into_iter().chain([
            ("short block", metres([185.0, 80.0, 169.0]), 1.0),
            ("tall block", metres([368.0, 160.0, 351.0]), 1.0),
        ]) {
            for tri in triangles_of(&scene, object) {
                let outward = scene.triangle_positions(tri)[0] - from;
                assert!(sign * outward.dot(scene.geometric_normal(tri)) > 0.0, "{object}");
            }
        }
    }

    #[test]
    fn walls_share_the_points_of_their_common_edges() {
        let scene = built();
        let mut at = std::collections::HashMap::new();
        for p in scene.positions() {
            *at.entry(p.to_array().map(f32::to_bits)).or_insert(0) += 1;
        }
        // Room edges: 8 of 41 points join two walls, except that the 4 back corners join three. Blocks: each has 4
        // edges of 13 points around its top, and 4 uprights.
        let uprights = (12 - 1) + (24 - 1);
        assert_eq!(at.values().filter(|&&n| n == 2).count(), 8 * 40 - 8 + 4 + 2 * 4 * 11 + 4 * uprights + 8);
        assert_eq!(at.values().filter(|&&n| n == 3).count(), 4 + 8);
    }

    #[test]
    fn the_light_is_13650_square_millimetres_and_shines_down() {
        let light = ceiling_light();
        assert!((light.area() - 0.130 * 0.105).abs() < 1e-8);
        assert_eq!(light.normal(), Some(-Vec3::Y));
        assert!((light.corners()[2] - metres([343.0, 548.3, 332.0])).length() < 1e-6);
    }

    #[test]
    fn red_is_left_and_green_right_in_the_picture() {
        let camera = front_camera();
        let [red, floor] = in_picture(&camera, metres([552.8, 0.0, 0.0]));
        let [green, ceiling] = in_picture(&camera, metres([0.0, 548.8, 0.0]));
        assert!((-1.0..-0.95).contains(&red) && (0.95..1.0).contains(&green), "{red} {green}");
        assert!((-1.0..-0.94).contains(&floor) && (0.94..1.0).contains(&ceiling), "{floor} {ceiling}");
        let scene = built();
        let colour = |object| scene.material(triangles_of(&scene, object).next().unwrap()).albedo;
        assert_eq!((colour("left wall"), colour("right wall")), (RED, GREEN));
    }

    #[test]
    fn a_vertex_every_fourteen_millimetres_makes_eleven_thousand() {
        let n = built().vertex_count();
        assert!((10_000..12_000).contains(&n), "{n}");
    }
}
