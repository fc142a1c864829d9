//! The arcades: arches with the wall above them, corner piers and parapets.

use super::paint::{MASONRY, TRIM};
use super::plan::{
    ARCH, BAY, CELL, MASONRY_TILE, Plan, STOREYS, Side, Storey, VAULT, depth, half_circle, masonry_uv,
};
use crate::shapes::add_grid;
use glam::{DVec2, Vec2};
use lumel_scene::{MaterialId, ObjectMesh};

/// Width of the band of cut stones around an arch, cells.
const BAND: f64 = 0.55;

/// Cells up the side of the wall above an arch, and along its top: together they are the arch's segments.
const RISE_SEGMENTS: u32 = 5;

pub(super) fn add_arcades(mesh: &mut ObjectMesh, plan: Plan) {
    for side in Side::ALL {
        for storey in STOREYS {
            for bay in side.bays() {
                add_court_face(mesh, plan, side, bay, storey);
                add_ring(mesh, plan, side, bay, storey, depth::GALLERY);
                add_soffit(mesh, plan, side, bay, storey, [depth::COURT, depth::GALLERY]);
            }
            add_corner_pier(mesh, plan, side, storey);
        }
    }
}

/// The arch seen from the court, with its band and the wall up to the moulding.
///
/// Beside a corner the wall ends at the face of the neighbouring side, which the arch just touches.
fn add_court_face(mesh: &mut ObjectMesh, plan: Plan, side: Side, bay: f64, storey: Storey) {
    let limit = side.half + depth::COURT;
    let (left, right) = (bay.max(-limit), (bay + BAY).min(limit));
    let top: Vec<f64> = side.stops(limit).into_iter().filter(|s| (left..=right).contains(s)).collect();
    // The side that touches the corner has one stop less along the top, and one more up the side.
    let rise = |s: f64| plan.even(storey.spring, storey.top, RISE_SEGMENTS + u32::from(s.abs() == limit));
    let mut frame: Vec<DVec2> = rise(left).iter().map(|&y| DVec2::new(left, y)).collect();
    frame.extend(plan.refined(&top)[1..].iter().map(|&s| DVec2::new(s, storey.top)));
    frame.extend(rise(right).iter().rev().skip(1).map(|&y| DVec2::new(right, y)));

    let n = plan.arc();
    let circle = |k: u32, radius: f64| {
        let p = arch_point(bay, storey, radius, k, n);
        DVec2::new(p.x.clamp(left, right), p.y)
    };
    let face = |p: DVec2| side.at(p.x, p.y, depth::COURT);
    add_grid(mesh, TRIM, [n, plan.fine], |i, j| {
        let outward = f64::from(j) / f64::from(plan.fine);
        let p = circle(n - i, ARCH + BAND * outward);
        (face(p), band_uv(n - i, n, outward))
    });
    add_grid(mesh, MASONRY, [n, 2 * plan.fine], |i, j| {
        let p =
            circle(n - i, ARCH + BAND).lerp(frame[(n - i) as usize], f64::from(j) / f64::from(2 * plan.fine));
        (face(p), masonry_uv(p.x, p.y))
    });
}

/// The ring between an arch and the vault that springs around it, seen from the gallery.
///
/// The ring of the arcade faces away from the court, that of the blind arches faces it.
pub(super) fn add_ring(mesh: &mut ObjectMesh, plan: Plan, side: Side, bay: f64, storey: Storey, d: f64) {
    let n = plan.arc();
    add_grid(mesh, TRIM, [n, plan.fine], |i, j| {
        let k = if d < depth::PIER { i } else { n - i };
        let outward = f64::from(j) / f64::from(plan.fine);
        let p = arch_point(bay, storey, ARCH + (VAULT - ARCH) * outward, k, n);
        (side.at(p.x, p.y, d), band_uv(k, n, outward))
    });
}

/// The underside of an arch between two depths.
pub(super) fn add_soffit(
    mesh: &mut ObjectMesh,
    plan: Plan,
    side: Side,
    bay: f64,
    storey: Storey,
    [from, to]: [f64; 2],
) {
    let n = plan.arc();
    let depths = plan.even(from, to, (to - from).round() as u32);
    add_grid(mesh, TRIM, [n, depths.len() as u32 - 1], |i, j| {
        let d = depths[j as usize];
        let p = arch_point(bay, storey, ARCH, i, n);
        (side.at(p.x, p.y, d), band_uv(i, n, d - from))
    });
}

/// The square pier in the corner that follows a side, from the foot of the columns to the arches.
fn add_corner_pier(mesh: &mut ObjectMesh, plan: Plan, side: Side, storey: Storey) {
    let heights = plan.even(storey.foot, storey.spring, 7);
    for next in 0..4 {
        // The corner's four faces, each seen from outside with `s` to its right.
        let (along, out): (DVec2, DVec2) = match next {
            0 => (DVec2::X, DVec2::Y),
            1 => (-DVec2::Y, DVec2::X),
            2 => (-DVec2::X, -DVec2::Y),
            _ => (DVec2::Y, -DVec2::X),
        };
        let across = plan.even(-1.0, 1.0, 2);
        add_grid(mesh, MASONRY, [across.len() as u32 - 1, heights.len() as u32 - 1], |i, j| {
            let (p, y) = (along * across[i as usize] + out, heights[j as usize]);
            (side.at(side.half + p.x, y, p.y), masonry_uv(across[i as usize], y))
        });
    }
}

/// Adds a rectangle of wall at depth `d` that faces the court, or away from it for heights that descend.
pub(super) fn add_wall(
    mesh: &mut ObjectMesh,
    material: MaterialId,
    side: Side,
    stops: &[f64],
    heights: &[f64],
    d: f64,
) {
    let columns = stops.len() as u32 - 1;
    add_grid(mesh, material, [columns, heights.len() as u32 - 1], |i, j| {
        let (s, y) = (stops[(columns - i) as usize], heights[j as usize]);
        (side.at(s, y, d), masonry_uv(s, y))
    });
}

/// A point of an arch in the middle of a bay: cells along the side, metres up.
pub(super) fn arch_point(bay: f64, storey: Storey, radius: f64, k: u32, n: u32) -> DVec2 {
    let p = half_circle(k, n) * radius;
    DVec2::new(bay + 0.5 * BAY + p.x, storey.spring + p.y * CELL)
}

/// Texture coordinate around an arch: along it, and across in cells.
fn band_uv(k: u32, n: u32, across: f64) -> Vec2 {
    let along = 3.3 * f64::from(k) / f64::from(n);
    DVec2::new(along / MASONRY_TILE, across * CELL / MASONRY_TILE).as_vec2()
}
