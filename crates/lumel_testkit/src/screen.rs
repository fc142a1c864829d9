//! A square light half hidden by a screen: light and shadow on the floor below are known.

use crate::mesh::quad;
use crate::{form_factor, scene::ceiling_light};
use glam::{DVec3, Vec3};
use lumel_scene::{Light, ObjectMesh};
use std::f64::consts::PI;

/// The light, parallel to the xy plane at z = 2, facing down.
const LIGHT: [[f64; 2]; 2] = [[-0.5, 0.5]; 2];
/// The screen, half-way below it.
const SCREEN: [[f64; 2]; 2] = [[0.0, 1.0], [-1.0, 1.0]];

/// Irradiance in the plane z = 0 at y = 0, by x: umbra from 0.5 to 1.5, penumbra on both sides.
pub const KNOWN: [(f64, f64); 10] = [
    (-0.75, 0.183489300),
    (-0.25, 0.174847641),
    (0.0, 0.115418399),
    (0.25, 0.049944845),
    (0.5, 0.0),
    (1.0, 0.0),
    (1.5, 0.0),
    (2.0, 0.039537654),
    (2.25, 0.041533091),
    (2.5, 0.039069838),
];

/// The light, whose radiance is 1.
pub fn light() -> Light {
    Light::Rect(ceiling_light(Vec3::Z * 2.0, 1.0, 1.0, 1.0))
}

/// The screen, which faces down.
pub fn screen(material: u32) -> ObjectMesh {
    let [[left, right], [front, back]] = SCREEN.map(|side| side.map(|x| x as f32));
    let corners = [[right, front], [left, front], [left, back], [right, back]];
    quad(corners.map(|[x, y]| Vec3::new(x, y, 1.0)), [1, 1], material)
}

/// Irradiance at a point below the screen of a surface that faces up: the light without the shadow of the screen on it.
pub fn irradiance(point: DVec3) -> f64 {
    let factor = |polygon: &[DVec3]| form_factor::polygon(polygon, point, DVec3::Z);
    let light = form_factor::facing_down(LIGHT[0], LIGHT[1], 2.0);
    let hidden = form_factor::hidden_part(LIGHT, 2.0, SCREEN, 1.0, point);
    PI * (factor(&light) - hidden.map_or(0.0, |hidden| factor(&hidden)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_has_the_known_values() {
        for (x, e) in KNOWN {
            // They have nine digits.
            assert!((irradiance(DVec3::X * x) - e).abs() < 1e-9, "{x}: {}", irradiance(DVec3::X * x));
        }
    }
}
