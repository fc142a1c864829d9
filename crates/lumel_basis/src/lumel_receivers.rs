//! Light measured over the surface that each lumel of an atlas covers.

use crate::{ElementId, Identity, NodeId, NodeWeights, Receivers, Sampling, Site};
use glam::{DVec2, Vec3};
use lumel_sample::Frame;
use lumel_scene::{RayOrigins, Scene, SurfacePoint, TriId};
use lumel_uv::{Atlas, Coverage, Piece};
use smallvec::SmallVec;
use std::sync::Arc;

/// Measures the mean light over what each lumel covers of the surfaces: its pieces of triangles, by area.
///
/// A lumel that nothing covers, but that is read between lumels, is measured at the nearest point of its triangle. Elements
/// and nodes are the places of lumels in [`Coverage::lumels`].
///
/// The scene may be another one than that whose surfaces rays meet: the same surfaces in fewer triangles, as they were given.
///
/// Light is that of the smooth surface which the vertex normals describe: the hemisphere is that of the interpolated
/// normal, and where the smooth surface bulges over the triangle, rays start from it, so that the flat triangles around do not
/// cast shadows on each other. After Hanika, *Hacking the Shadow Terminator*, Ray Tracing Gems II, 2021.
#[derive(Clone, Debug)]
pub struct LumelReceivers {
    scene: Arc<Scene>,
    atlas: Arc<Atlas>,
    coverage: Arc<Coverage>,
}

/// A lumel of whose square less than this is missing counts as covered whole: rounding leaves as much.
const WHOLE: f64 = 1.0 - 1e-4;

/// A place may lie so far outside all triangles of a covered lumel by rounding, in barycentrics.
const OUTSIDE: f64 = -1e-6;

impl LumelReceivers {
    /// Measures the lumels of an atlas of the scene.
    pub fn new(scene: Arc<Scene>, atlas: Arc<Atlas>, coverage: Arc<Coverage>) -> Self {
        Self { scene, atlas, coverage }
    }

    /// The pieces of triangles in a lumel.
    fn lumel(&self, element: ElementId) -> Lumel {
        let place = element.index();
        let (_, [x, y]) = self.atlas.column_and_row(self.coverage.lumels()[place] as usize);
        let shares = self.coverage.shares(place).iter();
        let pieces: SmallVec<[Piece; 2]> =
            shares.filter_map(|share| Piece::new(&self.atlas, share.tri, [x, y])).collect();
        let area = pieces.iter().map(|piece| f64::from(piece.area())).sum();
        Lumel { min: DVec2::new(f64::from(x), f64::from(y)), pieces, area }
    }

    /// What all sites on a triangle share.
    fn start(&self, tri: TriId) -> Start {
        let scene = &self.scene;
        let normal = scene.geometric_normal(tri);
        let is_flat = scene.triangle(tri).iter().all(|&v| scene.normals()[v as usize].dot(normal) > FLAT);
        Start { origins: scene.ray_origins(tri), flat: is_flat.then(|| Frame::from_normal(normal)) }
    }

    fn site_at(&self, start: &Start, at: SurfacePoint) -> Site {
        let origin = start.origins.at(at.bary.weights());
        match start.flat {
            Some(frame) => Site { origin, frame, skip: None },
            None => {
                let frame = Frame::from_normal(self.scene.shading_normal(at));
                Site { origin: origin + self.bulge(at), frame, skip: None }
            }
        }
    }

    /// How far the smooth surface lies above the triangle.
    fn bulge(&self, at: SurfacePoint) -> Vec3 {
        let (corners, point) = (self.scene.triangle(at.tri), self.scene.position(at));
        let lift = |(&vertex, weight): (&u32, f32)| {
            let vertex = vertex as usize;
            let normal = self.scene.normals()[vertex];
            let below = (self.scene.positions()[vertex] - point).dot(normal).max(0.0);
            normal * (below * weight)
        };
        corners.iter().zip(at.bary.weights()).map(lift).sum()
    }
}

/// Vertex normals as near to that of the triangle as this cosine describe no other surface.
const FLAT: f32 = 0.999_99;

/// What all sites on a triangle share.
struct Start {
    origins: RayOrigins,
    /// The frame of a triangle whose vertex normals describe no other surface.
    flat: Option<Frame>,
}

/// The pieces of triangles in a lumel.
struct Lumel {
    /// Its smallest corner on the page.
    min: DVec2,
    /// At least one.
    pieces: SmallVec<[Piece; 2]>,
    /// That is covered, in parts of the lumel.
    area: f64,
}

impl Lumel {
    /// The point of the surface that a place in the unit square stands for, uniform by area, and the number of its piece.
    fn point(&self, [u, v]: [f32; 2]) -> Option<(usize, SurfacePoint)> {
        if self.area >= WHOLE {
            let place = self.min + DVec2::new(f64::from(u), f64::from(v));
            let inside = self.pieces.iter().map(|piece| piece.at(place)).enumerate();
            let best = inside.max_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
            if let Some((number, (point, _))) = best.filter(|(_, (_, inside))| *inside > OUTSIDE) {
                return Some((number, point));
            }
        }
        // One after the other, by their areas.
        let mut left = f64::from(u) * self.area;
        for (number, piece) in self.pieces.iter().enumerate() {
            let area = f64::from(piece.area());
            if left < area {
                return Some((number, piece.point([(left / area) as f32, v])));
            }
            left -= area;
        }
        let last = self.pieces.len().checked_sub(1)?;
        Some((last, self.pieces[last].point([1.0, v])))
    }
}

impl Receivers for LumelReceivers {
    fn identity(&self) -> Identity {
        let (scene, atlas) = (self.scene.geometry_hash(), self.atlas.identity());
        Identity::new("lumels", [&scene.as_bytes()[..], atlas.as_bytes()])
    }

    fn node_count(&self) -> usize {
        self.coverage.len()
    }

    fn element_count(&self) -> usize {
        self.coverage.len()
    }

    fn sampling(&self) -> Sampling {
        Sampling::Area
    }

    fn nodes_of(&self, element: ElementId, nodes: &mut Vec<NodeId>) {
        nodes.push(NodeId(element.0));
    }

    fn site(&self, element: ElementId, u: [f32; 2]) -> Site {
        let mut sites = Vec::with_capacity(1);
        self.sites(element, &[u], &mut sites);
        sites.remove(0)
    }

    fn sites(&self, element: ElementId, places: &[[f32; 2]], sites: &mut Vec<Site>) {
        let lumel = self.lumel(element);
        let first = self.coverage.shares(element.index())[0].tri;
        let tris = lumel.pieces.iter().map(Piece::tri).chain(lumel.pieces.is_empty().then_some(first));
        let starts: SmallVec<[Start; 2]> = tris.map(|tri| self.start(tri)).collect();
        let middle = SurfacePoint { tri: first, bary: [1.0 / 3.0; 2].into() };
        sites.extend(places.iter().map(|&u| {
            let (number, at) = lumel.point(u).unwrap_or((0, middle));
            self.site_at(&starts[number], at)
        }));
    }

    fn towards(&self, element: ElementId, _: [f32; 2], nodes: &mut NodeWeights) {
        nodes.push(NodeId(element.0), 1.0);
    }

    fn beside(&self, element: ElementId, origins: &mut Vec<Vec3>) {
        let lumel = self.lumel(element);
        let corners = lumel.pieces.iter().flat_map(|piece| piece.corners());
        origins.extend(corners.map(|at| self.scene.ray_origin(at)));
    }
}
