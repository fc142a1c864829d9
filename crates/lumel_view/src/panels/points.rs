//! The scattered points that carry light: how many there are, and how they are shown.

use crate::point_light::PointIllumination;
use crate::prefs::{NodeColors, ViewPrefs};
use crate::session::Session;
use crate::values::{grouped, significant};
use crate::widgets::{choice, heading, hint, number, slider};
use eframe::egui::{DragValue, Slider, Ui};
use lumel::setting::{LEVELS, POINT_SPACING};
use lumel::{Adaptive, Directional, Layers, PointSpacing, Preset, ScheduleKind, Settings, TargetError};

/// The offered numbers of points.
const COUNTS: [u32; 2] = [100, 10_000_000];

/// The offered spacings, diagonals of the scene.
const SPACINGS: [f32; 2] = [2e-4, 0.5];

/// Whether points are counted, or said to be so far apart.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Count,
    Spacing,
}

/// How many points carry light, if points do.
pub(super) fn show(session: &mut Session, ui: &mut Ui) {
    if session.settings.point_spacing == PointSpacing::Off {
        return;
    }
    let diagonal = session.document.as_ref().map_or(1.0, |document| document.diagonal());
    let finest = session.light.points.as_ref().and_then(finest);
    let spacing = &mut session.settings.point_spacing;
    if *spacing == PointSpacing::Auto {
        *spacing = PointSpacing::Points(Preset::default().point_budget());
    }
    let before = if let PointSpacing::Metres(_) = spacing { Kind::Spacing } else { Kind::Count };
    let mut kind = before;
    let name = |kind| match kind {
        Kind::Count => "Number".to_owned(),
        Kind::Spacing => "Spacing".to_owned(),
    };
    choice(ui, "Points by", &POINT_SPACING.about.help(), &mut kind, &[Kind::Count, Kind::Spacing], name);
    if kind != before {
        // As fine as they were.
        *spacing = match kind {
            Kind::Count => {
                let count = finest.map_or(Preset::default().point_budget(), |(count, _)| count as u32);
                PointSpacing::Points(count.clamp(COUNTS[0], COUNTS[1]))
            }
            Kind::Spacing => PointSpacing::Metres(finest.map_or(0.01 * diagonal, |(_, spacing)| spacing)),
        };
    }
    match spacing {
        PointSpacing::Points(count) => {
            let speed = 0.01 * f64::from(*count);
            let drag = DragValue::new(count).range(COUNTS[0]..=COUNTS[1]).speed(speed);
            number(ui, "Points", "About so many on the finest level", drag);
        }
        PointSpacing::Metres(metres) => {
            let range = SPACINGS[0] * diagonal..=SPACINGS[1] * diagonal;
            let speed = 0.01 * f64::from(*metres);
            let drag = DragValue::new(metres).range(range).speed(speed).max_decimals(5).suffix(" m");
            number(ui, "Spacing", "How far points are apart at least, on the finest level", drag);
        }
        PointSpacing::Off | PointSpacing::Auto => {}
    }
    let [least, most] = LEVELS.about.offered.unwrap_or([1.0, 1.0]).map(|level| level as u32);
    let levels = Slider::new(&mut session.settings.levels, least..=most);
    slider(ui, LEVELS.about.label, &LEVELS.about.help(), levels);
    hint(
        ui,
        "Points do without layers, directions and a mesh that follows light; levels also without shots and a target error.",
    );
    if let Some(points) = &session.light.points {
        hint(ui, &summary(points));
    }
}

/// How many points the finest level has, and how far they are apart at least, metres.
fn finest(light: &PointIllumination) -> Option<(usize, f32)> {
    // Levels come one after the other.
    let points = light.cloud.points();
    let last = points.last()?;
    let before = points.partition_point(|point| point.level < last.level);
    // Kernels reach over two spacings.
    Some((points.len() - before, 0.5 * last.radius))
}

/// What carries the light that is shown, in a few words.
fn summary(light: &PointIllumination) -> String {
    let levels = match light.cloud.level_count() {
        1 => String::new(),
        levels => format!(" on {levels} levels"),
    };
    let spacing = finest(light).map_or(0.0, |(_, spacing)| spacing);
    format!("{} points{levels}, {} m apart", grouped(light.cloud.points().len()), significant(spacing))
}

/// Takes back what does not go together with points or with their levels.
pub(super) fn fit(settings: &mut Settings) {
    if settings.point_spacing == PointSpacing::Off {
        settings.levels = 1;
        return;
    }
    (settings.adaptive, settings.layers) = (Adaptive::Off, Layers::Off);
    settings.directional = Directional::Off;
    if settings.levels > 1 {
        (settings.target_error, settings.schedule) = (TargetError::Off, ScheduleKind::Gather);
    }
}

/// How points and their light are shown, if points carry it.
pub(super) fn display(session: &Session, view: &mut ViewPrefs, ui: &mut Ui) {
    let Some(light) = &session.light.points else { return };
    heading(ui, "Points");
    let about = "The points that carry light, with rings as far as some of the finest ones reach";
    choice(ui, "Point dots", about, &mut view.nodes, &NodeColors::ALL, |colors| colors.name().to_owned());
    let last = light.cloud.level_count().saturating_sub(1);
    if last > 0 {
        let mut finest = view.finest_level.min(last);
        let about = "The finest level of points that is shown; 0 is the coarsest";
        slider(ui, "Finest level", about, Slider::new(&mut finest, 0..=last));
        // All stays all where there are more.
        view.finest_level = if finest == last { u32::MAX } else { finest };
    }
}
