//! What a picture shows where light is not measured yet.

use glam::Vec3;
use lumel_scene::Scene;

/// Which vertices of a scene are connected by an edge.
///
/// Vertices in one place count as one, so that light spreads across the seams of texture coordinates too.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// The representative of each vertex among those in one place with one normal.
    first: Vec<u32>,
    /// Where the neighbours of a representative begin in `list`.
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl Neighbours {
    /// The neighbours of all vertices.
    pub fn new(scene: &Scene) -> Self {
        let first = representatives(scene);
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(6 * scene.triangle_count());
        for triangle in scene.triangles() {
            let [a, b, c] = triangle.map(|v| first[v as usize]);
            edges.extend([[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        }
        edges.sort_unstable();
        edges.dedup();
        let mut starts = vec![0; scene.vertex_count() + 1];
        for [from, _] in &edges {
            starts[*from as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        Self { first, starts, list: edges.into_iter().map(|[_, to]| to).collect() }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let range = self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize;
        &self.list[range]
    }

    /// Gives vertices that are not measured the mean of their measured neighbours, ring by ring.
    ///
    /// For looking at only: a guess that the measurement replaces. Each vertex is visited once, however many rings
    /// there are. What no measured vertex is connected to stays as it is.
    pub fn spread(&self, values: &mut [Vec3], measured: &[bool]) {
        let mut known = vec![false; values.len()];
        for (vertex, &first) in self.first.iter().enumerate() {
            if measured[vertex] {
                known[first as usize] = true;
                values[first as usize] = values[vertex];
            }
        }
        let mut ring: Vec<u32> = (0..values.len() as u32).filter(|&v| known[v as usize]).collect();
        let mut queued = known.clone();
        while !ring.is_empty() {
            let mut next: Vec<u32> = Vec::new();
            for &vertex in &ring {
                next.extend(
                    self.of(vertex).iter().filter(|&&n| !std::mem::replace(&mut queued[n as usize], true)),
                );
            }
            // All of a ring from the rings before it: the order within a ring does not matter.
            let means: Vec<Vec3> = next.iter().map(|&v| self.mean_of_known(v, values, &known)).collect();
            for (&vertex, mean) in next.iter().zip(means) {
                values[vertex as usize] = mean;
            }
            next.iter().for_each(|&v| known[v as usize] = true);
            ring = next;
        }
        for vertex in 0..values.len() {
            if known[self.first[vertex] as usize] {
                values[vertex] = values[self.first[vertex] as usize];
            }
        }
    }

    fn mean_of_known(&self, vertex: u32, values: &[Vec3], known: &[bool]) -> Vec3 {
        let (mut sum, mut n) = (Vec3::ZERO, 0.0);
        for &neighbour in self.of(vertex).iter().filter(|&&n| known[n as usize]) {
            sum += values[neighbour as usize];
            n += 1.0;
        }
        if n > 0.0 { sum / n } else { sum }
    }
}

/// The first vertex in the place of each, with the same normal.
fn representatives(scene: &Scene) -> Vec<u32> {
    let key = |v: u32| {
        let [position, normal] = [scene.positions()[v as usize], scene.normals()[v as usize]];
        // Adding zero turns -0 into 0.
        [position + Vec3::ZERO, normal + Vec3::ZERO].map(|p| p.to_array().map(f32::to_bits))
    };
    let mut order: Vec<u32> = (0..scene.vertex_count() as u32).collect();
    order.sort_by_cached_key(|&v| key(v));
    let mut first = vec![0; order.len()];
    let mut current = 0;
    for (i, &vertex) in order.iter().enumerate() {
        if i == 0 || key(vertex) != key(current) {
            current = vertex;
        }
        first[vertex as usize] = current;
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel::OpenOptions;

    fn cornell() -> Scene {
        lumel::open("cornell-box", &OpenOptions::default()).unwrap().builder.build().unwrap().0
    }

    #[test]
    fn even_light_spreads_evenly_over_each_surface_it_has_reached() {
        let scene = cornell();
        let neighbours = Neighbours::new(&scene);
        let mut values = vec![Vec3::ZERO; scene.vertex_count()];
        // Every 50th vertex is measured.
        let measured: Vec<bool> = (0..values.len()).map(|v| v % 50 == 0).collect();
        for v in (0..values.len()).step_by(50) {
            values[v] = Vec3::splat(2.0);
        }
        neighbours.spread(&mut values, &measured);
        let lit = values.iter().filter(|v| **v == Vec3::splat(2.0)).count();
        assert_eq!(lit, values.len(), "Cornell's surfaces each have a measured vertex");
    }

    #[test]
    fn measured_values_stay_and_guesses_lie_between_them() {
        let scene = cornell();
        let neighbours = Neighbours::new(&scene);
        let measured: Vec<bool> = (0..scene.vertex_count()).map(|v| v % 7 == 3).collect();
        let truth: Vec<Vec3> = scene.positions().iter().map(|p| Vec3::splat(1.0 + p.y)).collect();
        let mut values: Vec<Vec3> =
            truth.iter().zip(&measured).map(|(v, m)| if *m { *v } else { Vec3::ZERO }).collect();
        neighbours.spread(&mut values, &measured);
        let (lo, hi) = (1.0 + scene.bounds().min.y, 1.0 + scene.bounds().max.y);
        for (vertex, value) in values.iter().enumerate() {
            assert!((lo - 1e-5..=hi + 1e-5).contains(&value.x), "{vertex}: {value}");
            if measured[vertex] {
                assert_eq!(*value, truth[vertex]);
            }
        }
        let rms: f32 = (values.iter().zip(&truth).map(|(a, b)| (a.x - b.x).powi(2)).sum::<f32>()
            / values.len() as f32)
            .sqrt();
        assert!(rms < 0.02, "{rms}");
    }

    #[test]
    fn what_nothing_reaches_stays_dark() {
        let scene = cornell();
        let mut values = vec![Vec3::ZERO; scene.vertex_count()];
        Neighbours::new(&scene).spread(&mut values, &vec![false; scene.vertex_count()]);
        assert!(values.iter().all(|v| *v == Vec3::ZERO));
    }
}
