//! A scene report as text.

use super::{
    AutoReport, EdgeReport, Emissive, LayerReport, LightKind, LightReport, MaterialReport, SceneReport,
    TextureReport,
};
use crate::report::{counted, place, significant, triple};

/// Further objects are only counted.
const MAX_OBJECTS: usize = 12;
/// Width of the labels on the left.
const LABEL: usize = 12;

impl SceneReport {
    /// Aligned lines.
    pub(crate) fn text(&self) -> String {
        let mut page = Page::default();
        page.row("scene", &self.name);
        let triangles = &self.triangles;
        let sides = match triangles.back_sides {
            0 => triangles.total.to_string(),
            n => format!("{}: {} front faces and {n} back faces", triangles.total, triangles.traced),
        };
        let transparent = match triangles.transparent {
            0 => String::new(),
            n => format!("; light passes through {n}"),
        };
        page.row("triangles", &(sides + &transparent));
        page.row("vertices", &self.vertices.to_string());
        page.row("edges", &self.edges.line());
        if let Some(auto) = &self.auto {
            page.row("max-edge", &auto.line());
        }
        page.row("bounds", &format!("{} to {} m", place(self.bounds[0]), place(self.bounds[1])));
        page.row("size", &format!("{} m", self.size.map(|side| significant(f64::from(side))).join(" x ")));
        page.row("area", &format!("{} m²", significant(self.area)));
        page.row("objects", &self.objects_line());
        page.list("materials", self.materials.iter().map(MaterialReport::line));
        page.list("lights", self.lights.iter().map(LightReport::line));
        page.list("layers", self.layers.iter().map(LayerReport::line));
        page.row("emissive", &self.emissive.line());
        page.row(
            "sky",
            &match self.sky {
                [0.0, 0.0, 0.0] => "none".to_owned(),
                sky if self.sky_kind == "uniform" => format!("{} W/(m² sr)", triple(sky)),
                sky => format!("{}, mean {} W/(m² sr)", self.sky_kind, triple(sky)),
            },
        );
        let cameras = self.cameras.iter().map(|camera| {
            let (position, forward) = (place(camera.position), triple(camera.forward));
            let fov = significant(f64::from(camera.fov_deg));
            format!("\"{}\" at {position}, facing {forward}, {fov}° vertical field of view", camera.name)
        });
        page.list("cameras", cameras);
        page.row("warnings", &self.warnings.len().to_string());
        page.0
    }

    fn objects_line(&self) -> String {
        let shown: Vec<String> =
            self.objects.iter().take(MAX_OBJECTS).map(|name| format!("\"{name}\"")).collect();
        let more = self.objects.len() - shown.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{}: {}{more}", self.objects.len(), shown.join(", "))
    }
}

impl EdgeReport {
    fn line(&self) -> String {
        let Self { min, p5, median, p95, max } = self;
        let [min, p5, median, p95, max] = [min, p5, median, p95, max].map(|&length| significant(length));
        format!("{min} to {max} m; 5% {p5} m, median {median} m, 95% {p95} m")
    }
}

impl AutoReport {
    fn line(&self) -> String {
        match self.max_edge {
            None => "auto leaves the mesh as it is".to_owned(),
            Some(length) => {
                let vertices = counted(self.vertices, "vertex", "vertices");
                format!("auto splits to at most {} m: {vertices}", significant(f64::from(length)))
            }
        }
    }
}

impl MaterialReport {
    fn line(&self) -> String {
        let mut line = format!("\"{}\" albedo {}", self.name, triple(self.albedo));
        for TextureReport { role, name, size: [width, height] } in &self.textures {
            line += &format!(", {role} texture \"{name}\" {width}x{height}");
        }
        if self.emission != [0.0; 3] {
            line += &format!(", emits {} W/(m² sr)", triple(self.emission));
        }
        line += match (self.sides, self.back_sides) {
            ("both", _) => ", two-sided",
            ("shape", 1..) if 2 * self.back_sides == self.triangles => ", two-sided by its shape",
            ("shape", 1..) => ", two-sided in part by its shape",
            ("shape", 0) => ", one-sided by its shape",
            _ => "",
        };
        for transparency in &self.transparency {
            line += &format!(", {transparency}");
        }
        let triangles = counted(self.triangles, "triangle", "triangles");
        line + &format!(", {triangles}, {} m²", significant(self.area))
    }
}

impl LightReport {
    fn line(&self) -> String {
        format!("\"{}\" {}", self.name, self.kind.line())
    }
}

impl LayerReport {
    fn line(&self) -> String {
        let counts = [
            (self.lights, counted(self.lights, "light", "lights")),
            (self.materials, counted(self.materials, "emissive material", "emissive materials")),
        ];
        let parts: Vec<String> = counts.into_iter().filter(|(n, _)| *n > 0).map(|(_, text)| text).collect();
        match (self.lights + self.materials, parts.as_slice()) {
            (1, _) => format!("\"{}\"", self.name),
            (_, parts) => format!("\"{}\": a group of {}", self.name, parts.join(" and ")),
        }
    }
}

impl LightKind {
    fn line(&self) -> String {
        match self {
            Self::Rect { center, size, normal, radiance, power } => {
                let [width, height] = size.map(|side| significant(f64::from(side)));
                format!(
                    "rectangle {width} x {height} m at {}, facing {}, {} W/(m² sr), {} W",
                    place(*center),
                    triple(*normal),
                    triple(*radiance),
                    triple(*power)
                )
            }
            Self::Point { position, intensity, power } => {
                format!("point at {}, {} W/sr, {} W", place(*position), triple(*intensity), triple(*power))
            }
            Self::Spot { position, direction, intensity, outer_angle_deg } => format!(
                "spot at {}, facing {}, half-angle {}°, {} W/sr",
                place(*position),
                triple(*direction),
                significant(f64::from(*outer_angle_deg)),
                triple(*intensity)
            ),
            Self::Directional { direction, irradiance } => {
                format!("directional along {}, {} W/m²", triple(*direction), triple(*irradiance))
            }
            Self::Sun { direction, irradiance, angle_deg } => {
                let angle = significant(f64::from(*angle_deg));
                format!("sun of {angle}° along {}, {} W/m²", triple(*direction), triple(*irradiance))
            }
            Self::Disk { center, radius, normal, radiance, power } => format!(
                "disk of radius {} m at {}, facing {}, {} W/(m² sr), {} W",
                significant(f64::from(*radius)),
                place(*center),
                triple(*normal),
                triple(*radiance),
                triple(*power)
            ),
            Self::Sphere { center, radius, radiance, power } => format!(
                "sphere of radius {} m at {}, {} W/(m² sr), {} W",
                significant(f64::from(*radius)),
                place(*center),
                triple(*radiance),
                triple(*power)
            ),
        }
    }
}

impl Emissive {
    fn line(&self) -> String {
        if self.triangles == 0 {
            return "none".to_owned();
        }
        let triangles = counted(self.triangles, "triangle", "triangles");
        format!("{triangles}, {} m², {} W", significant(self.area), self.power.map(significant).join(" "))
    }
}

/// Labels on the left, values on the right.
#[derive(Default)]
struct Page(String);

impl Page {
    fn row(&mut self, label: &str, text: &str) {
        self.0 += &format!("{label:LABEL$}{text}\n");
    }

    fn list(&mut self, label: &str, lines: impl ExactSizeIterator<Item = String>) {
        if lines.len() == 0 {
            self.row(label, "none");
        }
        for (i, line) in lines.enumerate() {
            self.row(if i == 0 { label } else { "" }, &line);
        }
    }
}
