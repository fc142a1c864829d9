//! What is found of one projection, and the tables of all.

use crate::paths::{BOUNCES, Paths};
use crate::place::Place;
use crate::solves::Solved;
use lumel_basis::{FieldLighting, VertexLighting};
use lumel_testkit::{Ratio, Reference, SurfaceError};
use serde_json::{Value, json};

/// What is found of one projection in one scene.
pub(crate) struct Row {
    name: &'static str,
    seconds: f64,
    /// Processor time over that of the first projection.
    cpu_ratio: f64,
    rays: u64,
    /// Power over exact: of direct light and of all light as they are read, of bounces as they are stored and as a
    /// gather reads them.
    direct_power: Ratio,
    all_power: Ratio,
    stored: Vec<Ratio>,
    gathered: Vec<Ratio>,
    direct_error: SurfaceError,
    all_error: SurfaceError,
    /// Power of the negative part of the direct light over the power of direct light.
    negative: f64,
}

impl Row {
    pub(crate) fn new(
        name: &'static str,
        [seconds, cpu_ratio]: [f64; 2],
        place: &Place,
        solved: &Solved,
        paths: &Paths,
        [direct_reference, all_reference]: [&Reference<'_>; 2],
    ) -> Self {
        let at_vertices = |values| VertexLighting::new(&place.scene, values).unwrap();
        let (direct, all) = (at_vertices(&solved.direct), at_vertices(&solved.all));
        let carried = |bounce: usize| FieldLighting { basis: &*place.basis, field: &solved.carried[bounce] };
        Self {
            name,
            seconds,
            cpu_ratio,
            rays: solved.rays,
            direct_power: paths.stored(&direct, 0..=0),
            all_power: paths.stored(&all, 0..=BOUNCES),
            stored: (1..=BOUNCES).map(|k| paths.stored(&carried(k), k..=k)).collect(),
            gathered: (1..=BOUNCES).map(|k| paths.gathered(&carried(k - 1), k)).collect(),
            direct_error: direct_reference.error_of(&direct),
            all_error: all_reference.error_of(&all),
            negative: paths.negative(&direct),
        }
    }

    pub(crate) fn json(&self) -> Value {
        let ratio = |ratio: &Ratio| json!([ratio.value, ratio.error]);
        let ratios = |ratios: &[Ratio]| ratios.iter().map(ratio).collect::<Vec<_>>();
        let error = |error: &SurfaceError| {
            json!({
                "rms": [error.rms, error.rms_error], "bias": [error.bias, error.bias_error],
                "percentile_95": error.percentile_95, "percentile_99": error.percentile_99,
            })
        };
        json!({
            "name": self.name, "seconds": self.seconds, "cpu_ratio": self.cpu_ratio,
            "rays": self.rays,
            "direct_power": ratio(&self.direct_power), "all_power": ratio(&self.all_power),
            "bounces_stored": ratios(&self.stored), "bounces_gathered": ratios(&self.gathered),
            "direct": error(&self.direct_error), "all": error(&self.all_error), "negative": self.negative,
        })
    }
}

/// Two tables: time with power, and errors.
pub(crate) fn print(rows: &[Row]) {
    let percent = |value: f64| format!("{:.2}", value * 100.0);
    let ratio = |ratio: &Ratio| format!("{:.3} ± {:.3}", ratio.value, ratio.error);
    println!(
        "\n  {:<16}{:>9}{:>8}{:>8}  {:<16}{:<60}{:<16}",
        "power", "seconds", "ratio", "Mrays", "direct", "bounces 1 to 4, gathered", "all"
    );
    for row in rows {
        let gathered: String = row.gathered.iter().map(|bounce| format!("{:<15}", ratio(bounce))).collect();
        println!(
            "  {:<16}{:>9.2}{:>8.2}{:>8.2}  {:<16}{gathered:<60}{:<16}",
            row.name,
            row.seconds,
            row.cpu_ratio,
            row.rays as f64 / 1e6,
            ratio(&row.direct_power),
            ratio(&row.all_power)
        );
    }
    println!(
        "\n  {:<16}{:<46}{:<46}{:>9}",
        "error, %", "direct: rms, 95 %, 99 %, bias", "all: rms, 95 %, 99 %, bias", "negative"
    );
    for row in rows {
        let error = |e: &SurfaceError| {
            format!(
                "{:>6} ± {:<5}{:>7}{:>8}{:>7} ± {:<5}",
                percent(e.rms),
                percent(e.rms_error),
                percent(e.percentile_95),
                percent(e.percentile_99),
                percent(e.bias),
                percent(e.bias_error)
            )
        };
        println!(
            "  {:<16}{:<46}{:<46}{:>9}",
            row.name,
            error(&row.direct_error),
            error(&row.all_error),
            percent(row.negative)
        );
    }
}
