//! The charts of one object.

use crate::chart::Chart;
use crate::given::Layout;
use crate::topology::Topology;
use crate::{Method, Pace, UvError, conformal, planar};
use lumel_scene::Scene;

/// The charts of an object and how they were made.
pub(crate) struct ObjectCharts {
    pub(crate) charts: Vec<Chart>,
    pub(crate) method: Method,
    /// The layout that the file gives, if it is kept.
    pub(crate) layout: Option<Layout>,
    /// Why it is not, although there is one.
    pub(crate) not_kept: Option<String>,
    /// Why a simpler method had to do.
    pub(crate) reason: Option<String>,
}

impl ObjectCharts {
    fn new(charts: Vec<Chart>, method: Method, reason: Option<String>) -> Self {
        Self { charts, method, layout: None, not_kept: None, reason }
    }

    /// What there is to tell about how they were made.
    pub(crate) fn messages(&self) -> impl Iterator<Item = String> {
        let not_kept =
            self.not_kept.iter().map(|why| format!("its lightmap coordinates are not kept: {why}"));
        let method = self.method.name();
        not_kept.chain(self.reason.iter().map(move |why| format!("it has {method} charts: {why}")))
    }
}

/// The charts of an object by a method, or by the next simpler one if that fails.
pub(crate) fn charts_of(
    scene: &Scene,
    topology: &Topology,
    method: Method,
    pace: &(dyn Fn() -> Pace + Sync),
) -> Result<ObjectCharts, UvError> {
    if pace() == Pace::Stop {
        return Err(UvError::Stopped);
    }
    let planar = |reason| {
        let all: Vec<u32> = (0..topology.len() as u32).collect();
        ObjectCharts::new(planar::charts(scene, topology, &all), Method::Planar, reason)
    };
    match method {
        Method::Given => match Layout::new(scene, topology) {
            Ok(Some(layout)) => {
                let charts = vec![layout.chart(topology)];
                Ok(ObjectCharts { layout: Some(layout), ..ObjectCharts::new(charts, method, None) })
            }
            Ok(None) => charts_of(scene, topology, method.simpler(), pace),
            Err(why) => {
                let charts = charts_of(scene, topology, method.simpler(), pace)?;
                Ok(ObjectCharts { not_kept: Some(why), ..charts })
            }
        },
        Method::Conformal => Ok(match conformal::charts(scene, topology, pace)? {
            conformal::Result::Charts(mut charts, without) => {
                charts.extend(planar::charts(scene, topology, &without));
                ObjectCharts::new(charts, method, None)
            }
            conformal::Result::Refused(reason) => planar(Some(reason)),
        }),
        Method::Planar => Ok(planar(None)),
        Method::Triangles => Ok(ObjectCharts::new(planar::single_triangles(scene, topology), method, None)),
    }
}

/// The charts by a simpler method, because those that there are have a fault.
pub(crate) fn simpler_charts(
    scene: &Scene,
    topology: &Topology,
    charts: &ObjectCharts,
    fault: String,
    pace: &(dyn Fn() -> Pace + Sync),
) -> Result<ObjectCharts, UvError> {
    let simpler = charts_of(scene, topology, charts.method.simpler(), pace)?;
    Ok(match charts.method {
        Method::Given => ObjectCharts { not_kept: Some(fault), ..simpler },
        _ => ObjectCharts { not_kept: charts.not_kept.clone(), reason: Some(fault), ..simpler },
    })
}
