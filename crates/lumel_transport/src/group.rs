//! Elements that are measured at points, side by side.

use crate::Sums;
use glam::DVec3;
use lumel_basis::{CENTER, ElementId, NodeWeights, Receivers, Site};

/// Some elements, their sites and the nodes that they count towards.
pub(crate) struct Group {
    pub(crate) elements: Vec<ElementId>,
    pub(crate) sites: Vec<Site>,
    /// The nodes that each measurement counts towards, one after the other, and where those of each end.
    towards: NodeWeights,
    ends: Vec<usize>,
}

impl Group {
    pub(crate) fn new<R: Receivers>(receivers: &R, elements: &[ElementId]) -> Self {
        let mut towards = NodeWeights::default();
        let mut ends = Vec::with_capacity(elements.len());
        let mut site = |&element: &ElementId| {
            receivers.towards(element, CENTER, &mut towards);
            ends.push(towards.len());
            receivers.central_site(element)
        };
        let sites = elements.iter().map(&mut site).collect();
        Self { elements: elements.to_vec(), sites, towards, ends }
    }

    pub(crate) fn len(&self) -> usize {
        self.sites.len()
    }

    /// The sums of the group, from the irradiance at each site.
    pub(crate) fn irradiance(&self, values: &[DVec3]) -> Sums {
        self.sums(|sums, i, node, weight| sums.push(node, weight, values[i]))
    }

    /// The sums of the group, from all channels at each site.
    pub(crate) fn moments<'a>(&self, values: impl Fn(usize) -> &'a [DVec3]) -> Sums {
        self.sums(|sums, i, node, weight| sums.push_channels(node, weight, values(i)))
    }

    /// The sums of the group, from how much of each site is hidden.
    pub(crate) fn hidden(&self, shares: &[f64]) -> Sums {
        self.sums(|sums, i, node, weight| sums.push_hidden(node, weight, shares[i]))
    }

    fn sums(&self, mut push: impl FnMut(&mut Sums, usize, lumel_basis::NodeId, f64)) -> Sums {
        let mut sums = Sums::with_capacity(self.towards.len());
        let mut towards = self.towards.iter();
        let mut begin = 0;
        for (i, &end) in self.ends.iter().enumerate() {
            for (node, weight) in towards.by_ref().take(end - begin) {
                push(&mut sums, i, node, f64::from(weight));
            }
            begin = end;
        }
        sums
    }
}
