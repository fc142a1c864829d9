//! How much memory a bake is going to take.

use crate::settings::{BounceLimit, Layers, Memory, ScheduleKind};
use crate::{Baker, Lumels, Method, layers};
use lumel_basis::Sampling;

/// Above this mean albedo, light leaves through openings before so many bounces are needed.
const MAX_ALBEDO: f64 = 0.95;

/// Bounces that are computed beyond those that the mean albedo asks for: bright parts of a scene keep their light longer.
const MORE_BOUNCES: f64 = 3.0;

/// Bytes of light at one node or lumel: three numbers in single precision.
const LIGHT: u64 = 12;

/// Bytes that one measurement of a node or lumel takes until all are merged: a number, a weight and a sum.
const SUM: u64 = 36;

/// Bytes by node or lumel while measurements are merged.
const MERGING: u64 = 57;

/// Bytes by triangle of what a bounce is read from.
const PLANE: u64 = 48;

/// Bytes by node of the projection by least squares, with what it is made from.
const LEAST_SQUARES: u64 = 400;

/// Bytes by triangle of a tree of boxes, while it is made.
const TREE: u64 = 250;

/// Bytes by lumel of the pages of what finds gutters, holes and seams.
const FINISHING: u64 = 80;

/// Layers of a lightmap besides the parts of its light: all light, with its noise, its error and ambient occlusion.
const MORE_LAYERS: u64 = 4;

impl Baker {
    /// About how much memory a bake takes at most beyond what its scene, its basis and its lumels take already, before it begins.
    ///
    /// From what is counted before: nodes, rays, lumels, and how many bounces the mean albedo of the surfaces asks for. With
    /// `lumels`, it includes measuring and finishing their light; it always includes writing files other than pictures. It is meant to be an upper
    /// bound that is not far away.
    pub fn memory_to_come(&self, lumels: Option<&Lumels>) -> Memory {
        let (nodes, elements) = (self.integrals().node_count() as u64, self.elements_per_step());
        let (vertices, triangles) =
            (self.scene().vertex_count() as u64, self.scene().triangle_count() as u64);
        let n_fields = self.expected_steps() + 1 + self.layer_count();
        let is_area = self.settings().sampling() == Sampling::Area;
        let sums = if is_area { 3 * SUM } else { SUM };
        let fields = n_fields * nodes * LIGHT;
        let harmonics = self.settings().directional.harmonics() as u64;
        let n_directional = if harmonics > 0 { 1 + self.layer_count() } else { 0 };
        let directional = n_directional * harmonics * nodes * LIGHT + self.directional_memory().0;
        let kept = self.ray_bytes() + fields + directional + if is_area { nodes * LEAST_SQUARES } else { 0 };
        // A checkpoint is written from a copy, array by array.
        let solving = (elements * sums + nodes * MERGING + triangles * PLANE).max(2 * fields);
        // Direct light is measured at vertices, or over triangles, once bounces are there.
        let reading = match self.basis().points() {
            Some(_) => (3 * triangles).max(vertices) * SUM + vertices * (MERGING + LEAST_SQUARES),
            None => 0,
        };
        let solving = solving.max(reading);
        // Each value is summed and merged in double precision, for lights and for bounces.
        let sums_of_harmonics =
            harmonics * (if is_area { 3 * elements } else { elements } + nodes) * 2 * LIGHT;
        let solving = solving + sums_of_harmonics + 3 * harmonics * nodes * LIGHT;
        // As it is read and as it is written, in the coordinates of files.
        let writing = 2 * (n_fields + 3 + n_directional * harmonics) * vertices * LIGHT + vertices * 36;
        let of_lumels = lumels.map_or([0; 2], |lumels| self.lumel_bytes(lumels, n_fields));
        Memory(kept + solving.max(of_lumels[0]).max(of_lumels[1] + writing))
    }

    /// While lumels are measured, and afterwards.
    fn lumel_bytes(&self, lumels: &Lumels, n_parts: u64) -> [u64; 2] {
        let (n, on_pages) = (lumels.coverage.len() as u64, lumels.atlas.lumel_count() as u64);
        let n_parts = n_parts + self.settings().directional.harmonics() as u64;
        let light = n * (n_parts * LIGHT + 17);
        let planes = self.scene().triangle_count() as u64 * PLANE;
        let rays = self.memory_of_lumel_rays(lumels).0;
        let measuring = rays + planes + n * (SUM + MERGING + LIGHT) + 2 * light;
        let layers = (n_parts + MORE_LAYERS) * on_pages * LIGHT;
        let denoising = 2 * (n_parts + 1) * n * LIGHT;
        let tree = lumels.scene.triangle_count() as u64 * TREE;
        // Files have the layers once more, in the order of their pixels.
        [light + measuring, light + layers + (denoising + on_pages * FINISHING).max(layers + tree)]
    }

    /// Direct light, and the bounces that are computed.
    fn expected_steps(&self) -> u64 {
        let settings = self.settings();
        match settings.bounces {
            // What was reflected, what is unshot, and what a step sends and brings.
            BounceLimit::All if settings.schedule == ScheduleKind::Shoot => 5,
            BounceLimit::Count(n) => u64::from(n) + 1,
            BounceLimit::All => {
                let albedo = self.integrals().mean_albedo().clamp(0.1, MAX_ALBEDO);
                (f64::from(settings.remainder).ln() / albedo.ln() + 1.0 + MORE_BOUNCES).ceil() as u64
            }
        }
    }

    fn layer_count(&self) -> u64 {
        match self.settings().layers {
            Layers::Off => 0,
            Layers::Lights => layers::light_layers(self.scene(), self.settings()).len() as u64,
        }
    }

    /// The rays that a solve stores.
    fn ray_bytes(&self) -> u64 {
        match self.method() {
            Method::Cached { memory } | Method::FinalGather { memory, .. } => memory.0,
            Method::Neumann => 0,
            // Rounds add rays up to the limit.
            Method::Replicates { memory, .. } => self.settings().memory.0.max(memory.0),
        }
    }
}
