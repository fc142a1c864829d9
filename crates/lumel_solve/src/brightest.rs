//! Which nodes shoot next.

use lumel_basis::NodeId;

/// The brightest nodes, as few as have this `share` of all power together, in the order of nodes; of equally bright ones
/// those that come first. Nodes without power are never among them.
pub fn brightest(powers: &[f64], share: f64) -> Vec<NodeId> {
    let all: f64 = powers.iter().filter(|power| **power > 0.0).sum();
    // Those that are dimmer have too little together to be needed.
    let least = (1.0 - share).max(0.0) * all / powers.len().max(1) as f64;
    let bright = (0..).map(NodeId).zip(powers).filter(|(_, power)| **power > 0.0 && **power >= least);
    let mut bright: Vec<(NodeId, f64)> = bright.map(|(node, power)| (node, *power)).collect();
    bright.sort_unstable_by(|(a, power), (b, other)| other.total_cmp(power).then(a.cmp(b)));
    let mut sum = 0.0;
    let enough = bright.iter().position(|(_, power)| {
        sum += power;
        sum >= share * all
    });
    bright.truncate(enough.map_or(bright.len(), |last| last + 1));
    let mut nodes: Vec<NodeId> = bright.into_iter().map(|(node, _)| node).collect();
    nodes.sort_unstable();
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picked(powers: &[f64], share: f64) -> Vec<u32> {
        brightest(powers, share).into_iter().map(|node| node.0).collect()
    }

    #[test]
    fn as_few_nodes_as_have_the_share_shoot_and_the_first_of_equals() {
        assert_eq!(picked(&[1.0, 4.0, 2.0, 3.0], 0.4), [1]);
        assert_eq!(picked(&[1.0, 4.0, 2.0, 3.0], 0.41), [1, 3]);
        assert_eq!(picked(&[1.0, 1.0, 1.0, 1.0], 0.5), [0, 1]);
        assert_eq!(picked(&[1.0, 4.0, 2.0, 3.0], 1.0), [0, 1, 2, 3]);
    }

    #[test]
    fn what_has_no_power_never_shoots() {
        assert_eq!(picked(&[0.0, -2.0, 5.0, f64::NAN], 1.0), [2]);
        assert!(picked(&[0.0, 0.0], 0.5).is_empty() && picked(&[], 0.5).is_empty());
    }
}
