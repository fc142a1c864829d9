//! Faults of layouts that files give which are too slight to give them up for.

use crate::{Atlas, Fault, Finding};
use lumel_scene::{ObjectId, Scene, TriId};
use std::collections::{BTreeMap, BTreeSet};

/// The share of an object's area that may have a fault where a file gives the layout: programs flatten slivers badly. The
/// layout of `House2` of the house has twelve such faults, with 0.10 % of its area.
pub(crate) const SLIGHT: f64 = 2.5e-3;

/// What has a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Triangle(TriId),
    Chart(usize),
    All,
}

/// The faults that are not slight, and what to tell of the others.
pub(crate) fn serious(
    faults: Vec<Fault>,
    atlas: &Atlas,
    scene: &Scene,
    is_given: impl Fn(ObjectId) -> bool,
) -> (Vec<Fault>, Vec<Finding>) {
    let is_of_given = |fault: &Fault| fault.object(scene).is_some_and(&is_given);
    if !faults.iter().any(is_of_given) {
        return (faults, Vec::new());
    }
    let mut of_charts = vec![0.0; atlas.charts().len()];
    let mut of_objects: BTreeMap<ObjectId, f64> = BTreeMap::new();
    for tri in (0..atlas.triangle_count() as u32).map(TriId) {
        let area = f64::from(scene.area(tri));
        of_charts[atlas.chart(tri)] += area;
        *of_objects.entry(scene.object_id(tri)).or_default() += area;
    }
    // Each triangle and chart once, however many it lies on.
    let mut counted = BTreeSet::new();
    let mut faulty: BTreeMap<ObjectId, (usize, f64)> = BTreeMap::new();
    for fault in faults.iter().filter(|fault| is_of_given(fault)) {
        let smaller = |a: TriId, b: TriId| if scene.area(a) < scene.area(b) { a } else { b };
        let chart = |tri: TriId| (atlas.chart(tri), of_charts[atlas.chart(tri)]);
        let (part, area) = match *fault {
            Fault::Mirrored(tri) => (Part::Triangle(tri), f64::from(scene.area(tri))),
            Fault::Overlap { tri, other } => {
                let tri = smaller(tri, other);
                (Part::Triangle(tri), f64::from(scene.area(tri)))
            }
            Fault::Gutter { tri, other, .. } => {
                let (a, b) = (chart(tri), chart(other));
                let (chart, area) = if a.1 < b.1 { a } else { b };
                (Part::Chart(chart), area)
            }
            Fault::OtherScene | Fault::NotFinite(_) | Fault::OutsidePage(_) => (Part::All, f64::INFINITY),
        };
        if let Some(object) = fault.object(scene).filter(|_| counted.insert(part)) {
            let (n, sum) = faulty.entry(object).or_default();
            (*n, *sum) = (*n + 1, *sum + area);
        }
    }
    faulty.retain(|object, (_, area)| *area <= SLIGHT * of_objects[object]);
    let is_slight = |fault: &Fault| fault.object(scene).is_some_and(|object| faulty.contains_key(&object));
    let serious = faults.into_iter().filter(|fault| !is_slight(fault)).collect();
    let finding = |(object, (n, area)): (&ObjectId, &(usize, f64))| Finding {
        object: Some(scene.object_names()[object.index()].clone()),
        message: format!(
            "its lightmap coordinates are kept, though {n} of its triangles or charts, {:.2} % of its area, lie on others or too near to them",
            100.0 * area / of_objects[object]
        ),
    };
    (serious, faulty.iter().map(finding).collect())
}
