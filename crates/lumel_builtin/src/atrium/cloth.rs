//! Banners that hang into the court.

use super::paint::BANNERS;
use super::paint::TRIM;
use super::plan::{BAY, CELL, Plan, Side, depth};
use crate::shapes::{Ring, add_grid, add_loft};
use glam::Vec2;
use lumel_scene::ObjectMesh;

/// Half the width of a banner, its length, and how far it hangs in front of the wall, metres.
const HALF_WIDTH: f64 = 0.55;
const LENGTH: f64 = 2.7;
const AWAY: f64 = 0.24;

/// Height of the poles, metres: under the coping.
const POLE: f64 = 5.82;

pub(super) fn add_banners(mesh: &mut ObjectMesh, plan: Plan) {
    let mut colours = BANNERS.iter().cycle();
    for side in Side::ALL.into_iter().filter(|side| side.is_long()) {
        for (s, colour) in [-2.0 * BAY, 0.0, 2.0 * BAY].into_iter().zip(colours.by_ref()) {
            add_pole(mesh, plan, side, s);
            let cells = [8 * plan.fine, 12 * plan.fine];
            add_grid(mesh, *colour, cells, |i, j| {
                // Across from +s to -s, so that the front looks into the court; down from 1 to 0.
                let across = 1.0 - 2.0 * f64::from(i) / f64::from(cells[0]);
                let up = f64::from(j) / f64::from(cells[1]);
                let folds =
                    (0.015 + 0.05 * (1.0 - up)) * (across * 430.0 + 40.0 * up + 30.0 * s).to_radians().sin();
                let d = depth::COURT - (AWAY + folds) / CELL;
                let position = side.at(s + across * HALF_WIDTH / CELL, POLE - LENGTH * (1.0 - up), d);
                (position, Vec2::new((0.5 - 0.5 * across) as f32, 1.0 - up as f32))
            });
        }
    }
}

/// A round pole along the wall with pointed ends.
fn add_pole(mesh: &mut ObjectMesh, plan: Plan, side: Side, s: f64) {
    let half = HALF_WIDTH + 0.08;
    let rings = [(-half - 0.06, 0.0), (-half, 0.025), (half, 0.025), (half + 0.06, 0.0)];
    let rings = rings.map(|(height, radius)| Ring::Round(height, radius));
    add_loft(mesh, TRIM, &rings, [8 * plan.fine, plan.fine], 1.0, |across, along| {
        side.at(s + along / CELL, POLE + across.x, depth::COURT - (AWAY + across.y) / CELL)
    });
}
