//! Equal light on both sides of what an atlas cuts.

use crate::Dilation;
use crate::edges::{Seam, seams};
use crate::taps::taps;
use glam::{DVec3, Vec3};
use lumel_scene::Scene;
use lumel_uv::Atlas;
use rayon::prelude::*;

/// Places per lumel of a seam's length at which both sides are compared.
const PLACES_PER_LUMEL: f64 = 5.0;

/// How much a change of a lumel weighs against a jump at one place.
const KEEP: f64 = 0.1;

/// The part of the first residual at which the solver stops: less than what an `f32` rounds.
const SOLVED: f64 = 1e-8;

/// Steps that the solver may take; 10 to 80 are usual.
const MOST_STEPS: usize = 200;

/// The seams of an atlas: smooth edges whose two triangles have different places in it.
///
/// Reading bilinearly gives two values along a seam. Their squared difference is made small, against the squared change of
/// the lumels: least squares, solved by conjugate gradients. It is linear in the light, so that layers still add up to their
/// sum where no light would become negative. After Iwanicki, *Lighting Technology of The Last of Us*, SIGGRAPH 2013.
#[derive(Clone, Debug)]
pub struct Seams {
    /// Seams that share no lumels are in different groups.
    groups: Vec<Group>,
    /// Of all rows.
    weight: f64,
}

/// The equations of seams that share lumels.
#[derive(Clone, Debug, Default)]
struct Group {
    lumels: Vec<u32>,
    /// The end of each row in `terms`.
    ends: Vec<u32>,
    /// The difference of the two sides at a place: lumels, as places in `lumels`, and factors.
    terms: Vec<(u32, f64)>,
}

/// The difference of the two sides at a place.
struct Row {
    terms: Vec<(u32, f64)>,
    weight: f64,
}

impl Seams {
    /// The seams of a scene in its atlas. Only lumels that are valid for `dilation` change; what is read at others is
    /// theirs.
    pub fn new(scene: &Scene, atlas: &Atlas, dilation: &Dilation) -> Self {
        let rows: Vec<Row> =
            seams(scene, atlas).iter().flat_map(|seam| rows(atlas, dilation, seam)).collect();
        let weight = rows.iter().map(|row| row.weight).sum();
        Self { groups: grouped(rows), weight }
    }

    /// The lumels that are read along seams.
    pub fn lumels(&self) -> impl Iterator<Item = u32> {
        self.groups.iter().flat_map(|group| group.lumels.iter().copied())
    }

    /// Whether nothing is cut.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// The root of the mean square of the jumps in light along all seams, over all channels, W·m⁻².
    pub fn jump(&self, values: &[Vec3]) -> f64 {
        let square = |group: &Group| -> f64 {
            let read = |lumel: u32| values[group.lumels[lumel as usize] as usize].as_dvec3();
            group.rows().map(|terms| difference(terms, read).length_squared()).sum()
        };
        let sum: f64 = self.groups.iter().map(square).sum();
        if self.weight > 0.0 { (sum / (3.0 * self.weight)).sqrt() } else { 0.0 }
    }

    /// Makes the jumps small. No value is brought below `least`, which is zero for light.
    pub fn close(&self, values: &mut [Vec3], least: Vec3) {
        let changes: Vec<Vec<DVec3>> = self.groups.par_iter().map(|group| group.change(values)).collect();
        for (group, changes) in self.groups.iter().zip(changes) {
            for (&lumel, change) in group.lumels.iter().zip(changes) {
                let value = &mut values[lumel as usize];
                *value = (value.as_dvec3() + change).as_vec3().max(value.min(least));
            }
        }
    }
}

/// The comparisons along a seam. Those that would need light of another chart are left out.
fn rows(atlas: &Atlas, dilation: &Dilation, seam: &Seam) -> Vec<Row> {
    let length = seam.sides[0].length().max(seam.sides[1].length());
    let steps = (PLACES_PER_LUMEL * length).ceil().max(1.0);
    // Short seams do not weigh more for being compared at both ends.
    let weight = PLACES_PER_LUMEL * length / (steps + 1.0);
    let row = |step: u32| {
        let mut terms: Vec<(u32, f64)> = Vec::with_capacity(8);
        for (side, sign) in seam.sides.iter().zip([1.0, -1.0]) {
            let place = side.ends[0].lerp(side.ends[1], f64::from(step) / steps);
            let read =
                taps(atlas, atlas.page(side.tri), place).into_iter().filter(|(_, weight)| *weight > 0.0);
            for (lumel, factor) in read {
                let source = dilation.source(lumel, atlas.chart(side.tri))?;
                let factor = sign * factor * weight.sqrt();
                match terms.iter_mut().find(|(lumel, _)| *lumel == source) {
                    Some((_, sum)) => *sum += factor,
                    None => terms.push((source, factor)),
                }
            }
        }
        Some(Row { terms, weight })
    };
    (0..=steps as u32).filter_map(row).collect()
}

/// Sorts comparisons into groups that share no lumels.
fn grouped(rows: Vec<Row>) -> Vec<Group> {
    let mut lumels: Vec<u32> =
        rows.iter().flat_map(|row| row.terms.iter().map(|(lumel, _)| *lumel)).collect();
    lumels.sort_unstable();
    lumels.dedup();
    let place = |lumel: u32| lumels.partition_point(|&other| other < lumel);
    // A forest: the root of each tree is its smallest member.
    let mut parents: Vec<usize> = (0..lumels.len()).collect();
    let root = |parents: &mut Vec<usize>, mut at: usize| {
        while parents[at] != at {
            parents[at] = parents[parents[at]];
            at = parents[at];
        }
        at
    };
    for row in &rows {
        for pair in row.terms.windows(2) {
            let [a, b] = [pair[0].0, pair[1].0].map(|lumel| root(&mut parents, place(lumel)));
            parents[a.max(b)] = a.min(b);
        }
    }
    let mut groups: Vec<Group> = Vec::new();
    // For each lumel, its group and its place there.
    let mut members: Vec<(usize, u32)> = Vec::with_capacity(lumels.len());
    for (at, &lumel) in lumels.iter().enumerate() {
        let root = root(&mut parents, at);
        let group = members.get(root).map_or(groups.len(), |(group, _)| *group);
        if group == groups.len() {
            groups.push(Group::default());
        }
        members.push((group, groups[group].lumels.len() as u32));
        groups[group].lumels.push(lumel);
    }
    for row in rows {
        let Some(&(lumel, _)) = row.terms.first() else { continue };
        let group = &mut groups[members[place(lumel)].0];
        group.terms.extend(row.terms.iter().map(|&(lumel, factor)| (members[place(lumel)].1, factor)));
        group.ends.push(group.terms.len() as u32);
    }
    groups
}

impl Group {
    fn rows(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        begins.zip(&self.ends).map(|(begin, &end)| &self.terms[begin as usize..end as usize])
    }

    /// The change that minimises the jumps: of `(SᵀS + λ) change = −SᵀS values` with a row of S for each comparison.
    fn change(&self, values: &[Vec3]) -> Vec<DVec3> {
        let n = self.lumels.len();
        let before: Vec<DVec3> = self.lumels.iter().map(|&lumel| values[lumel as usize].as_dvec3()).collect();
        let mut residual = vec![DVec3::ZERO; n];
        self.add_squared(&before, &mut residual);
        residual.iter_mut().for_each(|r| *r = -*r);
        let mut change = vec![DVec3::ZERO; n];
        let mut direction = residual.clone();
        let mut applied = vec![DVec3::ZERO; n];
        let mut left = dot(&residual, &residual);
        let enough = left * (SOLVED * SOLVED);
        for _ in 0..MOST_STEPS {
            if left.cmple(enough).all() {
                break;
            }
            applied.iter_mut().zip(&direction).for_each(|(a, &d)| *a = d * KEEP);
            self.add_squared(&direction, &mut applied);
            let step = ratio(left, dot(&direction, &applied));
            for i in 0..n {
                change[i] += direction[i] * step;
                residual[i] -= applied[i] * step;
            }
            let before = std::mem::replace(&mut left, dot(&residual, &residual));
            let turn = ratio(left, before);
            direction.iter_mut().zip(&residual).for_each(|(d, &r)| *d = r + *d * turn);
        }
        change
    }

    /// Adds `SᵀS x`.
    fn add_squared(&self, x: &[DVec3], out: &mut [DVec3]) {
        for terms in self.rows() {
            let difference = difference(terms, |lumel| x[lumel as usize]);
            terms.iter().for_each(|&(lumel, factor)| out[lumel as usize] += difference * factor);
        }
    }
}

fn difference(terms: &[(u32, f64)], read: impl Fn(u32) -> DVec3) -> DVec3 {
    terms.iter().map(|&(lumel, factor)| read(lumel) * factor).sum()
}

/// By channel.
fn dot(a: &[DVec3], b: &[DVec3]) -> DVec3 {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

/// By channel; 0 where there is nothing to divide.
fn ratio(part: DVec3, whole: DVec3) -> DVec3 {
    DVec3::select(whole.cmpgt(DVec3::ZERO), part / whole, DVec3::ZERO)
}
