//! Every basis and all receivers keep their laws on every kind of scene, and each law can fail.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests")]

use lumel_basis::{
    Adjacency, AreaReceivers, Basis, ElementId, Identity, MeshlessBasis, NodeId, NodeWeights, PointReceivers,
    Receivers, Sampling, Site, VertexBasis,
};
use lumel_scene::{Scene, SurfacePoint, TriId};
use lumel_testkit::laws::{Law, assert_basis_laws, assert_receiver_laws, basis_laws, receiver_laws, scenes};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

type MakeBasis = fn(Arc<Scene>) -> Box<dyn Basis>;
type MakeReceivers = fn(Arc<Scene>) -> Box<dyn Receivers>;

const BASES: [(&str, MakeBasis); 2] =
    [("vertices", |scene| Box::new(VertexBasis::new(scene))), ("points", |scene| Box::new(meshless(scene)))];

const RECEIVERS: [(&str, MakeReceivers); 4] = [
    ("at vertices", |scene| Box::new(PointReceivers::at_vertices(&Arc::new(VertexBasis::new(scene))))),
    ("over areas", |scene| Box::new(AreaReceivers::new(Arc::new(VertexBasis::new(scene))))),
    ("at points", |scene| Box::new(centres(&scene))),
    ("at nodes", |scene| Box::new(PointReceivers::at_nodes(&Arc::new(meshless(scene))))),
];

/// As many points as scenes have vertices.
fn meshless(scene: Arc<Scene>) -> MeshlessBasis {
    let spacing = MeshlessBasis::spacing_for(&scene, 60);
    MeshlessBasis::new(scene, spacing)
}

/// A point in the middle of each triangle.
fn centres(scene: &Scene) -> PointReceivers {
    let centre = |tri| {
        let [a, b, c] = scene.triangle_positions(tri);
        ((a + b + c) / 3.0, scene.geometric_normal(tri))
    };
    PointReceivers::new(scene, (0..scene.triangle_count() as u32).map(TriId).map(centre)).unwrap()
}

#[test]
fn every_basis_keeps_its_laws() {
    for (kind, builder) in scenes() {
        for (name, make) in BASES {
            assert_basis_laws(&builder, &make, format!("{name}, {kind}"));
        }
        let make = |scene: Arc<Scene>| -> Box<dyn Basis> { Box::new(Triangles::new(&scene, Flaw::None)) };
        assert_basis_laws(&builder, &make, format!("triangles, {kind}"));
    }
}

#[test]
fn all_receivers_keep_their_laws() {
    for (kind, builder) in scenes() {
        for (name, make) in RECEIVERS {
            assert_receiver_laws(&builder, &make, format!("{name}, {kind}"));
        }
    }
}

#[test]
fn no_two_constructions_have_one_identity() {
    for (kind, builder) in scenes() {
        let scene = Arc::new(builder.build().unwrap().0);
        let bases = BASES.iter().map(|(name, make)| (*name, make(Arc::clone(&scene)).identity()));
        let receivers = RECEIVERS.iter().map(|(name, make)| (*name, make(Arc::clone(&scene)).identity()));
        let all: Vec<(&str, Identity)> = bases.chain(receivers).collect();
        for (i, (a, identity)) in all.iter().enumerate() {
            for (b, other) in &all[..i] {
                assert_ne!(identity, other, "{a} and {b}, {kind}");
            }
        }
    }
}

/// What may be wrong with [`Triangles`].
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flaw {
    None,
    WeightsSumToLess,
    NodeOutOfRange,
    AreasOfTwice,
    AreasSwapped,
    AdjacencyWithoutANode,
    IdentityOfNothing,
    IdentityOfTheMoment,
}

/// Constant functions on triangles: the simplest basis that is not linear.
struct Triangles {
    identity: Identity,
    areas: Vec<f32>,
    adjacency: Adjacency,
    flaw: Flaw,
}

impl Triangles {
    fn new(scene: &Scene, flaw: Flaw) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let moment = COUNT.fetch_add(1, Ordering::Relaxed).to_le_bytes();
        let identity = match flaw {
            Flaw::IdentityOfNothing => Identity::new("triangles", []),
            Flaw::IdentityOfTheMoment => Identity::new("triangles", [&moment[..]]),
            _ => Identity::new("triangles", [&scene.geometry_hash().as_bytes()[..]]),
        };
        let n = scene.triangle_count();
        let mut areas: Vec<f32> = (0..n as u32).map(|tri| scene.area(TriId(tri))).collect();
        match flaw {
            Flaw::AreasOfTwice => areas.iter_mut().for_each(|area| *area *= 2.0),
            Flaw::AreasSwapped => areas.rotate_left(1),
            _ => (),
        }
        let n_adjacent = n - usize::from(flaw == Flaw::AdjacencyWithoutANode);
        let chain = (1..n_adjacent as u32).map(|node| [NodeId(node - 1), NodeId(node)]);
        Self { identity, areas, adjacency: Adjacency::from_cells(n_adjacent, chain), flaw }
    }
}

impl Basis for Triangles {
    fn identity(&self) -> Identity {
        self.identity
    }

    fn node_count(&self) -> usize {
        self.areas.len()
    }

    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        let node = if self.flaw == Flaw::NodeOutOfRange { at.tri.0 + 1 } else { at.tri.0 };
        weights.push(NodeId(node), if self.flaw == Flaw::WeightsSumToLess { 0.99 } else { 1.0 });
    }

    fn node_areas(&self) -> &[f32] {
        &self.areas
    }

    fn adjacency(&self) -> &Adjacency {
        &self.adjacency
    }
}

/// The hat functions, ready to be broken.
struct Hats {
    inner: VertexBasis,
    /// What `corner_nodes` says.
    corner_nodes: Vec<[NodeId; 3]>,
    /// What `weights_at` reads.
    read_nodes: Vec<[NodeId; 3]>,
    adjacency: Adjacency,
}

impl Hats {
    fn new(scene: Arc<Scene>) -> Self {
        let inner = VertexBasis::new(scene);
        let nodes = inner.corner_nodes().unwrap().to_vec();
        Self { adjacency: inner.adjacency().clone(), inner, corner_nodes: nodes.clone(), read_nodes: nodes }
    }
}

impl Basis for Hats {
    fn identity(&self) -> Identity {
        self.inner.identity()
    }

    fn node_count(&self) -> usize {
        self.inner.node_count()
    }

    fn weights_at(&self, at: SurfacePoint, weights: &mut NodeWeights) {
        let corners = self.read_nodes[at.tri.index()].into_iter().zip(at.bary.weights());
        corners.for_each(|(node, weight)| weights.push(node, weight));
    }

    fn corner_nodes(&self) -> Option<&[[NodeId; 3]]> {
        Some(&self.corner_nodes)
    }

    fn node_areas(&self) -> &[f32] {
        self.inner.node_areas()
    }

    fn adjacency(&self) -> &Adjacency {
        &self.adjacency
    }
}

/// The law that is broken on the round scene.
fn broken(make: &dyn Fn(Arc<Scene>) -> Box<dyn Basis>) -> Option<Law> {
    let (_, builder) = scenes().into_iter().find(|(kind, _)| *kind == "round").unwrap();
    basis_laws(&builder, make).err().map(|violation| violation.law)
}

#[test]
fn each_law_of_bases_can_fail() {
    let flaws = [
        (Flaw::None, None),
        (Flaw::WeightsSumToLess, Some(Law::PartitionOfUnity)),
        (Flaw::NodeOutOfRange, Some(Law::Weights)),
        (Flaw::AreasOfTwice, Some(Law::NodeAreas)),
        (Flaw::AreasSwapped, Some(Law::NodeAreas)),
        (Flaw::AdjacencyWithoutANode, Some(Law::Adjacency)),
        (Flaw::IdentityOfNothing, Some(Law::Identity)),
        (Flaw::IdentityOfTheMoment, Some(Law::Identity)),
    ];
    for (flaw, law) in flaws {
        assert_eq!(broken(&|scene| Box::new(Triangles::new(&scene, flaw))), law, "{flaw:?}");
    }
    type Break = fn(&mut Hats);
    let flaws: [(&str, Break, Option<Law>); 6] = [
        ("nothing", |_| (), None),
        ("other corners are read", |h| h.read_nodes[5].rotate_left(1), Some(Law::CornerNodes)),
        ("a triangle is missing", |h| h.corner_nodes.truncate(79), Some(Law::CornerNodes)),
        (
            "both have other corners",
            |h| {
                h.read_nodes[5].rotate_left(1);
                h.corner_nodes[5].rotate_left(1);
            },
            Some(Law::LinearFunctions),
        ),
        (
            "nobody has neighbours",
            |h| h.adjacency = Adjacency::from_cells::<3>(h.node_count(), [].into_iter()),
            Some(Law::Adjacency),
        ),
        (
            "one triangle makes no neighbours",
            |h| {
                let cells = h.corner_nodes.iter().skip(1).copied();
                let apart = cells.filter(|cell| !h.corner_nodes[0].iter().any(|node| cell.contains(node)));
                h.adjacency = Adjacency::from_cells(h.node_count(), apart);
            },
            Some(Law::Adjacency),
        ),
    ];
    for (what, flaw, law) in flaws {
        let make = |scene| -> Box<dyn Basis> {
            let mut hats = Hats::new(scene);
            flaw(&mut hats);
            Box::new(hats)
        };
        assert_eq!(broken(&make), law, "{what}");
    }
}

/// Triangles that count towards their corners, with something wrong.
struct Broken {
    inner: AreaReceivers,
    sampling: Sampling,
    nodes: fn(&mut Vec<NodeId>),
    site: fn(&mut Site),
    towards: fn(&mut NodeWeights),
    corners: fn(&mut ([NodeId; 3], f32)),
    identity: fn(Identity) -> Identity,
    extra_nodes: usize,
}

impl Receivers for Broken {
    fn identity(&self) -> Identity {
        (self.identity)(self.inner.identity())
    }

    fn node_count(&self) -> usize {
        self.inner.node_count() + self.extra_nodes
    }

    fn element_count(&self) -> usize {
        self.inner.element_count()
    }

    fn sampling(&self) -> Sampling {
        self.sampling
    }

    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>) {
        self.inner.nodes_of(element, nodes);
        (self.nodes)(nodes);
    }

    fn site(&self, element: ElementId, u: [f32; 2]) -> Site {
        let mut site = self.inner.site(element, u);
        (self.site)(&mut site);
        site
    }

    fn towards(&self, element: ElementId, u: [f32; 2], nodes: &mut NodeWeights) {
        self.inner.towards(element, u, nodes);
        (self.towards)(nodes);
    }

    fn corners(&self, element: ElementId) -> Option<([NodeId; 3], f32)> {
        let mut corners = self.inner.corners(element)?;
        (self.corners)(&mut corners);
        Some(corners)
    }
}

#[test]
fn each_law_of_receivers_can_fail() {
    let (_, builder) = scenes().into_iter().find(|(kind, _)| *kind == "round").unwrap();
    type Break = fn(&mut Broken);
    let flaws: [(&str, Break, Option<Law>); 12] = [
        ("nothing", |_| (), None),
        ("a node is not announced", |b| b.nodes = |nodes| nodes.truncate(2), Some(Law::NodesOf)),
        ("a node does not exist", |b| b.nodes = |nodes| nodes.push(NodeId(1 << 20)), Some(Law::NodesOf)),
        ("a node is never measured", |b| b.extra_nodes = 1, Some(Law::NodesOf)),
        (
            "a weight is negative",
            |b| {
                b.towards = |to| {
                    let (node, _) = to.iter().next().unwrap();
                    to.push(node, -0.1);
                }
            },
            Some(Law::Weights),
        ),
        ("sites count towards nothing", |b| b.towards = |to| to.clear(), Some(Law::Weights)),
        ("a corner is another", |b| b.corners = |(nodes, _)| nodes.swap(0, 1), Some(Law::CornerNodes)),
        ("an origin is nowhere", |b| b.site = |site| site.origin.x = f32::NAN, Some(Law::Sites)),
        ("a normal is long", |b| b.site = |site| site.frame.normal *= 1.01, Some(Law::Sites)),
        ("a frame is left-handed", |b| b.site = |site| site.frame.tangent *= -1.0, Some(Law::Sites)),
        ("areas are called points", |b| b.sampling = Sampling::Point, Some(Law::Sites)),
        ("all have one identity", |b| b.identity = |_| Identity::new("", []), Some(Law::Identity)),
    ];
    for (what, flaw, law) in flaws {
        let make = |scene| -> Box<dyn Receivers> {
            let mut broken = Broken {
                inner: AreaReceivers::new(Arc::new(VertexBasis::new(scene))),
                sampling: Sampling::Area,
                nodes: |_| (),
                site: |_| (),
                towards: |_| (),
                corners: |_| (),
                identity: |identity| identity,
                extra_nodes: 0,
            };
            flaw(&mut broken);
            Box::new(broken)
        };
        let found = receiver_laws(&builder, &make).err();
        assert_eq!(found.as_ref().map(|violation| violation.law), law, "{what}: {found:?}");
    }
}
