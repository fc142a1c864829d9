//! Light that has arrived and is still to be reflected.

use crate::selection::VertexValues;
use glam::Vec3;
use lumel::{Baker, SolveState};
use lumel_basis::{Basis as _, Field, NodeId};
use std::sync::Arc;

/// The share of the unshot power that the nodes which are marked have together.
const MARKED_SHARE: f64 = 0.1;

/// More marks than this cannot be told apart.
const MAX_MARKED: usize = 1000;

/// Light that has arrived and is still to be reflected: after gathering, that of the last bounce.
#[derive(Clone, Debug)]
pub struct Unshot {
    /// What each vertex has still to send: its radiosity by luminance, W·m⁻².
    pub radiosity: VertexValues,
    /// What that would bring if it arrived everywhere alike, W·m⁻²: for looking at only.
    pub ambient: Vec3,
    /// What it would bring besides, as far as that was seen at a first look: likewise.
    pub seen: Option<VertexValues>,
    /// Where the nodes with the most unshot power are.
    pub brightest: Vec<Vec3>,
}

impl Unshot {
    /// That of a state; `None` before any light is known.
    pub fn of(baker: &Baker, state: &SolveState) -> Option<Self> {
        let powers = baker.integrals().unshot_powers(state.unshot()?);
        let per_area = |(&power, &area): (&f64, &f32)| {
            Vec3::splat(if area > 0.0 { (power / f64::from(area)) as f32 } else { 0.0 })
        };
        let radiosity = powers.iter().zip(baker.basis().node_areas()).map(per_area).collect();
        let radiosity = Arc::new(baker.carried_at_vertices(&Field::from_values(radiosity)));
        let mut brightest = baker.brightest(state, MARKED_SHARE);
        if brightest.len() > MAX_MARKED {
            let by_power = |a: &NodeId, b: &NodeId| powers[b.index()].total_cmp(&powers[a.index()]);
            brightest.select_nth_unstable_by(MAX_MARKED, by_power);
            brightest.truncate(MAX_MARKED);
        }
        let brightest = brightest.iter().map(|&node| baker.position_of(node)).collect();
        Some(Self { radiosity, ambient: baker.ambient(state), seen: None, brightest })
    }
    /// Adds what is still to come to light at the vertices.
    pub fn add_to(&self, light: &mut [Vec3]) {
        light.iter_mut().for_each(|value| *value += self.ambient);
        for (value, seen) in light.iter_mut().zip(self.seen.iter().flat_map(|seen| seen.iter())) {
            *value += *seen;
        }
    }
}
