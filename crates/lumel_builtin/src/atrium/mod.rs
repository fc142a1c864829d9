//! An arcaded court on two storeys, in the manner of the atrium of the Sponza palace in Dubrovnik.
//!
//! Plan (cells of 0.35 m): the court is 8 bays by 3, a bay is 8 cells. Arcades of 2 cells' thickness stand on the
//! column lines; behind them run galleries of 8 cells under groin vaults, and behind those a wall of blind arches,
//! the mirror image of the arcade. All curved parts come out rounder at higher levels.

mod arcade;
mod cloth;
mod column;
mod gallery;
mod moulding;
mod paint;
mod plan;
#[cfg(test)]
mod tests;

use crate::shapes::object;
use glam::Vec3;
use lumel_scene::{Camera, Light, ObjectMesh, Radiance, RectLight, SceneBuilder};
use plan::Plan;

/// The court at a level of detail: 0 has about 65 000 triangles, every further level four times as many.
pub(crate) fn atrium(subdivide: u32) -> SceneBuilder {
    SceneBuilder {
        name: "atrium".to_owned(),
        objects: objects(Plan { fine: 1 << subdivide }),
        materials: paint::materials(),
        textures: paint::textures(),
        lights: vec![Light::Rect(sun())],
        light_names: vec!["sun".to_owned()],
        cameras: cameras(),
        // A clear sky: what the shade of the galleries lives on.
        sky: Radiance(Vec3::new(0.55, 0.74, 1.05)).into(),
        ..SceneBuilder::default()
    }
}

fn objects(plan: Plan) -> Vec<ObjectMesh> {
    type Add = fn(&mut ObjectMesh, Plan);
    let parts: [(&str, Add); 8] = [
        ("floors", gallery::add_floors),
        ("arcades", arcade::add_arcades),
        ("columns", column::add_columns),
        ("vaults", gallery::add_vaults),
        ("outer walls", gallery::add_outer_walls),
        ("mouldings", moulding::add_mouldings),
        ("roof", moulding::add_roof),
        ("banners", cloth::add_banners),
    ];
    let built = |(name, add): (&str, Add)| {
        let mut mesh = object(name);
        add(&mut mesh, plan);
        mesh
    };
    parts.map(built).into()
}

/// A warm square of sky high above the court, tilted so that it lights one long side and part of the floor.
fn sun() -> RectLight {
    const SIDE: f32 = 3.0;
    let center = Vec3::new(7.0, 26.0, 10.0);
    let to_court = Vec3::new(-1.0, 2.0, -1.0) - center;
    let u = to_court.cross(Vec3::Y).normalize_or(Vec3::X);
    let v = to_court.cross(u).normalize_or(Vec3::Z);
    let (u, v) = (u * (0.5 * SIDE), v * (0.5 * SIDE));
    RectLight { center, u, v, radiance: Radiance(Vec3::new(480.0, 410.0, 310.0)), texture: None }
}

fn cameras() -> Vec<Camera> {
    let camera = |name, position, target, degrees: f32| {
        Camera::looking_at(name, Vec3::from(position), Vec3::from(target), degrees.to_radians())
    };
    vec![
        camera("court", [-9.9, 1.7, 1.3], [3.0, 4.3, -0.8], 66.0),
        camera("gallery", [-10.5, 1.7, 6.0], [4.0, 2.4, 5.75], 62.0),
        camera("upper", [-9.2, 7.2, 6.6], [2.0, 5.2, -2.6], 66.0),
    ]
}
