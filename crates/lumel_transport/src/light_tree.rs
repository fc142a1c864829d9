//! A hierarchy of lights, to choose one by how much it may send to a receiver.
//!
//! Conty Estevez and Kulla, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, 2018.

use crate::light_cone::Cone;
use glam::DVec3;

/// Places along an axis where a set of lights may be split.
const BUCKETS: usize = 12;

/// Slack for bounds by cosines: a sine from its cosine is off by up to 1e-8 where it is small. Far less than matters for
/// the choice.
const SLACK: f64 = 1e-7;

/// What the tree knows of a light, or of many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    min: DVec3,
    max: DVec3,
    normals: Cone,
    power: f64,
}

impl Extent {
    /// A flat light with corners counter-clockwise seen from its lit side; `None` if it has no area or no power.
    pub(crate) fn flat(corners: &[DVec3], power: f64) -> Option<Self> {
        let [a, b, .., c] = corners else { return None };
        let axis = (*b - *a).cross(*c - *a).try_normalize()?;
        let min = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let sound = power > 0.0 && power.is_finite() && min.is_finite() && max.is_finite();
        sound.then_some(Self { min, max, normals: Cone { axis, spread: 0.0 }, power })
    }

    /// A disk whose lit side has this normal; `None` as for [`flat`](Self::flat).
    pub(crate) fn disk(center: DVec3, normal: DVec3, radius: f32, power: f64) -> Option<Self> {
        let (u, v) = normal.any_orthonormal_pair();
        let [u, v] = [u, v].map(|axis| axis * f64::from(radius));
        Self::flat(&[center - u - v, center + u - v, center + u + v, center - u + v], power)
    }

    /// A sphere that shines outwards; `None` if it has no area or no power.
    pub(crate) fn sphere(center: DVec3, radius: f32, power: f64) -> Option<Self> {
        let corner = DVec3::splat(f64::from(radius));
        let sound = power > 0.0 && power.is_finite() && radius > 0.0;
        let normals = Cone::all();
        sound.then_some(Self { min: center - corner, max: center + corner, normals, power })
    }

    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            normals: self.normals.union(other.normals),
            power: self.power + other.power,
        }
    }

    fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}

/// An extent, ready to be asked for its importance.
#[derive(Clone, Debug)]
struct Bound {
    center: DVec3,
    radius: f64,
    axis: DVec3,
    /// Cosine and sine of the spread of normals.
    spread: [f64; 2],
    power: f64,
}

impl Bound {
    fn new(extent: &Extent) -> Self {
        let (sin, cos) = extent.normals.spread.sin_cos();
        let radius = 0.5 * (extent.max - extent.min).length();
        let Extent { normals: Cone { axis, .. }, power, .. } = *extent;
        Self { center: extent.center(), radius, axis, spread: [cos, sin], power }
    }

    /// What the lights may send to a receiver, up to a common factor; zero only if none of them can send anything.
    ///
    /// The distance is never taken for less than the radius: closer than that, the bounds say nothing about it.
    fn importance(&self, point: DVec3, normal: DVec3) -> f64 {
        let away = self.center - point;
        let squared = away.length_squared();
        let distance = squared.sqrt();
        // Seen from within their bounds, lights may lie anywhere.
        if distance <= self.radius * (1.0 + SLACK) {
            return self.power / squared.max(self.radius * self.radius);
        }
        let sin = self.radius / distance;
        let subtended = [(1.0 - sin * sin).max(0.0).sqrt(), sin];
        let off_light = less(cos_sin(-self.axis.dot(away) / distance), self.spread);
        let cos_light = less(off_light, subtended)[0] + SLACK;
        let cos_receiver = less(cos_sin(normal.dot(away) / distance), subtended)[0] + SLACK;
        self.power * cos_light.max(0.0) * cos_receiver.max(0.0) / squared
    }
}

fn cos_sin(cos: f64) -> [f64; 2] {
    [cos, (1.0 - cos * cos).max(0.0).sqrt()]
}

/// Cosine and sine of the difference of two angles up to π, or of zero if that is negative.
fn less([cos_a, sin_a]: [f64; 2], [cos_b, sin_b]: [f64; 2]) -> [f64; 2] {
    if cos_a >= cos_b {
        return [1.0, 0.0];
    }
    [cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b]
}

/// A binary tree over lights.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    /// The root first; the first child of a node follows it.
    nodes: Vec<Node>,
    /// The node of each light, by number; `None` for those that are not in the tree.
    leaves: Vec<Option<usize>>,
}

#[derive(Clone, Debug)]
struct Node {
    bound: Bound,
    /// The root is its own.
    parent: usize,
    below: Below,
}

#[derive(Clone, Copy, Debug)]
enum Below {
    Light(usize),
    /// The first child is the next node.
    Pair {
        second: usize,
    },
}

/// One light out of many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Which.
    pub(crate) light: usize,
    /// What is left of the random number: uniform again, with fewer bits.
    pub(crate) rest: f32,
    /// How likely it was.
    pub(crate) probability: f64,
}

impl LightTree {
    /// The tree of lights by number; `None` without any.
    pub(crate) fn new(lights: Vec<(usize, Extent)>) -> Option<Self> {
        let n = lights.iter().map(|(light, _)| light + 1).max()?;
        let mut tree = Self { nodes: Vec::with_capacity(2 * lights.len()), leaves: vec![None; n] };
        let mut lights = lights;
        tree.add(&mut lights, 0);
        Some(tree)
    }

    /// Chooses a light for a receiver by a number in `[0, 1)`; `None` if none can reach it.
    ///
    /// The probability is positive for all lights that would send anything if nothing were in the way.
    pub(crate) fn choose(&self, point: DVec3, normal: DVec3, u: f32) -> Option<Choice> {
        if self.nodes[0].bound.importance(point, normal) <= 0.0 {
            return None;
        }
        let (mut at, mut rest, mut probability) = (0, f64::from(u), 1.0);
        loop {
            match self.nodes[at].below {
                Below::Light(light) => {
                    let rest = (rest as f32).clamp(0.0, 1.0 - f32::EPSILON);
                    return Some(Choice { light, rest, probability });
                }
                Below::Pair { second } => {
                    let first = self.share_of_first(at + 1, second, point, normal);
                    // Below one in spite of rounding: a share of zero is never taken, one of all never missed.
                    rest = f64::min(rest, 1.0 - f64::EPSILON);
                    if rest < first {
                        (at, rest, probability) = (at + 1, rest / first, probability * first);
                    } else {
                        let other = 1.0 - first;
                        (at, rest, probability) = (second, (rest - first) / other, probability * other);
                    }
                }
            }
        }
    }

    /// How likely it is that a receiver [chooses](Self::choose) a light.
    pub(crate) fn probability(&self, light: usize, point: DVec3, normal: DVec3) -> f64 {
        let Some(mut at) = self.leaves.get(light).copied().flatten() else { return 0.0 };
        if self.nodes[0].bound.importance(point, normal) <= 0.0 {
            return 0.0;
        }
        let mut probability = 1.0;
        while at > 0 {
            let parent = self.nodes[at].parent;
            if let Below::Pair { second } = self.nodes[parent].below {
                let first = self.share_of_first(parent + 1, second, point, normal);
                probability *= if at == second { 1.0 - first } else { first };
            }
            at = parent;
        }
        probability
    }

    /// The probability of the first of two siblings.
    ///
    /// Where their parent's loose bounds promised what neither can hold, power decides: the contribution is zero, and
    /// probabilities still sum to one.
    fn share_of_first(&self, first: usize, second: usize, point: DVec3, normal: DVec3) -> f64 {
        let [a, b] = [first, second].map(|node| &self.nodes[node].bound);
        let (i, j) = (a.importance(point, normal), b.importance(point, normal));
        let share = if i + j > 0.0 { i / (i + j) } else { a.power / (a.power + b.power) };
        // Rounding must leave no light that can shine without a chance.
        if i > 0.0 && j > 0.0 { share.clamp(f64::EPSILON, 1.0 - f64::EPSILON) } else { share }
    }

    fn add(&mut self, lights: &mut [(usize, Extent)], parent: usize) {
        let Some(extent) = lights.iter().map(|(_, extent)| *extent).reduce(Extent::union) else { return };
        let at = self.nodes.len();
        if let [(light, _)] = *lights {
            self.leaves[light] = Some(at);
            self.nodes.push(Node { bound: Bound::new(&extent), parent, below: Below::Light(light) });
            return;
        }
        self.nodes.push(Node { bound: Bound::new(&extent), parent, below: Below::Pair { second: 0 } });
        let middle = split(lights, &extent);
        let (left, right) = lights.split_at_mut(middle);
        self.add(left, at);
        self.nodes[at].below = Below::Pair { second: self.nodes.len() };
        self.add(right, at);
    }
}

/// Sorts lights into two sets of least cost: the size of the first.
fn split(lights: &mut [(usize, Extent)], whole: &Extent) -> usize {
    let centers = |axis: usize| lights.iter().map(move |(_, e)| e.center()[axis]);
    let sides = whole.max - whole.min;
    let mut best: Option<(f64, usize, f64, f64, usize)> = None;
    for axis in 0..3 {
        let low = centers(axis).fold(f64::INFINITY, f64::min);
        let width = centers(axis).fold(f64::NEG_INFINITY, f64::max) - low;
        if width <= 0.0 {
            continue;
        }
        let mut buckets: [Option<Extent>; BUCKETS] = [None; BUCKETS];
        for (_, extent) in lights.iter() {
            join(&mut buckets[bucket(extent, axis, low, width)], *extent);
        }
        // Long thin boxes had better be cut across.
        let regularity = sides.max_element() / sides[axis];
        for last in 0..BUCKETS - 1 {
            let side = |range: &[Option<Extent>]| range.iter().flatten().copied().reduce(Extent::union);
            let (left, right) = buckets.split_at(last + 1);
            let (Some(left), Some(right)) = (side(left), side(right)) else { continue };
            let cost = regularity * (cost(&left) + cost(&right));
            if best.is_none_or(|best| cost < best.0) {
                best = Some((cost, axis, low, width, last));
            }
        }
    }
    // Lights with one centre for all have no order that would be better than theirs.
    let Some((_, axis, low, width, last)) = best else { return lights.len() / 2 };
    lights.sort_by_key(|(_, extent)| bucket(extent, axis, low, width) > last);
    lights.partition_point(|(_, extent)| bucket(extent, axis, low, width) <= last)
}

fn bucket(extent: &Extent, axis: usize, low: f64, width: f64) -> usize {
    (((extent.center()[axis] - low) / width * BUCKETS as f64) as usize).min(BUCKETS - 1)
}

fn join(all: &mut Option<Extent>, one: Extent) {
    *all = Some(all.map_or(one, |all| all.union(one)));
}

/// Power times the directions that it leaves into times the area that it leaves from.
fn cost(extent: &Extent) -> f64 {
    let size = extent.max - extent.min;
    let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    extent.power * extent.normals.lit_measure() * area
}

#[cfg(test)]
#[path = "light_tree_tests.rs"]
mod tests;
