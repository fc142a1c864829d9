//! Which sites nobody can see: inside geometry, behind a sheet that cuts the surface they lie on, or under something that
//! almost touches it.
//!
//! A site from which much of the hemisphere meets backs is not hidden for that alone: a floor under a one-sided awning is
//! in its shade. What tells the two apart:
//!
//! - the backs of a [closed shell](lumel_scene::Scene::bounds_solid) are seen from inside a solid;
//! - open shells that stand on a floor, such as a box without bottom, show their backs at the horizon all around;
//! - a sheet that cuts through the site's own surface hides what is behind it.

use crate::Sums;
use crate::ends::RayEnd;
use crate::group::Group;
use crate::hemisphere;
use crate::job::{Control, TransportError};
use crate::operator::CpuTransport;
use glam::Vec3;
use lumel_accel::{Hit, Ray};
use lumel_basis::{Basis, ElementId, Receivers, Site};
use lumel_sample::{Dim, Sampler, StreamKey};
use lumel_scene::TriId;
use smallvec::SmallVec;

/// Cosine and sine of 22.5°.
const C: f32 = 0.923_879_5;
const S: f32 = 0.382_683_43;

/// Directions all around, opposite ones one after the other: most sites have a way out, which is soon found.
const CIRCLE: [[f32; 2]; 8] = [[C, S], [-C, -S], [-S, C], [S, -C], [S, C], [-S, -C], [-C, S], [C, -S]];

/// Sine of the height of the circle that looks for a way out under an awning (3°), and of the one that looks for something
/// close above (30°).
const HORIZON: f32 = 0.05;
const ABOVE: f32 = 0.5;

/// Rays over the hemisphere that decide about a site on an area, and how many must meet backs: three quarters, which an
/// origin that sees them in a third of its hemisphere reaches once in fifty times; fewer suffice behind a sheet that cuts the
/// surface, of which half the hemisphere is seen at most.
const AREA: Rule = Rule { rays: 8, inside: 6, behind: 3 };

/// At points, which have the same neighbours all around: a quarter of them.
const POINT: Rule = Rule { rays: 64, inside: 16, behind: 16 };

/// A point of which no more rays than these meet backs is not looked at again.
const MAX_BACK_FACES: f64 = 0.25;

/// Rays that are traced at once.
const BUNDLE: usize = 16;

struct Rule {
    rays: u32,
    inside: u32,
    behind: u32,
}

/// Looks around from sites of an operator's elements.
pub(crate) struct Lookout<'a, B, R> {
    op: &'a CpuTransport<B, R>,
    n_rays: u64,
    beside: Vec<Vec3>,
    directions: Vec<Vec3>,
    hits: Vec<Option<Hit>>,
}

impl<'a, B: Basis, R: Receivers> Lookout<'a, B, R> {
    pub(crate) fn new(op: &'a CpuTransport<B, R>) -> Self {
        Self { op, n_rays: 0, beside: Vec::new(), directions: Vec::new(), hits: Vec::new() }
    }

    /// How many rays it has traced.
    pub(crate) fn n_rays(&self) -> u64 {
        self.n_rays
    }

    fn hit(&mut self, ray: &Ray) -> Option<Hit> {
        self.n_rays += 1;
        self.op.tracer.closest_hit(ray)
    }

    fn meets_back(&mut self, ray: &Ray) -> bool {
        let hit = self.hit(ray);
        RayEnd::new(&self.op.scene, hit) == RayEnd::BackFace
    }

    /// Whether a site on an area, from which a ray has met a back, lies behind what it has met.
    pub(crate) fn is_behind(&mut self, element: ElementId, site: &Site, key: StreamKey) -> bool {
        self.is_behind_by(&AREA, element, site, key)
    }

    fn is_behind_by(&mut self, rule: &Rule, element: ElementId, site: &Site, key: StreamKey) -> bool {
        let stream = Sampler::Sobol.stream(key, Dim::Validity);
        let (mut of_solids, mut of_sheets) = (0, 0);
        for first in (0..rule.rays).step_by(BUNDLE) {
            let numbers = first..rule.rays.min(first + BUNDLE as u32);
            self.directions.clear();
            self.directions.extend(numbers.map(|i| hemisphere::direction(site, stream.sample_2d(i))));
            self.hits.resize(self.directions.len(), None);
            self.op.tracer.closest_hits(&hemisphere::bundle(site, &self.directions), &mut self.hits);
            self.n_rays += self.hits.len() as u64;
            for hit in self.hits.iter().flatten() {
                if RayEnd::new(&self.op.scene, Some(*hit)) == RayEnd::BackFace {
                    let is_solid = self.op.scene.bounds_solid(hit.at.tri);
                    *if is_solid { &mut of_solids } else { &mut of_sheets } += 1;
                }
            }
            // Inside a solid, that is soon known.
            if of_solids >= rule.inside {
                return true;
            }
        }
        of_solids + of_sheets >= rule.inside && self.is_enclosed(site)
            || of_sheets >= rule.behind && self.is_cut_off(element, site)
    }

    /// Whether backs are all there is at the horizon.
    fn is_enclosed(&mut self, site: &Site) -> bool {
        circle(HORIZON).all(|local| self.meets_back(&hemisphere::ray(site, site.frame.to_world(local))))
    }

    /// Whether a sheet shows its back on the way to another place of the surface.
    fn is_cut_off(&mut self, element: ElementId, site: &Site) -> bool {
        let mut beside = std::mem::take(&mut self.beside);
        beside.clear();
        self.op.receivers.beside(element, &mut beside);
        let way = |place| Ray { skip: site.skip, ..Ray::between(site.origin, place) };
        let is_cut_off = beside.iter().any(|&place| self.meets_back(&way(place)));
        self.beside = beside;
        is_cut_off
    }

    /// Whether what a ray from an element has met nearby may [cover](Self::is_covered) it: another surface.
    pub(crate) fn may_cover(&self, element: ElementId, hit: Hit) -> bool {
        let own = self.op.receivers.surface(element);
        own.is_some_and(|own| !self.op.scene.hang_together(own, hit.at.tri))
    }

    /// Whether other surfaces almost touch the one that a site lies on: within its [reach](Receivers::reach)
    /// they are all that is seen.
    ///
    /// Those that hang together with it do not count: they make a groove or a thin room, not a gap.
    pub(crate) fn is_covered(&mut self, element: ElementId, site: &Site) -> bool {
        let t_max = self.op.receivers.reach(element);
        let Some(own) = self.op.receivers.surface(element).filter(|_| t_max > 0.0) else { return false };
        let mut above = SmallVec::<[TriId; 9]>::new();
        let is_closed = std::iter::once(Vec3::Z).chain(circle(ABOVE)).all(|local| {
            let hit = self.hit(&Ray { t_max, ..hemisphere::ray(site, site.frame.to_world(local)) });
            above.extend(hit.map(|hit| hit.at.tri));
            hit.is_some()
        });
        is_closed && above.iter().all(|&tri| !self.op.scene.hang_together(own, tri))
    }
}

/// Finds the elements of a group that are measured at points which nobody can see: 1 for those, 0 for others.
///
/// `back_faces` is the share of an element's rays that have met backs.
pub(crate) fn at_points<B: Basis, R: Receivers>(
    op: &CpuTransport<B, R>,
    group: &Group,
    key: impl Fn(ElementId) -> StreamKey,
    control: &Control,
    back_faces: impl Fn(usize) -> f64,
) -> Result<Sums, TransportError> {
    let mut lookout = Lookout::new(op);
    let mut hidden = Vec::with_capacity(group.len());
    // What covers a site is met straight above it: neighbours look there together.
    let above = |(&element, site): (&ElementId, &Site)| Ray {
        t_max: op.receivers.reach(element),
        ..hemisphere::ray(site, site.frame.to_world(Vec3::Z))
    };
    let rays: Vec<Ray> = group.elements.iter().zip(&group.sites).map(above).collect();
    let mut hits = vec![None; rays.len()];
    op.tracer.closest_hits_of(&rays, &mut hits);
    for (i, (&element, site)) in group.elements.iter().zip(&group.sites).enumerate() {
        control.check()?;
        let is_hidden = back_faces(i) > MAX_BACK_FACES
            && lookout.is_behind_by(&POINT, element, site, key(element))
            || hits[i].is_some() && lookout.is_covered(element, site);
        hidden.push(f64::from(u8::from(is_hidden)));
    }
    control.count(0, rays.len() as u64 + lookout.n_rays());
    Ok(group.hidden(&hidden))
}

/// Directions all around the normal whose height has this sine.
fn circle(sine: f32) -> impl Iterator<Item = Vec3> {
    let cosine = (1.0 - sine * sine).sqrt();
    CIRCLE.into_iter().map(move |[x, y]| Vec3::new(cosine * x, cosine * y, sine))
}
