//! Where things stand: a grid of cells, four sides, two storeys.

use glam::{DVec2, Vec2, Vec3};

/// Side of a cell, metres.
pub(super) const CELL: f64 = 0.35;

/// Cells to a bay, the distance between columns.
pub(super) const BAY: f64 = 8.0;

/// Radius of an arch, cells: three quarters of half a bay.
pub(super) const ARCH: f64 = 3.0;

/// Radius of a vault, cells: half a bay.
pub(super) const VAULT: f64 = 4.0;

/// Segments of a half circle at level 0.
pub(super) const ARC_SEGMENTS: u32 = 16;

/// Depths behind the column line, cells.
pub(super) mod depth {
    /// Court face of the arcade.
    pub(in crate::atrium) const COURT: f64 = -1.0;
    /// Gallery face of the arcade.
    pub(in crate::atrium) const GALLERY: f64 = 1.0;
    /// Front of the blind arches.
    pub(in crate::atrium) const PIER: f64 = 9.0;
    /// The wall within the blind arches.
    pub(in crate::atrium) const WALL: f64 = 10.0;
}

/// Metres that one repeat of the masonry texture covers.
pub(super) const MASONRY_TILE: f64 = 2.8;

/// Stops within a bay, cells: at the piers, and evenly under the arch.
const BAY_STOPS: [f64; 7] = [0.0, 1.0, 2.5, 4.0, 5.5, 7.0, 8.0];

/// Heights of a storey, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Storey {
    /// The gallery's floor.
    pub(super) floor: f64,
    /// What columns stand on.
    pub(super) foot: f64,
    /// Where arches and vaults begin.
    pub(super) spring: f64,
    /// Where the moulding above the arches begins.
    pub(super) top: f64,
}

pub(super) const GROUND: Storey = Storey { floor: 0.0, foot: 0.0, spring: 3.2, top: 4.9 };
pub(super) const UPPER: Storey = Storey { floor: 5.2, foot: 6.2, spring: 8.2, top: 9.9 };
pub(super) const STOREYS: [Storey; 2] = [GROUND, UPPER];

/// One of the four sides of the court, with axes of its own: `s` along it, `d` away from the centre.
///
/// Sides are turns of each other by right angles, so `s`, `y`, `d` are right-handed on each and what faces the court
/// on one does so on all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    turns: u32,
    /// Distance of the corner columns from the middle, cells.
    pub(super) half: f64,
    /// Distance of the column line from the centre, cells.
    pub(super) line: f64,
}

impl Side {
    /// The long sides at even places, the short ones at odd.
    pub(super) const ALL: [Self; 4] = [
        Self { turns: 0, half: 4.0 * BAY, line: 1.5 * BAY },
        Self { turns: 1, half: 1.5 * BAY, line: 4.0 * BAY },
        Self { turns: 2, half: 4.0 * BAY, line: 1.5 * BAY },
        Self { turns: 3, half: 1.5 * BAY, line: 4.0 * BAY },
    ];

    /// The position `s` cells along the side, `y` metres up and `d` cells behind the column line.
    pub(super) fn at(self, s: f64, y: f64, d: f64) -> Vec3 {
        let (s, d) = (s * CELL, (self.line + d) * CELL);
        let [x, z] = match self.turns {
            0 => [s, d],
            1 => [d, -s],
            2 => [-s, -d],
            _ => [-d, s],
        };
        Vec3::new(x as f32, y as f32, z as f32)
    }

    pub(super) fn is_long(self) -> bool {
        self.half > self.line
    }

    /// First cells of the bays of the arcade.
    pub(super) fn bays(self) -> impl Iterator<Item = f64> {
        let n = (2.0 * self.half / BAY).round() as u32;
        (0..n).map(move |k| f64::from(k) * BAY - self.half)
    }

    /// First cells of the bays of the gallery's outer wall: those of the arcade and one at each corner.
    pub(super) fn wall_bays(self) -> impl Iterator<Item = f64> {
        let corner = self.half + 1.0;
        [-corner - BAY, corner].into_iter().chain(self.bays())
    }

    /// Whether the outer wall is recessed at `s`: within a blind arch.
    pub(super) fn is_recessed(self, s: f64) -> bool {
        self.wall_bays().any(|bay| (s - bay - 0.5 * BAY).abs() < ARCH)
    }

    /// Stops along the whole side up to `limit` from the middle, cells.
    pub(super) fn stops(self, limit: f64) -> Vec<f64> {
        let end = self.half + 2.0 + BAY;
        let mut stops: Vec<f64> = self.wall_bays().flat_map(|bay| BAY_STOPS.map(|stop| bay + stop)).collect();
        stops.extend([-end, end]);
        stops.retain(|s| s.abs() <= limit);
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        stops
    }
}

/// The level of detail.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Parts that every length of level 0 is cut into.
    pub(super) fine: u32,
}

impl Plan {
    /// Segments of a half circle.
    pub(super) fn arc(self) -> u32 {
        ARC_SEGMENTS * self.fine
    }

    /// The stops with those of this level between them.
    pub(super) fn refined(self, stops: &[f64]) -> Vec<f64> {
        let fine = f64::from(self.fine);
        let between = |pair: &[f64]| {
            let (a, b) = (pair[0], pair[1]);
            (0..self.fine).map(move |k| a + (b - a) * f64::from(k) / fine)
        };
        stops.windows(2).flat_map(between).chain(stops.last().copied()).collect()
    }

    /// Even stops from `a` to `b`, `n` of them at level 0.
    pub(super) fn even(self, a: f64, b: f64, n: u32) -> Vec<f64> {
        let n = n * self.fine;
        (0..=n).map(|k| if k == n { b } else { a + (b - a) * f64::from(k) / f64::from(n) }).collect()
    }
}

/// The unit half circle from `-x` over `+y` to `+x`, at its `k`th point of `n + 1`.
pub(super) fn half_circle(k: u32, n: u32) -> DVec2 {
    let angle = (180.0 * f64::from(k) / f64::from(n)).to_radians();
    // Exact at the top and at the ends, where other parts meet it.
    if 2 * k == n { DVec2::Y } else { DVec2::new(-angle.cos(), if k == n { 0.0 } else { angle.sin() }) }
}

/// Texture coordinate of masonry `s` cells along and `y` metres up.
pub(super) fn masonry_uv(s: f64, y: f64) -> Vec2 {
    DVec2::new(s * CELL / MASONRY_TILE, -y / MASONRY_TILE).as_vec2()
}

/// Whether a column or pier stands on the cell around `(x, z)`, in cells from the centre.
pub(super) fn is_built_on(x: f64, z: f64) -> bool {
    Side::ALL[..2].iter().any(|side| {
        let (s, d) = if side.is_long() { (x, z) } else { (z, x) };
        let d = d.abs() - side.line;
        let to_column = (s + side.half).rem_euclid(BAY);
        let at_column = d.abs() < 1.0 && s.abs() < side.half + 1.0 && to_column.min(BAY - to_column) < 1.0;
        at_column || (d > depth::PIER && !side.is_recessed(s))
    })
}
