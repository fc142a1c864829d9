//! From a scene to its atlas.

use crate::atlas::Atlas;
use crate::lay_out::lay_out;
use crate::object::{ObjectCharts, charts_of, simpler_charts};
use crate::shared::share;
use crate::slight::serious;
use crate::topology::{Topology, objects};
use crate::{Fault, Finding, GivenUvs, Method, Pace, Report, UnwrapSettings, UvError, check};
use lumel_scene::{ObjectId, Scene};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Times that objects with faults get simpler charts: once for each method that has a simpler one, and once because they
/// change the density of others.
const MOST_REPAIRS: usize = 4;

/// An atlas, and what to know about it.
#[derive(Clone, Debug)]
pub struct Unwrapped {
    /// Where light is stored.
    pub atlas: Atlas,
    /// How it went.
    pub report: Report,
}

/// Lays out the light of all triangles of a scene.
///
/// An object keeps the layout that its file gives, if it can be used ([`GivenUvs`]). The surface of any other is cut where it
/// creases, flattened and packed. The result is [checked](check()): an object with a fault gets simpler charts, down to single
/// triangles. The same scene and settings give the same atlas on any number of
/// threads and any processor, unless `pace` says that time is up: `pace` is asked now and then, from all threads.
///
/// # Errors
/// Settings outside their bounds, an atlas with more lumels than can be numbered, and [`Pace::Stop`].
pub fn unwrap(
    scene: &Scene,
    settings: &UnwrapSettings,
    pace: &(dyn Fn() -> Pace + Sync),
) -> Result<Unwrapped, UvError> {
    settings.check()?;
    let method = match settings.given {
        GivenUvs::Keep => Method::Given,
        GivenUvs::Ignore => Method::Conformal,
    };
    let mut parts: Vec<(Topology, ObjectCharts)> = objects(scene)
        .into_par_iter()
        .map(|triangles| {
            let topology = Topology::new(scene, triangles);
            let charts = charts_of(scene, &topology, method, pace)?;
            Ok((topology, charts))
        })
        .collect::<Result<_, UvError>>()?;
    if let Some((atlas, findings)) = share(scene, settings, &parts) {
        return Ok(finished(scene, atlas, &parts, true, findings));
    }
    let mut repairs = 0;
    loop {
        let (atlas, mut findings) = lay_out(scene, settings, &parts)?;
        let given = parts.iter().filter(|(_, charts)| charts.method == Method::Given);
        let given: BTreeSet<ObjectId> = given.map(|(topology, _)| topology.object).collect();
        let (faults, slight) = serious(check(&atlas, scene), &atlas, scene, |object| given.contains(&object));
        let faulty: BTreeSet<ObjectId> = faults.iter().filter_map(|fault| fault.object(scene)).collect();
        if faulty.is_empty() || repairs == MOST_REPAIRS {
            findings.extend(slight);
            findings.extend(faults.iter().map(|fault| {
                let object = fault.object(scene).map(|object| scene.object_names()[object.index()].clone());
                Finding { object, message: fault.to_string() }
            }));
            return Ok(finished(scene, atlas, &parts, false, findings));
        }
        repairs += 1;
        for (topology, charts) in parts.iter_mut().filter(|(t, _)| faulty.contains(&t.object)) {
            let fault = faults.iter().find(|fault| fault.object(scene) == Some(topology.object));
            let why = fault.map(|fault| reason(fault, charts.method, &atlas)).unwrap_or_default();
            *charts = simpler_charts(scene, topology, charts, why, pace)?;
        }
    }
}

/// Why charts by a method cannot stay.
fn reason(fault: &Fault, method: Method, atlas: &Atlas) -> String {
    match fault {
        Fault::Gutter { .. } if method == Method::Given => format!(
            "its charts are less than {} lumels apart at {:.3} lumels per metre; ask for more lumels or a smaller gutter",
            atlas.gutter(),
            atlas.density()
        ),
        _ => fault.to_string(),
    }
}

fn finished(
    scene: &Scene,
    atlas: Atlas,
    parts: &[(Topology, ObjectCharts)],
    is_shared: bool,
    mut findings: Vec<Finding>,
) -> Unwrapped {
    for (topology, charts) in parts {
        let object = || Some(scene.object_names()[topology.object.index()].clone());
        findings.extend(charts.messages().map(|message| Finding { object: object(), message }));
    }
    let methods: Vec<_> = parts.iter().map(|(t, charts)| (t.object, charts.method)).collect();
    Unwrapped { report: Report::new(scene, &atlas, &methods, is_shared, findings), atlas }
}
