//! What can be seen of a refinement while it is under way.

use super::{Refiner, edges};
use crate::adaptive::criterion::Criterion;
use glam::Vec3;

impl Refiner {
    /// Light at all vertices, W·m⁻²: as it was measured last, or spread from there.
    pub(crate) fn irradiance(&self) -> Vec<Vec3> {
        let direct = || self.vertices.iter().map(|probe| probe.map(|probe| probe.irradiance)).collect();
        let mut light = if self.light.is_empty() { direct() } else { self.light.clone() };
        light.resize(self.mesh.vertex_count(), None);
        self.spread(&mut light);
        // The ends of an edge come before its middle.
        let given = self.mesh.scene().vertex_count();
        for (&[a, b], vertex) in self.mesh.splits().iter().zip(given..) {
            let ends = light[a as usize].zip(light[b as usize]);
            light[vertex] = light[vertex].or(ends.map(|(a, b)| 0.5 * (a + b)));
        }
        let known = || light.iter().flatten();
        let mean = known().sum::<Vec3>() / (known().count().max(1) as f32);
        light.into_iter().map(|light| light.unwrap_or(mean)).collect()
    }

    /// Gives vertices that have no light the mean of those that they share edges with, and so on.
    fn spread(&self, light: &mut [Option<Vec3>]) {
        loop {
            let mut sums = vec![(Vec3::ZERO, 0.0_f32); light.len()];
            for [a, b] in self.mesh.parts().flat_map(edges) {
                for (to, from) in [(a, b), (b, a)].map(|(to, from)| (to as usize, from as usize)) {
                    if let (None, Some(known)) = (light[to], light[from]) {
                        sums[to].0 += known;
                        sums[to].1 += 1.0;
                    }
                }
            }
            let found = light.iter_mut().zip(sums).filter(|(_, (_, n))| *n > 0.0);
            if found.map(|(light, (sum, n))| *light = Some(sum / n)).count() == 0 {
                return;
            }
        }
    }

    /// By how much light differs from a linear function at the edges around each vertex, over what it may, at most: edges with
    /// more than 1 are split, where they are long enough. 0 where no edge was looked at.
    pub(crate) fn indicator(&self) -> Vec<f32> {
        let mut of_vertices = vec![0.0_f32; self.mesh.vertex_count()];
        let mut note = |ends: [u32; 2], excess: f64| {
            for end in ends {
                let of_vertex = &mut of_vertices[end as usize];
                *of_vertex = of_vertex.max(excess as f32);
            }
        };
        let criterion = Criterion { error: self.error, floor: self.floor.unwrap_or_default() };
        self.for_each_edge(&criterion, |ends, excess, is_split| {
            note(ends, if is_split { excess.max(1.0) } else { excess });
        });
        for ends in self.mesh.parts().flat_map(edges) {
            self.bent.get(&ends).into_iter().for_each(|&excess| note(ends, excess));
        }
        of_vertices
    }
}
