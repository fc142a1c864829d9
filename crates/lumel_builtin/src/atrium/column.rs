//! Columns: plinth, base, shaft with entasis, capital, abacus.

use super::paint::COLUMN;
use super::plan::{ARC_SEGMENTS, CELL, Plan, STOREYS, Side, Storey};
use crate::shapes::{Ring, add_loft};
use Ring::{Round, Square};
use lumel_scene::ObjectMesh;

/// Half of the sides of plinth and pier, metres: one cell.
const PIER: f64 = CELL;

/// Rows of the shaft at level 0.
const SHAFT_ROWS: u32 = 5;

pub(super) fn add_columns(mesh: &mut ObjectMesh, plan: Plan) {
    for side in Side::ALL {
        for storey in STOREYS {
            for bay in side.bays().skip(1) {
                add_column(mesh, plan, side, bay, storey);
            }
        }
    }
}

/// A column on the column line, open below the plinth and where the arches stand on the abacus.
fn add_column(mesh: &mut ObjectMesh, plan: Plan, side: Side, s: f64, storey: Storey) {
    let rings = profile(storey.spring - storey.foot);
    add_loft(mesh, COLUMN, &rings, [ARC_SEGMENTS * plan.fine, plan.fine], 1.4, |across, height| {
        // The side's axes s and d, seen from above, turn the other way round than x and y.
        side.at(s + across.x / CELL, storey.foot + height, across.y / CELL)
    });
}

/// The outline of a column of a height, from the floor to the arches.
fn profile(height: f64) -> Vec<Ring> {
    let thick = height / 3.2;
    // Plinth and attic base: torus, scotia, torus.
    let mut rings = vec![Square(0.0, PIER), Square(0.14, PIER), Round(0.14, 0.31 * thick)];
    let base = [(0.20, 0.34), (0.27, 0.285), (0.33, 0.285)];
    rings.extend(base.map(|(y, r)| Round(y, r * thick)));
    // Shaft: thickest a third of the way up, as the ancients built it.
    let (foot, head) = (0.37, height - 0.58);
    for k in 0..=SHAFT_ROWS {
        let t = f64::from(k) / f64::from(SHAFT_ROWS);
        let entasis = 0.25 + 0.012 * (1.0 - (t / 0.33 - 1.0).powi(2)).max(-1.0) - 0.045 * (t - 0.33).max(0.0);
        rings.push(Round(foot + (head - foot) * t, entasis * thick));
    }
    // Capital: ring, neck and flaring bell; abacus, narrowed to the pier above it.
    let bell = [(0.55, 0.255), (0.51, 0.235), (0.40, 0.24), (0.27, 0.29), (0.16, 0.36)];
    rings.extend(bell.map(|(below, r)| Round(height - below, r * thick.max(0.9))));
    rings.extend([Square(height - 0.16, 0.42), Square(height - 0.04, 0.42), Square(height, PIER)]);
    rings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atrium::plan::{BAY, GROUND, UPPER};
    use crate::shapes::object;

    #[test]
    fn columns_face_outward_and_enclose_what_a_column_should() {
        for storey in [GROUND, UPPER] {
            for side in Side::ALL {
                let mut mesh = object("column");
                add_column(&mut mesh, Plan { fine: 1 }, side, -BAY, storey);
                // Cones from the middle of the foot; the open top is closed by one more.
                let foot = side.at(-BAY, storey.foot, 0.0);
                let cone = |[a, b, c]: [glam::Vec3; 3]| (a - foot).dot((b - foot).cross(c - foot)) / 6.0;
                let sum: f32 = mesh.faces.iter().map(|f| cone(mesh.corners(f))).sum();
                let height = (storey.spring - storey.foot) as f32;
                let volume = sum + height * 0.7 * 0.7 / 3.0;
                assert!((0.15 * height..0.28 * height).contains(&volume), "{volume}");
            }
        }
    }
}
