//! Which bounces are shown.

use crate::point_light::PointIllumination;
use glam::{DVec3, Vec3};
use lumel_basis::Coefficients;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Light at the vertices of a scene, W·m⁻², bounce by bounce.
pub type VertexValues = Arc<Vec<Vec3>>;

/// A part of the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Selection {
    /// All bounces and the estimate of those that were not computed.
    #[default]
    All,
    /// All but direct light.
    Indirect,
    /// From one bounce to another, both included; 0 is direct light.
    Range(u32, u32),
}

impl Selection {
    /// Direct light only.
    pub const DIRECT: Self = Self::Range(0, 0);

    /// No light at all: no bounce has this number.
    pub const NONE: Self = Self::Range(u32::MAX, u32::MAX);

    /// One bounce.
    pub fn bounce(k: u32) -> Self {
        Self::Range(k, k)
    }

    /// Whether bounce `k` is part of it.
    pub fn contains(self, k: usize) -> bool {
        match self {
            Self::All => true,
            Self::Indirect => k > 0,
            Self::Range(first, last) => (first as usize..=last as usize).contains(&k),
        }
    }

    /// Whether the estimate of the bounces after the last is part of it.
    pub fn contains_tail(self) -> bool {
        matches!(self, Self::All | Self::Indirect)
    }

    /// Whether light without bounces apart can be shown in it.
    pub fn is_all(self) -> bool {
        self == Self::All
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::All => f.write_str("all light"),
            Self::Indirect => f.write_str("indirect light"),
            Self::DIRECT => f.write_str("direct light"),
            Self::Range(a, b) if a == b => write!(f, "bounce {a}"),
            Self::Range(a, b) => write!(f, "bounces {a} to {b}"),
        }
    }
}

/// Light as far as it is known, at every vertex.
#[derive(Clone, Debug, Default)]
pub struct Illumination {
    /// Tells the light of one solve or file from that of others.
    pub id: u64,
    /// Bounces that are done; empty where a file holds nothing but their sum.
    pub bounces: Vec<VertexValues>,
    /// What is known of the bounce being measured, spread over what is not.
    pub current: Option<VertexValues>,
    /// Estimate of all bounces that were not computed.
    pub tail: Option<VertexValues>,
    /// The sum, where a file does not tell bounces apart.
    pub sum_only: Option<VertexValues>,
    /// Whether each vertex was measured itself; empty while that is not known.
    pub valid: Arc<Vec<bool>>,
    /// Standard error of the sum, where it is known.
    pub standard_error: Option<VertexValues>,
    /// The parts of all light that single lights cause, where a solve with layers has told them apart.
    pub layers: Vec<Layer>,
    /// All light by direction, where a solve has measured it.
    pub directional: Option<Arc<Coefficients>>,
    /// That of the light before, while a solve runs that has not measured its own yet: it is shown, but part of no file.
    pub directional_before: Option<Arc<Coefficients>>,
    /// The same at scattered points, where these carry it: it is shown in place of that at the vertices.
    pub points: Option<PointIllumination>,
}

/// The light of one light, or of all that share its name.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Its part of all light.
    pub values: VertexValues,
    /// The same by direction, where that was measured.
    pub directional: Option<Arc<Coefficients>>,
    /// What it is multiplied by where all light is shown; 1 as solved.
    pub share: f32,
}

/// Numbers solves and files.
static NEXT: AtomicU64 = AtomicU64::new(1);

impl Illumination {
    /// Darkness with a number of its own.
    pub fn new() -> Self {
        Self { id: NEXT.fetch_add(1, Ordering::Relaxed), ..Self::default() }
    }

    /// Replaces direct light, if there is any, by what was measured elsewhere.
    pub fn set_direct(&mut self, direct: VertexValues) {
        if let Some(bounce) = self.bounces.first_mut().filter(|bounce| **bounce != direct) {
            *bounce = direct;
            // What was shown of it is not what it is.
            self.id = Self::new().id;
        }
    }

    /// Whether there is nothing to see.
    pub fn is_empty(&self) -> bool {
        self.bounces.is_empty() && self.current.is_none() && self.sum_only.is_none()
    }

    /// Bounces that can be told apart, the one being measured included.
    pub fn bounce_count(&self) -> usize {
        self.bounces.len() + usize::from(self.current.is_some())
    }

    /// Whether all light is shown with a layer dimmed or brightened.
    pub fn is_mixed(&self) -> bool {
        self.layers.iter().any(|layer| layer.share != 1.0)
    }

    /// All light with each layer times its share, which needs no solve, never negative.
    fn mixed(&self, n: usize) -> Vec<Vec3> {
        let part = |layer: &Layer, v: usize| layer.values[v].as_dvec3() * f64::from(layer.share);
        let at = |v| self.layers.iter().map(|layer| part(layer, v)).sum::<DVec3>();
        (0..n).map(|v| at(v).as_vec3().max(Vec3::ZERO)).collect()
    }

    /// The chosen part at all of `n` vertices, W·m⁻²; zero where there is none. All light is that of the layers if they
    /// are mixed; bounces stay as solved. All light is never negative; its parts may be, beside edges.
    pub fn select(&self, selection: Selection, n: usize) -> Vec<Vec3> {
        if selection.is_all() && self.is_mixed() {
            return self.mixed(n);
        }
        if let Some(sum) = &self.sum_only {
            return if selection.is_all() { sum.to_vec() } else { vec![Vec3::ZERO; n] };
        }
        let bounces = self.bounces.iter().chain(&self.current).enumerate();
        let mut parts: Vec<&VertexValues> =
            bounces.filter(|(k, _)| selection.contains(*k)).map(|(_, values)| values).collect();
        parts.extend(self.tail.iter().filter(|_| selection.contains_tail()));
        let mut sum = match parts.as_slice() {
            [] => vec![Vec3::ZERO; n],
            [only] => only.to_vec(),
            parts => (0..n).map(|v| parts.iter().map(|p| p[v].as_dvec3()).sum::<DVec3>().as_vec3()).collect(),
        };
        if selection.is_all() {
            sum.iter_mut().for_each(|value| *value = value.max(Vec3::ZERO));
        }
        sum
    }

    /// What of the chosen part is not at the points but at all of `n` vertices; all of it where no points carry light.
    pub fn select_beside_points(&self, selection: Selection, n: usize) -> Vec<Vec3> {
        match &self.points {
            None => self.select(selection, n),
            Some(points) if points.leaves_direct(selection) => self.select(Selection::DIRECT, n),
            Some(_) => vec![Vec3::ZERO; n],
        }
    }

    /// The chosen part by direction at all of `n` vertices: known of all light, as it was solved.
    pub fn select_directional(&self, selection: Selection, n: usize) -> Option<&Arc<Coefficients>> {
        self.directions(n).filter(|_| selection.is_all() && !self.is_mixed())
    }

    /// All light by direction at all of `n` vertices, or that of the light before.
    pub fn directions(&self, n: usize) -> Option<&Arc<Coefficients>> {
        let known = self.directional.as_ref().or(self.directional_before.as_ref());
        known.filter(|coefficients| coefficients.len() == n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light() -> Illumination {
        let values = |x: f32| Arc::new(vec![Vec3::splat(x), Vec3::splat(10.0 * x)]);
        Illumination {
            bounces: vec![values(1.0), values(2.0), values(4.0)],
            current: Some(values(8.0)),
            tail: Some(values(16.0)),
            ..Illumination::default()
        }
    }

    #[test]
    fn every_part_is_the_sum_of_its_bounces() {
        let first = |selection| light().select(selection, 2)[0].x;
        assert_eq!(first(Selection::All), 31.0);
        assert_eq!(first(Selection::Indirect), 30.0);
        assert_eq!(first(Selection::DIRECT), 1.0);
        assert_eq!(first(Selection::Range(1, 2)), 6.0);
        assert_eq!(first(Selection::bounce(3)), 8.0, "the bounce being measured");
        assert_eq!(first(Selection::bounce(7)), 0.0);
        assert_eq!(light().bounce_count(), 4);
    }

    #[test]
    fn all_light_is_never_negative_though_a_bounce_may_be() {
        let mut light = light();
        light.tail = Some(Arc::new(vec![Vec3::splat(-20.0); 2]));
        light.bounces[1] = Arc::new(vec![Vec3::splat(-1.0); 2]);
        assert_eq!(light.select(Selection::All, 2), [Vec3::ZERO, Vec3::splat(109.0)]);
        assert_eq!(light.select(Selection::bounce(1), 2)[0].x, -1.0);
    }

    #[test]
    fn a_sum_has_no_bounces() {
        let sum = Illumination { sum_only: Some(Arc::new(vec![Vec3::ONE; 2])), ..Illumination::default() };
        assert_eq!(sum.select(Selection::All, 2), [Vec3::ONE; 2]);
        assert_eq!(sum.select(Selection::DIRECT, 2), [Vec3::ZERO; 2]);
        assert!(!sum.is_empty() && sum.bounce_count() == 0);
        assert_eq!(Illumination::default().select(Selection::All, 2), [Vec3::ZERO; 2]);
    }

    #[test]
    fn a_dimmed_layer_dims_its_part_of_all_light_and_no_bounce() {
        let layer = |x: f32, share| Layer {
            name: "lamp".to_owned(),
            values: Arc::new(vec![Vec3::splat(x), Vec3::splat(10.0 * x)]),
            directional: None,
            share,
        };
        let mut light = light();
        light.layers = vec![layer(11.0, 1.0), layer(20.0, 1.0)];
        assert!(!light.is_mixed() && light.select(Selection::All, 2)[0].x == 31.0);
        light.layers[1].share = 0.25;
        assert_eq!(light.select(Selection::All, 2), [Vec3::splat(16.0), Vec3::splat(160.0)]);
        assert_eq!(light.select(Selection::DIRECT, 2)[0].x, 1.0);
    }

    #[test]
    fn all_light_is_known_by_direction_unless_it_is_mixed() {
        let coefficients = Coefficients::new(lumel_basis::Directional::Sh1, vec![Vec3::ONE; 8]).map(Arc::new);
        let mut light = Illumination { directional: coefficients.clone(), ..light() };
        assert_eq!(light.select_directional(Selection::All, 2), coefficients.as_ref());
        assert_eq!(light.select_directional(Selection::All, 3), None, "it is that of another mesh");
        assert_eq!(light.select_directional(Selection::DIRECT, 2), None);
        let name = "lamp".to_owned();
        let values = Arc::new(vec![Vec3::ONE; 2]);
        light.layers = vec![Layer { name, values, directional: None, share: 0.5 }];
        assert_eq!(light.select_directional(Selection::All, 2), None);
        let running = Illumination { directional_before: coefficients.clone(), ..Illumination::default() };
        assert_eq!(running.select_directional(Selection::All, 2), coefficients.as_ref());
    }

    #[test]
    fn parts_have_names() {
        let name = |s: Selection| s.to_string();
        assert_eq!(name(Selection::DIRECT), "direct light");
        assert_eq!(name(Selection::bounce(2)), "bounce 2");
        assert_eq!(name(Selection::Range(1, 3)), "bounces 1 to 3");
    }
}
