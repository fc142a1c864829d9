//! How far one gets along the surface from a node before something stands in the way.

use super::scatter::SurfaceSample;
use glam::{Vec2, Vec3};
use lumel_sample::Frame;

/// Directions in which a node looks around.
pub const DIRECTIONS: usize = 16;

/// Places that are nearer to what stands in the way than this share of the reach still lie before it: those where a wall stands on a floor,
/// as the corners of a room.
const FOOT: f32 = 1e-3;

/// Lines that a direction meets at a smaller cosine are taken for lines across it.
const GRAZING: f32 = 0.02;

/// What stands on the surfaces of a scene.
///
/// This crate traces no rays: whoever has a ray tracer looks.
pub trait Obstacles: Sync {
    /// What stands in the way of a walk over the surface from a place, if anything does within `reach`, metres.
    ///
    /// `toward` has length 1 and is tangent to the surface. What is lower than `lift` metres is stepped over.
    fn first(&self, from: &SurfaceSample, toward: Vec3, lift: f32, reach: f32) -> Option<Obstacle>;
}

/// Something that stands on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// How far one gets, metres.
    pub distance: f32,
    /// Of its surface there.
    pub normal: Vec3,
}

/// No obstacles at all.
pub(crate) struct Open;

impl Obstacles for Open {
    fn first(&self, _: &SurfaceSample, _: Vec3, _: f32, _: f32) -> Option<Obstacle> {
        None
    }
}

/// What a node overlooks in its tangent plane: the lines along which something stands there, in [`DIRECTIONS`] directions.
///
/// Exact for straight walls and their corners: between two directions lie the walls of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Of each direction the line `v·x = 1`, in the tangent and bitangent of [`Frame::from_normal`], m⁻¹; zero where nothing stands.
    /// The directions are spread evenly in the norm |x| + |y|.
    pub lines: [Vec2; DIRECTIONS],
    /// A bit for each direction: the corner between its line and the next one points towards the node, so that what is not behind both
    /// lines is overlooked.
    pub outer: u16,
}

impl Clearance {
    /// Looks around from a place; `None` if nothing is in the way within `reach`, metres.
    pub(crate) fn around(
        from: &SurfaceSample,
        lift: f32,
        reach: f32,
        obstacles: &dyn Obstacles,
    ) -> Option<Self> {
        let frame = Frame::from_normal(from.normal);
        let seen: [Option<(Vec2, Vec2)>; DIRECTIONS] = std::array::from_fn(|k| {
            let ahead = direction(k).normalize_or_zero();
            let toward = frame.tangent * ahead.x + frame.bitangent * ahead.y;
            let Obstacle { distance, normal } = obstacles.first(from, toward, lift, reach)?;
            let place = ahead * distance;
            // Of things without a direction in the plane, the side that is seen.
            let across = Vec2::new(frame.tangent.dot(normal), frame.bitangent.dot(normal)).try_normalize();
            let across = across.filter(|across| across.dot(ahead).abs() > GRAZING).unwrap_or(ahead);
            let apart = across.dot(place);
            Some((place, across / (apart + (FOOT * reach).copysign(apart))))
        });
        if seen.iter().all(Option::is_none) {
            return None;
        }
        let is_outer = |k: &usize| match (seen[*k], seen[(k + 1) % DIRECTIONS]) {
            (Some((here, line)), Some((there, other))) => other.dot(here) > 1.0 && line.dot(there) > 1.0,
            _ => false,
        };
        let outer = (0..DIRECTIONS).filter(is_outer).fold(0, |bits, k| bits | 1 << k);
        Some(Self { lines: seen.map(|seen| seen.map_or(Vec2::ZERO, |(_, line)| line)), outer })
    }

    /// How far behind what stands in the way a place is, at `offset` from the node that has this normal: it is hidden above 1.
    #[inline]
    pub(crate) fn behind(&self, normal: Vec3, offset: Vec3) -> f32 {
        let frame = Frame::from_normal(normal);
        let at = Vec2::new(frame.tangent.dot(offset), frame.bitangent.dot(offset));
        let length = at.x.abs() + at.y.abs();
        if length == 0.0 {
            return 0.0;
        }
        // In the norm |x| + |y|, a quarter of the way round is linear: no angle has to be found.
        let share = at.y / length;
        let turn = match (at.x >= 0.0, at.y >= 0.0) {
            (true, true) => share,
            (true, false) => 4.0 + share,
            (false, _) => 2.0 - share,
        };
        let k = (turn * (DIRECTIONS / 4) as f32) as usize % DIRECTIONS;
        let [a, b] = [k, (k + 1) % DIRECTIONS].map(|k| self.lines[k].dot(at));
        if self.outer >> k & 1 == 1 { a.min(b) } else { a.max(b) }
    }
}

/// A direction in the tangent plane, of length 1 in the norm |x| + |y|.
fn direction(k: usize) -> Vec2 {
    let turn = k as f32 / (DIRECTIONS / 4) as f32;
    let swing = |turn: f32| (turn.rem_euclid(4.0) - 2.0).abs() - 1.0;
    Vec2::new(swing(turn), swing(turn - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::{Barycentrics, SurfacePoint, TriId};

    /// Walls in a plane, each between two points.
    struct Walls(Vec<[Vec2; 2]>);

    fn flat(p: Vec3) -> Vec2 {
        Vec2::new(p.x, p.z)
    }

    impl Walls {
        /// Where the way from one point to another is cut, as a share of it, and the direction of the wall.
        fn cut(&self, from: Vec2, to: Vec2) -> Option<(f32, Vec2)> {
            let way = to - from;
            let cut = |[a, b]: &[Vec2; 2]| {
                let along = *b - *a;
                let [t, u] = [along, way].map(|of| (*a - from).perp_dot(of) / way.perp_dot(along));
                ((0.0..1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some((t, along))
            };
            self.0.iter().filter_map(cut).min_by(|a, b| a.0.total_cmp(&b.0))
        }
    }

    impl Obstacles for Walls {
        fn first(&self, from: &SurfaceSample, toward: Vec3, _: f32, reach: f32) -> Option<Obstacle> {
            let (t, along) = self.cut(flat(from.position), flat(from.position + reach * toward))?;
            Some(Obstacle { distance: t * reach, normal: Vec3::new(-along.y, 0.0, along.x) })
        }
    }

    fn from() -> SurfaceSample {
        let at = SurfacePoint { tri: TriId(0), bary: Barycentrics { u: 0.3, v: 0.3 } };
        SurfaceSample { at, position: Vec3::new(0.1, 5.0, -0.2), normal: Vec3::Y }
    }

    /// The shares of the places around that are hidden, and of those that are found hidden wrongly, and wrongly not.
    fn shares(walls: Vec<[Vec2; 2]>) -> [f32; 3] {
        let (from, walls) = (from(), Walls(walls));
        let clearance = Clearance::around(&from, 0.0, 1.0, &walls).unwrap();
        let mut shares = [0.0; 3];
        for i in 0..4000 {
            let (angle, radius) = (i as f32 * 2.399_963, (i as f32 / 4000.0).sqrt());
            let place = from.position + radius * Vec3::new(angle.cos(), 0.0, angle.sin());
            let is_hidden = walls.cut(flat(from.position), flat(place)).is_some();
            let found = clearance.behind(from.normal, place - from.position) > 1.0;
            for (share, counts) in
                shares.iter_mut().zip([is_hidden, found && !is_hidden, is_hidden && !found])
            {
                *share += f32::from(u8::from(counts)) / 4000.0;
            }
        }
        shares
    }

    #[test]
    fn what_lies_behind_straight_walls_is_hidden() {
        let long = |x: f32| [Vec2::new(x, -9.0), Vec2::new(x, 9.0)];
        let deep = |z: f32| [Vec2::new(-9.0, z), Vec2::new(9.0, z)];
        let box_corner =
            |x: f32, z: f32| [[Vec2::new(x, z), Vec2::new(x, 9.0)], [Vec2::new(x, z), Vec2::new(9.0, z)]];
        for (what, walls, wrongly) in [
            ("a wall", vec![long(0.4)], 0.002),
            ("another one", vec![long(-0.05)], 0.002),
            ("a corridor", vec![long(0.4), long(0.0)], 0.002),
            ("the corner of a room", vec![long(0.5), deep(0.1)], 0.002),
            // The sector at its end is hidden whole.
            ("a wall that ends", vec![[Vec2::new(0.4, -9.0), Vec2::new(0.4, 0.0)]], 0.04),
            ("the corner of a box", box_corner(0.4, 0.0).to_vec(), 0.04),
        ] {
            let [hidden, too_much, too_little] = shares(walls);
            assert!((0.05..0.9).contains(&hidden), "{what}: {hidden}");
            assert!(too_much <= wrongly && too_little < 0.003, "{what}: {too_much} {too_little} of {hidden}");
        }
    }

    #[test]
    fn where_nothing_stands_nothing_is_kept() {
        let wall = |x: f32| Walls(vec![[Vec2::new(x, -9.0), Vec2::new(x, 9.0)]]);
        assert_eq!(Clearance::around(&from(), 0.1, 2.0, &Open), None);
        assert_eq!(Clearance::around(&from(), 0.1, 2.0, &wall(2.5)), None);
        assert!(Clearance::around(&from(), 0.1, 2.0, &wall(1.5)).is_some());
    }
}
