//! Noise that tiles and is the same on every machine: hashes of integers, no random generator.

use glam::Vec2;

/// A number in 0..1 that looks random, for each cell of a grid.
pub(crate) fn hash(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    for multiplier in [0x7feb_352d_u32, 0x846c_a68b] {
        h = (h ^ (h >> 16)).wrapping_mul(multiplier);
    }
    ((h ^ (h >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Smooth noise in 0..1 over the unit square, `period` cells to a side; tiles.
pub(crate) fn value(uv: Vec2, period: [u32; 2], seed: u32) -> f32 {
    let (cell, f) = cell_of(uv, period);
    let fade = f * f * (Vec2::splat(3.0) - 2.0 * f);
    let next = [0, 1].map(|axis| within(cell[axis] + 1, period[axis]));
    let at = |x, y| hash(x, y, seed);
    let top = mix(at(cell[0], cell[1]), at(next[0], cell[1]), fade.x);
    let bottom = mix(at(cell[0], next[1]), at(next[0], next[1]), fade.x);
    mix(top, bottom, fade.y)
}

/// Five octaves of [`value`], the first with `period` cells: clouds in 0..1 around 0.5; tiles.
pub(crate) fn clouds(uv: Vec2, period: [u32; 2], seed: u32) -> f32 {
    const SHARES: [f32; 5] = [0.5, 0.25, 0.125, 0.0625, 0.03125];
    let octave = |(k, share): (u32, f32)| value(uv, period.map(|p| p << k), seed + k) * share;
    (0..).zip(SHARES).map(octave).sum::<f32>() / SHARES.iter().sum::<f32>()
}

/// Distance to the nearest and the second nearest of randomly placed points, one to a cell, in cells; tiles.
pub(crate) fn nearest_points(uv: Vec2, period: [u32; 2], seed: u32) -> [f32; 2] {
    let (cell, f) = cell_of(uv, period);
    let mut nearest = [f32::MAX; 2];
    for dy in 0..3 {
        for dx in 0..3 {
            let (x, y) =
                ((cell[0] + period[0] + dx - 1) % period[0], (cell[1] + period[1] + dy - 1) % period[1]);
            let point = Vec2::new(hash(x, y, seed), hash(x, y, seed + 1));
            let d = (point + Vec2::new(dx as f32 - 1.0, dy as f32 - 1.0) - f).length();
            if d < nearest[0] {
                nearest = [d, nearest[0]];
            } else if d < nearest[1] {
                nearest[1] = d;
            }
        }
    }
    nearest
}

/// `a` at 0, `b` at 1.
pub(crate) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// 0 below `from`, 1 above `to`, smooth between.
pub(crate) fn smooth_step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The cell of a point of the unit square and where in the cell it is.
fn cell_of(uv: Vec2, period: [u32; 2]) -> ([u32; 2], Vec2) {
    let p = [wrapped(uv.x) * period[0] as f32, wrapped(uv.y) * period[1] as f32];
    let cell = p.map(|p| p as u32);
    let f = Vec2::new(p[0] - cell[0] as f32, p[1] - cell[1] as f32);
    ([within(cell[0], period[0]), within(cell[1], period[1])], f)
}

/// `x.rem_euclid(1.0)` of a number that a texture coordinate may be, without the division of the C library.
pub(crate) fn wrapped(x: f32) -> f32 {
    let fraction = x - x as i32 as f32;
    if fraction < 0.0 { fraction + 1.0 } else { fraction }
}

/// The remainder of a number of less than two periods.
fn within(x: u32, period: u32) -> u32 {
    if x >= period { x - period } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_fill_the_unit_interval_evenly() {
        let mut bins = [0; 10];
        for x in 0..100 {
            for y in 0..100 {
                bins[(hash(x, y, 7) * 10.0) as usize] += 1;
            }
        }
        assert!(bins.iter().all(|n| (850..1150).contains(n)), "{bins:?}");
    }

    #[test]
    fn noise_tiles_and_stays_within_bounds() {
        for k in 0..500 {
            let uv = Vec2::new(hash(k, 0, 1), hash(k, 1, 1));
            let far = uv + Vec2::new(3.0, -2.0);
            for (a, b) in [
                (value(uv, [4, 7], 3), value(far, [4, 7], 3)),
                (clouds(uv, [4, 7], 3), clouds(far, [4, 7], 3)),
                (nearest_points(uv, [4, 7], 3)[0], nearest_points(far, [4, 7], 3)[0]),
            ] {
                assert!((a - b).abs() < 1e-4, "{uv}");
                assert!((0.0..=1.5).contains(&a));
            }
        }
    }

    #[test]
    fn noise_is_continuous_across_the_edge_of_the_tile() {
        for k in 0..200 {
            let y = hash(k, 0, 2);
            let (left, right) = (Vec2::new(1e-6, y), Vec2::new(1.0 - 1e-6, y));
            assert!((clouds(left, [4, 4], 1) - clouds(right, [4, 4], 1)).abs() < 1e-3);
            assert!((nearest_points(left, [4, 4], 1)[0] - nearest_points(right, [4, 4], 1)[0]).abs() < 1e-4);
        }
    }
}
