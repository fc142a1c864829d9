//! The charts of one object.

use crate::chart::Chart;
use crate::topology::Topology;
use crate::{Method, Pace, UvError, conformal, planar};
use lumel_scene::Scene;

/// The charts of an object and how they were made.
pub(crate) struct ObjectCharts {
    pub(crate) charts: Vec<Chart>,
    pub(crate) method: Method,
    /// Why a simpler method had to do.
    pub(crate) reason: Option<String>,
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
        ObjectCharts { charts: planar::charts(scene, topology, &all), method: Method::Planar, reason }
    };
    match method {
        Method::Conformal => Ok(match conformal::charts(scene, topology, pace)? {
            conformal::Result::Charts(mut charts, without) => {
                charts.extend(planar::charts(scene, topology, &without));
                ObjectCharts { charts, method, reason: None }
            }
            conformal::Result::Refused(reason) => planar(Some(reason)),
        }),
        Method::Planar => Ok(planar(None)),
        Method::Triangles => {
            Ok(ObjectCharts { charts: planar::single_triangles(scene, topology), method, reason: None })
        }
    }
}
