//! What the vertices of the picture hold: light, or numbers about the mesh.

use crate::prefs::{Unit, ViewMode};
use crate::selection::{Illumination, Selection};
use glam::Vec3;
use lumel::{Coefficients, IncidentRadiance, Moment, Scene};
use lumel_render_cpu::{FalseColor, Legend, Scale};
use lumel_scene::{Radiance, luminance};

/// Colour of vertices and lumels that were measured, linear.
pub(crate) const VALID: Vec3 = Vec3::new(0.45, 0.5, 0.52);

/// Colour of those that lie inside geometry.
pub(crate) const INVALID: Vec3 = Vec3::new(0.9, 0.06, 0.03);

/// Colour of those of which nothing is known.
pub(crate) const UNKNOWN: Vec3 = Vec3::new(0.12, 0.12, 0.12);

/// One value for each vertex, for a way of looking at the scene; `None` where there is nothing to show.
pub fn of_vertices(
    mode: ViewMode,
    scene: &Scene,
    light: &Illumination,
    selection: Selection,
) -> Option<Vec<Vec3>> {
    let n = scene.vertex_count();
    match mode {
        ViewMode::Final | ViewMode::Irradiance | ViewMode::FalseColor => Some(light.select(selection, n)),
        ViewMode::Albedo | ViewMode::Normals => Some(vec![Vec3::ZERO; n]),
        ViewMode::StandardError => light.standard_error.as_ref().map(|e| e.to_vec()),
        ViewMode::Validity => Some(validity(n, &light.valid)),
        ViewMode::TriangleSize => Some(edge_lengths(scene).into_iter().map(Vec3::splat).collect()),
        ViewMode::Moment(moment) => moments(moment, light.select_directional(selection, n)?),
        // Those are known to the solve, the mesh and the lightmap.
        ViewMode::Unshot
        | ViewMode::Bends
        | ViewMode::LumelDensity
        | ViewMode::Chequerboard
        | ViewMode::Charts
        | ViewMode::Seams => None,
    }
}

/// Light to see a scene by before it is solved: from above and a little from the sides, so that shapes can be read.
pub fn preview(scene: &Scene) -> Vec<Vec3> {
    let from = |n: Vec3| Radiance::splat(0.55 + 0.25 * n.y + 0.12 * n.x + 0.08 * n.z);
    scene.normals().iter().map(|&n| from(n).cosine_sample().0).collect()
}

/// A moment of the light at every vertex; `None` where it is not known.
fn moments(moment: Moment, light: &Coefficients) -> Option<Vec<Vec3>> {
    let of_vertex = |vertex| Some(moment.of(&IncidentRadiance::new(light.of(vertex))?));
    (0..light.len()).map(of_vertex).collect::<Option<_>>().filter(|_| moment.is_in(light.kind()))
}

fn validity(n: usize, valid: &[bool]) -> Vec<Vec3> {
    let color = |v: usize| valid.get(v).map_or(UNKNOWN, |valid| if *valid { VALID } else { INVALID });
    (0..n).map(color).collect()
}

/// The mean length of the edges around each vertex, metres.
pub fn edge_lengths(scene: &Scene) -> Vec<f32> {
    let mut sums = vec![(0.0, 0.0); scene.vertex_count()];
    for corners in scene.triangles() {
        for k in 0..3 {
            let [a, b] = [corners[k], corners[(k + 1) % 3]].map(|v| v as usize);
            let length = scene.positions()[a].distance(scene.positions()[b]);
            for end in [a, b] {
                sums[end].0 += length;
                sums[end].1 += 1.0;
            }
        }
    }
    sums.into_iter().map(|(sum, n): (f32, f32)| sum / n.max(1.0)).collect()
}

/// The range that shows most of some values as colours.
pub fn automatic_range(values: &[Vec3], scale: Scale) -> [f32; 2] {
    let settings = FalseColor { range: None, scale, legend: Legend::Hidden };
    settings.range_for(values.iter().map(|v| luminance(*v)).collect())
}

/// The range that shows most of some values of both signs as colours: zero is in the middle.
pub fn signed_range(values: &[Vec3]) -> [f32; 2] {
    let settings = FalseColor { legend: Legend::Hidden, ..FalseColor::default() };
    settings.signed_range_for(values.iter().map(|v| luminance(*v)).collect())
}

/// A luminance in W/m² as text in a unit.
pub fn in_unit(value: f32, unit: Unit, efficacy: f32) -> String {
    match unit {
        Unit::Watts => significant(value),
        Unit::Lux => significant(value * efficacy),
        Unit::Stops if value > 0.0 => format!("{:+.2}", value.log2()),
        Unit::Stops => "-".to_owned(),
    }
}

/// Three significant digits.
pub fn significant(value: f32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&digits) {
        return format!("{value:.2e}");
    }
    format!("{value:.*}", (2.0 - digits).max(0.0) as usize)
}

/// A share in percent, with two significant digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent >= 10.0 {
        format!("{percent:.0} %")
    } else {
        let digits = (1.0 - percent.max(1e-6).log10().floor()).clamp(0.0, 5.0) as usize;
        format!("{percent:.digits$} %")
    }
}

/// A number with its thousands apart.
pub fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn cornell() -> Scene {
        lumel::open("cornell-box", &lumel::OpenOptions::default()).unwrap().builder.build().unwrap().0
    }

    #[test]
    fn every_mode_but_an_unknown_error_has_a_value_for_each_vertex() {
        let scene = cornell();
        for mode in ViewMode::ALL {
            let values = of_vertices(mode, &scene, &Illumination::default(), Selection::All);
            assert_eq!(
                values.map(|v| v.len()),
                (!matches!(
                    mode,
                    ViewMode::StandardError | ViewMode::Unshot | ViewMode::Bends | ViewMode::Moment(_)
                ) && !mode.needs_lumels())
                .then(|| scene.vertex_count()),
                "{mode:?}"
            );
        }
    }

    #[test]
    fn invalid_vertices_are_red() {
        let scene = cornell();
        let mut valid = vec![true; scene.vertex_count()];
        valid[7] = false;
        let light = Illumination { valid: Arc::new(valid), ..Illumination::default() };
        let values = of_vertices(ViewMode::Validity, &scene, &light, Selection::All).unwrap();
        assert_eq!((values[7], values[8]), (INVALID, VALID));
    }

    #[test]
    fn edges_are_as_long_as_they_are() {
        let lengths = edge_lengths(&cornell());
        // Cornell's walls are 0.55 m wide and split into some 40 edges.
        assert!(
            lengths.iter().all(|l| (0.001..0.1).contains(l)),
            "{:?}",
            lengths.iter().copied().fold(0.0, f32::max)
        );
    }

    #[test]
    fn numbers_have_three_digits_and_units() {
        assert_eq!(
            [0.0, 1.0, 12.345, 1234.5, 0.001_234, 1e-9].map(significant),
            ["0", "1.00", "12.3", "1234", "0.00123", "1.00e-9"]
        );
        assert_eq!(in_unit(2.0, Unit::Lux, 179.0), "358");
        assert_eq!(in_unit(2.0, Unit::Stops, 179.0), "+1.00");
        assert_eq!(in_unit(0.0, Unit::Stops, 179.0), "-");
    }

    #[test]
    fn shares_have_two_digits() {
        assert_eq!([1.0, 0.1, 0.01, 0.000_316].map(percent), ["100 %", "10 %", "1.0 %", "0.032 %"]);
    }

    #[test]
    fn thousands_are_apart() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1 000", "1 234 567"]);
    }
}
