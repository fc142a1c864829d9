//! What runs all around: parapet, string course, coping, cornice, roof and the outside.

use super::arcade::add_wall;
use super::paint::{MASONRY, ROOF, TRIM};
use super::plan::{CELL, MASONRY_TILE, Plan, Side, UPPER, depth};
use crate::shapes::add_grid;
use glam::DVec2;
use lumel_scene::{MaterialId, ObjectMesh};

/// A profile: metres away from the court, metres up. Seen along `+s` its front is on the left.
type Profile<'a> = &'a [(f64, f64)];

/// Between the storeys.
const STRING_COURSE: Profile =
    &[(0.0, 4.9), (-0.05, 4.94), (-0.10, 5.07), (-0.15, 5.11), (-0.15, 5.19), (0.0, 5.3)];

/// The parapet's coping on the side of the court.
const COPING: Profile = &[(0.0, 6.0), (-0.06, 6.03), (-0.08, 6.10), (-0.06, 6.2), (0.0, 6.2)];

/// The same on the side of the gallery.
const COPING_BEHIND: Profile = &[(0.0, 6.2), (0.06, 6.2), (0.08, 6.10), (0.06, 6.03), (0.0, 6.0)];

/// Below the roof.
const CORNICE: Profile =
    &[(0.0, 9.9), (-0.06, 9.95), (-0.12, 10.08), (-0.26, 10.22), (-0.34, 10.28), (-0.34, 10.42)];

/// From the cornice up to the outer wall.
const ROOF_EDGES: [(f64, f64); 2] = [(-0.34, 10.42), (4.15, 13.0)];

pub(super) fn add_mouldings(mesh: &mut ObjectMesh, plan: Plan) {
    let parapet = [STRING_COURSE[5].1, COPING[0].1];
    for side in Side::ALL {
        for profile in [STRING_COURSE, COPING, CORNICE] {
            add_moulding(mesh, TRIM, plan, side, depth::COURT, profile);
        }
        add_moulding(mesh, TRIM, plan, side, depth::GALLERY, COPING_BEHIND);
        let stops = |d: f64| plan.refined(&side.stops(side.half + d));
        let up = plan.even(parapet[0], parapet[1], 2);
        add_wall(mesh, MASONRY, side, &stops(depth::COURT), &up, depth::COURT);
        let down = plan.even(parapet[1], UPPER.floor, 2);
        add_wall(mesh, MASONRY, side, &stops(depth::GALLERY), &down, depth::GALLERY);
    }
}

/// Roofs that slope to the court, and the plain outside of the building.
pub(super) fn add_roof(mesh: &mut ObjectMesh, plan: Plan) {
    let [eaves, ridge] = ROOF_EDGES.map(DVec2::from);
    let straight = |a: DVec2, b: DVec2, n: u32| -> Vec<(f64, f64)> {
        (0..=n).map(|k| a.lerp(b, f64::from(k) / f64::from(n)).into()).collect()
    };
    for side in Side::ALL {
        add_moulding(mesh, ROOF, plan, side, depth::COURT, &straight(eaves, ridge, 6));
        let foot = DVec2::new(ridge.x, 0.0);
        add_moulding(mesh, MASONRY, plan, side, depth::COURT, &straight(ridge, foot, 10));
    }
}

/// Sweeps a profile along a side at a depth; sides meet in mitres.
fn add_moulding(
    mesh: &mut ObjectMesh,
    material: MaterialId,
    plan: Plan,
    side: Side,
    d: f64,
    profile: Profile,
) {
    let limit = side.half + d;
    let stops = plan.refined(&side.stops(limit));
    let offsets = plan.refined(&profile.iter().map(|p| p.0).collect::<Vec<_>>());
    let heights = plan.refined(&profile.iter().map(|p| p.1).collect::<Vec<_>>());
    let mut along = vec![0.0];
    for j in 1..offsets.len() {
        along.push(along[j - 1] + (offsets[j] - offsets[j - 1]).hypot(heights[j] - heights[j - 1]));
    }
    let columns = stops.len() as u32 - 1;
    add_grid(mesh, material, [columns, offsets.len() as u32 - 1], |i, j| {
        let (s, out) = (stops[(columns - i) as usize], offsets[j as usize] / CELL);
        let position = side.at(s * (limit + out) / limit, heights[j as usize], d + out);
        (position, (DVec2::new(s * CELL, -along[j as usize]) / MASONRY_TILE).as_vec2())
    });
}
