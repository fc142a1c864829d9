//! What an unwrap did.

use crate::Atlas;
use crate::chart::signed_area;
use lumel_scene::{ObjectId, Scene, TriId};
use std::fmt;

/// How the charts of an object were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// As the file lays it out: its lightmap coordinates are kept.
    Given,
    /// Flattened with little change of angles: few charts, also on curved surfaces.
    Conformal,
    /// Nearly flat parts, seen from their front.
    Planar,
    /// A chart for each triangle.
    Triangles,
}

impl Method {
    /// What does with less.
    pub(crate) fn simpler(self) -> Self {
        match self {
            Self::Given => Self::Conformal,
            Self::Conformal => Self::Planar,
            Self::Planar | Self::Triangles => Self::Triangles,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Conformal => "conformal",
            Self::Planar => "planar",
            Self::Triangles => "triangles",
        }
    }
}

/// Something that did not go as it was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The name of the object, if it is of one.
    pub object: Option<String>,
    /// What, as a sentence without a stop.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.object {
            Some(object) => write!(f, "object \"{object}\": {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

/// What became of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectReport {
    /// Which one.
    pub object: ObjectId,
    /// How its charts were made.
    pub method: Method,
    /// Number of its charts.
    pub charts: usize,
    /// Number of its triangles, backs included.
    pub triangles: usize,
    /// Lumels per metre, the least of its charts.
    pub density: f32,
    /// The smallest and largest area of triangles on the page, in parts of what their charts' density asks for.
    pub stretch: [f32; 2],
    /// What its triangles cover, lumels.
    pub lumels: f64,
}

/// What an unwrap did.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// By object that has triangles.
    pub objects: Vec<ObjectReport>,
    /// The part of all lumels that triangles cover.
    pub utilization: f64,
    /// The 1st, 50th and 99th percentile of the areas of triangles on the page, in parts of what their charts' density asks
    /// for; weighted by area.
    pub stretch: [f32; 3],
    /// Whether the page is the square on which the file lays out all objects.
    pub is_shared: bool,
    /// What did not go as it was asked for.
    pub findings: Vec<Finding>,
}

impl Report {
    pub(crate) fn new(
        scene: &Scene,
        atlas: &Atlas,
        methods: &[(ObjectId, Method)],
        is_shared: bool,
        findings: Vec<Finding>,
    ) -> Self {
        let mut objects: Vec<ObjectReport> = Vec::with_capacity(methods.len());
        let mut index = vec![usize::MAX; scene.object_names().len()];
        for &(object, method) in methods {
            index[object.index()] = objects.len();
            let (density, stretch) = (f32::INFINITY, [f32::INFINITY, 0.0]);
            objects.push(ObjectReport {
                object,
                method,
                charts: 0,
                triangles: 0,
                density,
                stretch,
                lumels: 0.0,
            });
        }
        for place in atlas.charts() {
            let report = &mut objects[index[place.object.index()]];
            report.charts += 1;
            report.density = report.density.min(place.density);
        }
        let mut stretches = Vec::with_capacity(atlas.triangle_count());
        for tri in (0..atlas.triangle_count() as u32).map(TriId) {
            let lumels = signed_area(atlas.corners(tri).map(|c| c.as_dvec2())).abs();
            let place = &atlas.charts()[atlas.chart(tri)];
            let asked = f64::from(scene.area(tri)) * f64::from(place.density).powi(2);
            let report = &mut objects[index[place.object.index()]];
            report.triangles += 1;
            report.lumels += lumels;
            // Of what is less than a hundredth of a lumel, rounding is a part.
            if asked > 0.01 {
                let stretch = (lumels / asked) as f32;
                report.stretch = [report.stretch[0].min(stretch), report.stretch[1].max(stretch)];
                stretches.push((stretch, asked));
            }
        }
        for report in objects.iter_mut().filter(|report| report.stretch[0] > report.stretch[1]) {
            report.stretch = [1.0; 2];
        }
        let covered: f64 = objects.iter().map(|report| report.lumels).sum();
        Self {
            utilization: covered / atlas.lumel_count() as f64,
            stretch: [0.01, 0.5, 0.99].map({
                stretches.sort_by(|a, b| a.0.total_cmp(&b.0));
                |part| percentile(&stretches, part)
            }),
            objects,
            is_shared,
            findings,
        }
    }

    /// Number of objects that keep the layout of their file.
    pub fn kept_count(&self) -> usize {
        self.objects.iter().filter(|report| report.method == Method::Given).count()
    }

    /// Number of charts.
    pub fn chart_count(&self) -> usize {
        self.objects.iter().map(|report| report.charts).sum()
    }
}

/// The value below which a part of the weight lies; the values are ascending.
fn percentile(values: &[(f32, f64)], part: f64) -> f32 {
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    for &(value, weight) in values {
        below += weight;
        if below >= part * total {
            return value;
        }
    }
    1.0
}
