//! Splitting edges until light is linear between vertices.

use super::criterion::{Criterion, LONGEST, PROBED, PROBED_WITHIN, Probe, SHORTEST};
use super::kinks;
use glam::Vec3;
use lumel_scene::{Bisection, Part, SurfacePoint, luminance};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Where large triangles are probed within: strata of them.
const WITHIN: [[f32; 3]; 4] = [[0.6, 0.25, 0.15], [0.15, 0.6, 0.25], [0.25, 0.15, 0.6], [0.3, 0.37, 0.33]];

/// How far probes at vertices and edges lie inside a triangle, as a share of the way to its middle: corners of a room lie in the
/// room.
const INSET: f32 = 1e-3;

/// Dark light is compared with this share of the mean over all surfaces.
pub(super) const FLOOR: f64 = 1.0;

/// Why no more edges are split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefinementEnd {
    /// Light is linear enough between all vertices, or edges are as short as they may be.
    Reached,
    /// More vertices are not allowed.
    Vertices,
}

/// A mesh whose edges are split where light is not linear.
pub(crate) struct Refiner {
    pub(crate) mesh: Bisection,
    max_vertices: usize,
    error: f64,
    floor: Option<f64>,
    /// What was measured at vertices.
    vertices: Vec<Option<Probe>>,
    /// And in the middle of edges between them.
    middles: HashMap<[u32; 2], Probe>,
    /// And within triangles.
    within: HashMap<[u32; 3], [Probe; 4]>,
    /// After bounces: light at vertices, as far as it is known, W·m⁻².
    light: Vec<Option<Vec3>>,
    /// And how urgently edges that were looked at are to be split.
    bent: HashMap<[u32; 2], f64>,
}

/// What became of edges that were to be split.
enum Split {
    All,
    /// None can be.
    Nothing,
    /// Not all, as there would be too many vertices.
    UpToLimit,
}

/// What is to be measured.
enum Target {
    Vertex(u32),
    Middle([u32; 2]),
    Within([u32; 3], usize),
}

impl Refiner {
    /// Splits edges of a mesh while light differs from a linear function by more than `error`, relative to itself.
    pub(crate) fn new(mesh: Bisection, error: f64, max_vertices: usize) -> Self {
        let (middles, within, bent) = (HashMap::new(), HashMap::new(), HashMap::new());
        let (vertices, light) = (Vec::new(), Vec::new());
        Self { mesh, max_vertices, error, floor: None, vertices, middles, within, light, bent }
    }

    /// Splits edges that are too long whatever the light.
    pub(crate) fn split_long(&mut self) -> RefinementEnd {
        loop {
            let lengths =
                self.mesh.parts().flat_map(edges).map(|ends| (ends, self.mesh.relative_length(ends)));
            let long: Vec<([u32; 2], f64)> = lengths.filter(|(_, length)| *length > LONGEST).collect();
            if long.is_empty() {
                return RefinementEnd::Reached;
            }
            match self.split_worst(long) {
                Split::All => {}
                Split::Nothing => return RefinementEnd::Reached,
                Split::UpToLimit => return RefinementEnd::Vertices,
            }
        }
    }

    /// Splits edges as long as the light that `probe` measures at points demands it.
    ///
    /// # Errors
    /// Those of `probe`.
    pub(crate) fn refine<E>(
        &mut self,
        mut probe: impl FnMut(&[SurfacePoint]) -> Result<Vec<Probe>, E>,
        watch: &mut dyn FnMut(&Self),
    ) -> Result<RefinementEnd, E> {
        if self.split_long() == RefinementEnd::Vertices {
            return Ok(RefinementEnd::Vertices);
        }
        loop {
            self.measure(&mut probe)?;
            let floor = self.floor.unwrap_or_else(|| {
                FLOOR * self.mean(|vertex| self.vertices[vertex as usize].map(|probe| probe.light))
            });
            self.floor = Some(floor);
            let marked = self.marked(&Criterion { error: self.error, floor });
            watch(self);
            if marked.is_empty() {
                return Ok(RefinementEnd::Reached);
            }
            match self.split_worst(marked) {
                Split::All => {}
                Split::Nothing => return Ok(RefinementEnd::Reached),
                Split::UpToLimit => return Ok(RefinementEnd::Vertices),
            }
        }
    }

    /// Splits edges where light at vertices bends by more than `error`, if it is found to do so where it is measured once more.
    ///
    /// `light` is that at the vertices of the mesh, W·m⁻², `probe` measures the same light.
    ///
    /// # Errors
    /// Those of `probe`.
    pub(crate) fn refine_after_bounce<E>(
        &mut self,
        error: f64,
        light: &[Vec3],
        mut probe: impl FnMut(&[SurfacePoint]) -> Result<Vec<Probe>, E>,
        watch: &mut dyn FnMut(&Self),
    ) -> Result<RefinementEnd, E> {
        self.light = light.iter().copied().map(Some).collect();
        let light: Vec<f64> = light.iter().map(|light| luminance(*light).into()).collect();
        let floor = FLOOR * self.mean(|vertex| Some(light[vertex as usize]));
        let criterion = Criterion { error, floor };
        watch(self);
        let mut doubtful = kinks::doubtful(&self.mesh, &light, &criterion);
        let mut vertices: HashMap<u32, Probe> = HashMap::new();
        while !doubtful.is_empty() {
            let middles = self.measure_edges(&doubtful, &mut vertices, &mut probe)?;
            let excess = |(ends, middle): (&[u32; 2], &Probe)| {
                let of_ends = ends.each_ref().map(|vertex| &vertices[vertex]);
                (*ends, criterion.excess(middle, of_ends, self.mesh.relative_length(*ends)))
            };
            let looked_at: Vec<([u32; 2], f64)> = doubtful.iter().zip(&middles).map(excess).collect();
            self.bent.extend(looked_at.iter().copied());
            let marked = looked_at.into_iter().filter(|(_, excess)| *excess > 1.0).collect();
            let (n_vertices, n_splits) = (self.mesh.vertex_count() as u32, self.mesh.splits().len());
            match self.split_worst(marked) {
                Split::All => {}
                Split::Nothing => break,
                Split::UpToLimit => return Ok(RefinementEnd::Vertices),
            }
            let measured: HashMap<[u32; 2], Probe> = doubtful.into_iter().zip(middles).collect();
            for (ends, vertex) in self.mesh.splits()[n_splits..].iter().zip(n_vertices..) {
                let measured = measured.get(ends);
                vertices.extend(measured.map(|probe| (vertex, *probe)));
                self.light.push(measured.map(|probe| probe.irradiance));
            }
            watch(self);
            // What has become of edges that were too long.
            let is_new =
                |ends: &[u32; 2]| ends[1] >= n_vertices && self.mesh.relative_length(*ends) > SHORTEST;
            let edges: BTreeSet<[u32; 2]> = self.mesh.parts().flat_map(edges).filter(is_new).collect();
            doubtful = edges.into_iter().collect();
        }
        Ok(RefinementEnd::Reached)
    }

    /// Measures light in the middle of edges, and at their ends where that is not known.
    fn measure_edges<E>(
        &self,
        wanted: &[[u32; 2]],
        vertices: &mut HashMap<u32, Probe>,
        probe: &mut impl FnMut(&[SurfacePoint]) -> Result<Vec<Probe>, E>,
    ) -> Result<Vec<Probe>, E> {
        let mut middles: HashMap<[u32; 2], Option<SurfacePoint>> =
            wanted.iter().map(|&ends| (ends, None)).collect();
        let mut ends_at: BTreeMap<u32, SurfacePoint> = BTreeMap::new();
        for part in self.mesh.parts() {
            for (k, ends) in edges(part).into_iter().enumerate() {
                let Some(middle @ None) = middles.get_mut(&ends) else { continue };
                *middle = Some(on_edge(part, k));
                for corner in [k, (k + 1) % 3]
                    .into_iter()
                    .filter(|&corner| !vertices.contains_key(&part.vertices[corner]))
                {
                    ends_at.entry(part.vertices[corner]).or_insert_with(|| at_corner(part, corner));
                }
            }
        }
        let mut points: Vec<SurfacePoint> = wanted.iter().filter_map(|ends| middles[ends]).collect();
        points.extend(ends_at.values());
        let mut measured = probe(&points)?;
        vertices.extend(ends_at.into_keys().zip(measured.split_off(wanted.len())));
        Ok(measured)
    }

    /// Splits edges, the most urgent first.
    fn split_worst(&mut self, mut marked: Vec<([u32; 2], f64)>) -> Split {
        let before = self.mesh.vertex_count();
        // The order of equals must not depend on how they were found.
        marked.sort_by(|(a, x), (b, y)| y.total_cmp(x).then(a.cmp(b)));
        let edges: Vec<[u32; 2]> = marked.into_iter().map(|(ends, _)| ends).collect();
        let (mut rest, mut portion) = (edges.as_slice(), edges.len());
        while portion > 0 && !rest.is_empty() {
            let (now, later) = rest.split_at(portion.min(rest.len()));
            if self.split(now.iter().copied()) {
                rest = later;
            } else {
                portion = now.len() / 2;
            }
        }
        match rest.is_empty() {
            false => Split::UpToLimit,
            // What is left is too short for a point between its ends.
            true if self.mesh.vertex_count() == before => Split::Nothing,
            true => Split::All,
        }
    }

    fn split(&mut self, edges: impl IntoIterator<Item = [u32; 2]>) -> bool {
        let before = self.mesh.splits().len();
        if !self.mesh.split(edges, self.max_vertices) {
            return false;
        }
        // What was measured in the middle of an edge is what is measured at the new vertex.
        self.vertices.resize(self.mesh.vertex_count() - (self.mesh.splits().len() - before), None);
        for ends in &self.mesh.splits()[before..] {
            self.vertices.push(self.middles.remove(ends));
        }
        true
    }

    /// Measures what is not known yet.
    fn measure<E>(
        &mut self,
        probe: &mut impl FnMut(&[SurfacePoint]) -> Result<Vec<Probe>, E>,
    ) -> Result<(), E> {
        self.vertices.resize(self.mesh.vertex_count(), None);
        let (mut targets, mut points) = (Vec::new(), Vec::new());
        let mut known: HashSet<[u32; 2]> = HashSet::new();
        let mut seen = vec![false; self.vertices.len()];
        let mut add = |target, at| {
            targets.push(target);
            points.push(at);
        };
        let given = self.mesh.scene().vertex_count() as u32;
        for part in self.mesh.parts() {
            let mut is_needed = [false; 3];
            for (k, ends) in edges(part).into_iter().enumerate() {
                let shortest = if ends[1] < given { PROBED } else { SHORTEST };
                if self.mesh.relative_length(ends) <= shortest {
                    continue;
                }
                (is_needed[k], is_needed[(k + 1) % 3]) = (true, true);
                if !self.middles.contains_key(&ends) && known.insert(ends) {
                    add(Target::Middle(ends), on_edge(part, k));
                }
            }
            let is_large =
                edges(part).into_iter().any(|ends| self.mesh.relative_length(ends) > PROBED_WITHIN);
            if is_large && !self.within.contains_key(&part.vertices) {
                is_needed = [true; 3];
                for (i, &weights) in WITHIN.iter().enumerate() {
                    add(Target::Within(part.vertices, i), part.at(weights));
                }
            }
            for (k, &vertex) in part.vertices.iter().enumerate().filter(|(k, _)| is_needed[*k]) {
                let is_new = self.vertices[vertex as usize].is_none();
                if is_new && !std::mem::replace(&mut seen[vertex as usize], true) {
                    add(Target::Vertex(vertex), at_corner(part, k));
                }
            }
        }
        for (target, measured) in targets.into_iter().zip(probe(&points)?) {
            match target {
                Target::Vertex(vertex) => self.vertices[vertex as usize] = Some(measured),
                Target::Middle(ends) => drop(self.middles.insert(ends, measured)),
                Target::Within(vertices, i) => self.within.entry(vertices).or_default()[i] = measured,
            }
        }
        Ok(())
    }

    /// The edges that are to be split, and how urgently.
    fn marked(&self, criterion: &Criterion) -> Vec<([u32; 2], f64)> {
        let mut marked: HashMap<[u32; 2], f64> = HashMap::new();
        let mut mark = |ends: [u32; 2], excess: f64| {
            let urgency = marked.entry(ends).or_insert(excess);
            *urgency = urgency.max(excess);
        };
        self.for_each_edge(criterion, |ends, excess, is_split| {
            if is_split {
                mark(ends, excess);
            }
        });
        marked.into_iter().collect()
    }

    /// Calls with each edge whose direct light is known, how much that differs from a linear function, and whether the edge is to
    /// be split; as often as it is looked at.
    fn for_each_edge(&self, criterion: &Criterion, mut call: impl FnMut([u32; 2], f64, bool)) {
        for part in self.mesh.parts() {
            let edges = edges(part);
            for ends in edges {
                let Some(middle) = self.middles.get(&ends) else { continue };
                let of_ends = ends.each_ref().map(|&vertex| self.at(vertex));
                let excess = criterion.excess(middle, of_ends, self.mesh.relative_length(ends));
                let is_shadow = || criterion.is_shadow_edge(middle, of_ends, self.mesh.relative_length(ends));
                call(ends, excess, excess > 1.0 || is_shadow());
            }
            for (inside, weights) in self.within.get(&part.vertices).into_iter().flatten().zip(WITHIN) {
                let length = |ends| self.mesh.relative_length(ends);
                let longest = edges.into_iter().max_by(|&a, &b| length(a).total_cmp(&length(b)));
                let Some(longest) = longest.filter(|&ends| length(ends) > SHORTEST) else { continue };
                let corners = part.vertices.each_ref().map(|&vertex| self.at(vertex));
                let excess = criterion.excess_within(inside, corners, weights, length(longest));
                call(longest, excess, excess > 1.0);
            }
        }
    }

    fn at(&self, vertex: u32) -> &Probe {
        self.vertices[vertex as usize].as_ref().unwrap_or(&Probe::NONE)
    }

    fn area(&self, part: &Part) -> f64 {
        let [a, b, c] = part.vertices.map(|vertex| self.mesh.position(vertex).as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    }

    /// The mean over all surfaces of something at vertices, as far as it is known.
    fn mean(&self, at: impl Fn(u32) -> Option<f64>) -> f64 {
        let (mut light, mut area) = (0.0, 0.0);
        for part in self.mesh.parts() {
            let of_part = self.area(part) / 3.0;
            for of_vertex in part.vertices.into_iter().filter_map(&at) {
                light += of_part * of_vertex;
                area += of_part;
            }
        }
        if area > 0.0 { light / area } else { 0.0 }
    }
}

/// The edges of a part, each by its vertices, the smaller first.
pub(super) fn edges(part: &Part) -> [[u32; 2]; 3] {
    [0, 1, 2].map(|k| {
        let (a, b) = (part.vertices[k], part.vertices[(k + 1) % 3]);
        [a.min(b), a.max(b)]
    })
}

/// A corner of a part, a little towards its middle.
fn at_corner(part: &Part, k: usize) -> SurfacePoint {
    let mut weights = [0.0; 3];
    weights[k] = 1.0;
    inset(part, weights)
}

/// The middle of the edge that begins at a corner, a little towards the middle of the part.
fn on_edge(part: &Part, k: usize) -> SurfacePoint {
    let mut weights = [0.5; 3];
    weights[(k + 2) % 3] = 0.0;
    inset(part, weights)
}

/// A point of a part, a little towards its middle.
fn inset(part: &Part, weights: [f32; 3]) -> SurfacePoint {
    part.at(weights.map(|weight| weight + INSET * (1.0 / 3.0 - weight)))
}

mod kept;
mod shown;
#[cfg(test)]
mod tests;
