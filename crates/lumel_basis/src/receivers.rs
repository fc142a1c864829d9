//! Where light is measured.

use crate::{Identity, NodeId, NodeWeights};
use glam::Vec3;
use lumel_sample::Frame;
use lumel_scene::TriId;

/// A unit of measuring: a vertex, a triangle, a lumel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The index as a `usize`, for slices.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A place where light is measured.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Where rays start: on the surface, pushed off it as [`lumel_scene::RayOrigins`] are.
    pub origin: Vec3,
    /// The hemisphere that is measured, in world space.
    pub frame: Frame,
    /// The traced triangle the site lies on, which rays from here do not see.
    pub skip: Option<TriId>,
}

/// How an element is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// At one point: all rays of an element share an origin.
    Point,
    /// Over an area: every ray has an origin of its own.
    Area,
}

/// Where light is measured, and which nodes a measurement counts towards.
///
/// The nodes are those of a basis where light is carried from bounce to bounce; they are nobody's where light is only
/// asked for, as at [points](crate::PointReceivers). Every implementation keeps these laws, which `lumel_testkit::laws`
/// checks:
///
/// - `nodes_of` covers all nodes that a site of the element counts towards, and every node is measured by some element.
/// - Weights are not negative, and every site has one that is greater than zero.
/// - `corners`, if there are any, agree with `towards` everywhere.
/// - Elements that are sampled at a [point](Sampling::Point) have the same site for every `u`.
/// - `identity` is the same for the same geometry and construction and another one for any other.
pub trait Receivers: Send + Sync {
    /// What decides its elements, their sites and the nodes they count towards.
    fn identity(&self) -> Identity;

    /// Number of coefficients.
    fn node_count(&self) -> usize;

    /// Number of elements.
    fn element_count(&self) -> usize;

    /// How elements are sampled.
    fn sampling(&self) -> Sampling;

    /// Adds all nodes that measurements of an element may count towards.
    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>);

    /// How many times the samples of an element are doubled, or halved if it is negative.
    ///
    /// Large elements deserve more than small ones. The number of samples should be about the same on average.
    fn doublings(&self, _element: ElementId) -> i8 {
        0
    }

    /// What chooses the sample points of an element: the same for an element that other receivers have, too, if these are to use
    /// the rays that were stored of it.
    fn stream(&self, element: ElementId) -> u32 {
        element.0
    }

    /// A place of an element, chosen by `u` in the unit square if elements have an area.
    ///
    /// An area is a triangle on which the place is the [uniform](lumel_sample::uniform_triangle) one; of other areas integrals
    /// of polynomials over their samples are not exact.
    fn site(&self, element: ElementId, u: [f32; 2]) -> Site;

    /// Adds the sites of many places of an element: what is the same for all is computed once.
    fn sites(&self, element: ElementId, places: &[[f32; 2]], sites: &mut Vec<Site>) {
        sites.extend(places.iter().map(|&u| self.site(element, u)));
    }

    /// Adds the nodes that a measurement at a place of an element counts towards, and how much.
    ///
    /// A node's value is the mean of all its measurements by weight, so weights need no common scale.
    fn towards(&self, element: ElementId, u: [f32; 2], nodes: &mut NodeWeights);

    /// The nodes at the corners of an element, and its area, if measurements count towards them by barycentrics and area.
    ///
    /// A fast path, as [`Basis::corner_nodes`](crate::Basis::corner_nodes) is: it says the same as `towards`.
    fn corners(&self, _element: ElementId) -> Option<([NodeId; 3], f32)> {
        None
    }

    /// How near above an element another surface almost touches it, metres: a small part of its size. Zero where elements
    /// have none.
    fn reach(&self, _element: ElementId) -> f32 {
        0.0
    }

    /// A triangle that an element lies on, where that is known.
    fn surface(&self, _element: ElementId) -> Option<TriId> {
        None
    }

    /// Adds where rays start at the places next to an element's sites, on the same surface: what lies in between cuts it.
    fn beside(&self, _element: ElementId, _origins: &mut Vec<Vec3>) {}

    /// A place that stands for all of an element: its own, or about the middle of its area.
    fn central_site(&self, element: ElementId) -> Site {
        self.site(element, CENTER)
    }
}

/// The coordinates of the one site of an element without area.
pub const CENTER: [f32; 2] = [0.5, 0.5];
