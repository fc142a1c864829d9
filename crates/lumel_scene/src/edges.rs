//! Edges of triangles between places, and what hangs together by them.

use crate::weld::sorted_by_number;

/// A side of a triangle, from one corner to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edge {
    /// The places at its ends, the smaller first.
    pub ends: [u32; 2],
    /// Which of the triangles.
    pub tri: u32,
    /// The corner where it begins: 0, 1 or 2.
    pub side: u8,
    /// Whether it runs from the smaller place to the larger one.
    pub forward: bool,
}

impl Edge {
    /// The corners of the triangle at the smaller and at the larger end.
    pub fn corners(&self) -> [usize; 2] {
        let [from, to] = [self.side as usize, (self.side as usize + 1) % 3];
        if self.forward { [from, to] } else { [to, from] }
    }
}

/// The edges of triangles: those between the same two places side by side.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    all: Vec<Edge>,
    /// By place: the first edge whose smaller end it is. Those of the place before end there.
    begins: Vec<u32>,
}

impl Edges {
    /// The edges of triangles whose corners are at places with these numbers, as [`Weld`](crate::Weld) gives them.
    pub fn new(triangles: impl IntoIterator<Item = [u32; 3]>) -> Self {
        let mut edges = Vec::new();
        for (tri, places) in (0..).zip(triangles) {
            for side in 0..3_u8 {
                let (from, to) = (places[side as usize], places[(side as usize + 1) % 3]);
                edges.push(Edge { ends: [from.min(to), from.max(to)], tri, side, forward: from < to });
            }
        }
        // Numbers of places have no gaps to speak of: counting is faster than comparing.
        let n_places = edges.iter().map(|edge| edge.ends[1] as usize + 1).max().unwrap_or(0);
        let edges = sorted_by_number(&edges, n_places, |edge: &Edge| edge.ends[1]);
        let all = sorted_by_number(&edges, n_places, |edge| edge.ends[0]);
        let mut begins = vec![0; n_places + 1];
        all.iter().for_each(|edge| begins[edge.ends[0] as usize + 1] += 1);
        (0..n_places).for_each(|place| begins[place + 1] += begins[place]);
        Self { all, begins }
    }

    /// The sides of triangles at each edge, in the order of the triangles, edge by edge in the order of their ends.
    pub fn each(&self) -> impl Iterator<Item = &[Edge]> {
        self.all.chunk_by(|a, b| a.ends == b.ends)
    }

    /// The sides of triangles between two places; empty if there is no such edge.
    pub fn between(&self, p: u32, q: u32) -> &[Edge] {
        let (low, high) = (p.min(q) as usize, p.max(q));
        let Some(&[begin, end]) = self.begins.get(low..low + 2) else { return &[] };
        let beside = &self.all[begin as usize..end as usize];
        let first = beside.partition_point(|edge| edge.ends[1] < high);
        let n = beside[first..].iter().take_while(|edge| edge.ends[1] == high).count();
        &beside[first..first + n]
    }
}

/// Things that hang together: a forest in which each points towards the one that stands for all.
#[derive(Clone, Debug)]
pub struct Forest(Vec<u32>);

impl Forest {
    /// So many things, each alone.
    pub fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    /// The first of those that hang together with one.
    pub fn of(&mut self, mut one: u32) -> u32 {
        while self.0[one as usize] != one {
            self.0[one as usize] = self.0[self.0[one as usize] as usize];
            one = self.0[one as usize];
        }
        one
    }

    /// Makes two hang together, with all that hang together with them.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_halves_of_a_square_share_its_diagonal_and_run_along_it_both_ways() {
        let edges = Edges::new([[0, 1, 2], [0, 2, 3]]);
        assert_eq!(edges.each().count(), 5);
        let [a, b] = *edges.between(2, 0) else { panic!("{edges:?}") };
        assert_eq!((a.ends, a.tri, a.side, a.forward), ([0, 2], 0, 2, false));
        assert_eq!((b.ends, b.tri, b.side, b.forward), ([0, 2], 1, 0, true));
        assert_eq!((a.corners(), b.corners()), ([0, 2], [0, 1]));
        assert!(edges.between(1, 3).is_empty() && edges.between(0, 9).is_empty());
    }

    #[test]
    fn what_is_joined_hangs_together_and_its_first_stands_for_it() {
        let mut forest = Forest::new(6);
        [(4, 2), (5, 4), (1, 0)].into_iter().for_each(|(a, b)| forest.join(a, b));
        assert_eq!([0, 1, 2, 3, 4, 5].map(|one| forest.of(one)), [0, 0, 2, 3, 2, 2]);
        forest.join(5, 1);
        assert_eq!(forest.of(4), 0);
    }
}
