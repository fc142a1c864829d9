//! The galleries: floors, groin vaults, and outer walls with blind arches.

use super::arcade::{add_ring, add_soffit, add_wall, arch_point};
use super::paint::{DOOR, MARBLE, MASONRY, PLASTER, TRIM};
use super::plan::{
    ARCH, BAY, CELL, GROUND, MASONRY_TILE, Plan, STOREYS, Side, Storey, UPPER, VAULT, depth, half_circle,
    is_built_on, masonry_uv,
};
use crate::shapes::{add_grid, add_strips};
use glam::{DVec2, Vec2, Vec3};
use lumel_scene::{MaterialId, ObjectMesh, Smoothing};

/// Rows of cells up to where arches and vaults begin, at level 0.
const WALL_ROWS: u32 = 6;

/// Longest edge within a vault at level 0, cells.
const VAULT_STEP: f64 = 1.5;

/// Marble tiles are this wide, metres; the texture shows two by two.
const MARBLE_TILE: f64 = 0.7;

/// The floor of the court and lower gallery, that of the upper gallery, and the top of the parapet.
pub(super) fn add_floors(mesh: &mut ObjectMesh, plan: Plan) {
    let [long, short] = [Side::ALL[0], Side::ALL[1]];
    let within = |x: f64, z: f64, d: f64| x.abs() < short.line + d && z.abs() < long.line + d;
    let floor = |mesh: &mut ObjectMesh, material, y, keep: &dyn Fn(f64, f64) -> bool| {
        add_floor(mesh, material, plan, y, |x, z| keep(x, z) && !is_built_on(x, z));
    };
    floor(mesh, MARBLE, GROUND.floor, &|_, _| true);
    floor(mesh, MARBLE, UPPER.floor, &|x, z| !within(x, z, depth::GALLERY));
    floor(mesh, TRIM, UPPER.foot, &|x, z| within(x, z, depth::GALLERY) && !within(x, z, depth::COURT));
}

/// A horizontal floor of the cells whose middle (in cells) is to be kept.
fn add_floor(
    mesh: &mut ObjectMesh,
    material: MaterialId,
    plan: Plan,
    y: f64,
    keep: impl Fn(f64, f64) -> bool,
) {
    let stops = |side: Side| plan.refined(&side.stops(side.half + depth::WALL));
    let (xs, zs) = (stops(Side::ALL[0]), stops(Side::ALL[1]));
    let all = mesh.faces.len();
    add_grid(mesh, material, [xs.len() as u32 - 1, zs.len() as u32 - 1], |i, j| {
        // Rows run towards -z, so that the front is up.
        let p = DVec2::new(xs[i as usize], zs[zs.len() - 1 - j as usize]) * CELL;
        (Vec3::new(p.x as f32, y as f32, p.y as f32), (p / (2.0 * MARBLE_TILE)).as_vec2())
    });
    let middle = |corners: [Vec3; 3]| {
        let (min, max) =
            (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        0.5 * (min + max).as_dvec3() / CELL
    };
    let kept = mesh.faces.split_off(all);
    let kept = kept.into_iter().filter(|face| {
        let p = middle(mesh.corners(face));
        keep(p.x, p.z)
    });
    let kept: Vec<_> = kept.collect();
    mesh.faces.extend(kept);
}

/// Groin vaults over the bays, barrels over the strips beside the corners.
pub(super) fn add_vaults(mesh: &mut ObjectMesh, plan: Plan) {
    for side in Side::ALL {
        for storey in STOREYS {
            for bay in side.bays().chain([side.half + 1.0]) {
                for turns in 0..4 {
                    add_web(mesh, plan, side, bay, storey, turns);
                }
            }
            for strip in [-side.half - 1.0, side.half] {
                add_barrel(mesh, plan, side, strip, storey);
            }
        }
    }
}

/// A quarter of a groin vault: the part of a barrel between an edge of the bay and the two groins.
fn add_web(mesh: &mut ObjectMesh, plan: Plan, side: Side, bay: f64, storey: Storey, turns: u32) {
    let n = plan.arc();
    let point = |across: f64, along: f64, height: f64| {
        let (p, q) = match turns {
            0 => (across, along),
            1 => (along, -across),
            2 => (-across, -along),
            _ => (-along, across),
        };
        let (s, d) = (bay + 0.5 * BAY + p, depth::GALLERY + VAULT + q);
        (side.at(s, storey.spring + height * CELL, d), vault_uv(s, d))
    };
    let line = |k: u32| -> Vec<(Vec3, Vec2)> {
        let p = half_circle(k, n) * VAULT;
        // The barrel reaches the groin where it is as far from the middle as from its own axis.
        let (groin, edge) = (p.x.abs(), VAULT);
        let length = (edge - groin) * f64::from(plan.fine);
        let n_rows = (length / VAULT_STEP).round().max(f64::from(u8::from(edge > groin)));
        let rows = n_rows as u32;
        (0..=rows)
            .map(|j| {
                point(p.x, if j == rows { edge } else { groin + (edge - groin) * f64::from(j) / n_rows }, p.y)
            })
            .collect()
    };
    let first = mesh.faces.len();
    add_strips(mesh, PLASTER, &(0..=n).map(line).collect::<Vec<_>>());
    // Smooth along a barrel, from bay to bay, but sharp at the groins, however flat they are near the crown.
    mesh.faces[first..].iter_mut().for_each(|face| face.smoothing = Smoothing::Group(turns % 2));
}

/// A cell of barrel vault across the gallery, between a bay and the corner bay.
fn add_barrel(mesh: &mut ObjectMesh, plan: Plan, side: Side, strip: f64, storey: Storey) {
    let n = plan.arc();
    let stops = plan.even(strip, strip + 1.0, 1);
    let first = mesh.faces.len();
    add_grid(mesh, PLASTER, [plan.fine, n], |i, j| {
        let p = half_circle(j, n) * VAULT;
        let (s, d) = (stops[i as usize], depth::GALLERY + VAULT + p.x);
        (side.at(s, storey.spring + p.y * CELL, d), vault_uv(s, d))
    });
    mesh.faces[first..].iter_mut().for_each(|face| face.smoothing = Smoothing::Group(1));
}

/// The walls behind the galleries: piers that carry the vaults, blind arches between them.
pub(super) fn add_outer_walls(mesh: &mut ObjectMesh, plan: Plan) {
    for side in Side::ALL {
        for storey in STOREYS {
            let heights = plan.even(storey.floor, storey.spring, WALL_ROWS);
            for bay in side.wall_bays() {
                add_blind_arch(mesh, plan, side, bay, storey, &heights);
            }
            for strip in [-side.half - 1.0, side.half] {
                let stops = plan.even(strip, strip + 1.0, 1);
                add_wall(mesh, MASONRY, side, &stops, &heights, depth::PIER);
            }
        }
    }
}

fn add_blind_arch(mesh: &mut ObjectMesh, plan: Plan, side: Side, bay: f64, storey: Storey, heights: &[f64]) {
    let [left, right] = [bay + 0.5 * BAY - ARCH, bay + 0.5 * BAY + ARCH];
    for (from, to) in [(bay, left), (right, bay + BAY)] {
        add_wall(mesh, MASONRY, side, &plan.even(from, to, 1), heights, depth::PIER);
    }
    let depths = plan.even(depth::PIER, depth::WALL, 1);
    let jamb = |s: f64, i: u32, j: u32| {
        let (d, y) = (depths[i as usize], heights[j as usize]);
        (side.at(s, y, d), masonry_uv(d, y))
    };
    let cells = [plan.fine, heights.len() as u32 - 1];
    add_grid(mesh, MASONRY, cells, |i, j| jamb(left, plan.fine - i, j));
    add_grid(mesh, MASONRY, cells, |i, j| jamb(right, i, j));
    add_ring(mesh, plan, side, bay, storey, depth::PIER);
    add_soffit(mesh, plan, side, bay, storey, [depth::PIER, depth::WALL]);
    let material = if is_door(side, bay, storey) { DOOR } else { PLASTER };
    add_wall(mesh, material, side, &plan.even(left, right, 4), heights, depth::WALL);
    add_half_disc(mesh, material, plan, side, bay, storey);
}

/// The head of the wall within a blind arch.
fn add_half_disc(
    mesh: &mut ObjectMesh,
    material: MaterialId,
    plan: Plan,
    side: Side,
    bay: f64,
    storey: Storey,
) {
    let rings = 2 * plan.fine;
    let line = |ring: u32| -> Vec<(Vec3, Vec2)> {
        let n = plan.arc() * ring / rings;
        let radius = ARCH * f64::from(ring) / f64::from(rings);
        let point = |k: u32| {
            let p = arch_point(bay, storey, radius, k, n.max(1));
            (side.at(p.x, p.y, depth::WALL), masonry_uv(p.x, p.y))
        };
        (0..=n).map(point).collect()
    };
    add_strips(mesh, material, &(0..=rings).map(line).collect::<Vec<_>>());
}

/// Doors are in the middle of the short sides and beside the middle of the long ones, on the ground.
fn is_door(side: Side, bay: f64, storey: Storey) -> bool {
    let middle = bay + 0.5 * BAY;
    storey.floor == GROUND.floor && if side.is_long() { middle.abs() == 1.5 * BAY } else { middle == 0.0 }
}

fn vault_uv(s: f64, d: f64) -> Vec2 {
    (DVec2::new(s, d) * CELL / MASONRY_TILE).as_vec2()
}
