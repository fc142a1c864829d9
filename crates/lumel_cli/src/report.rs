//! Formatting of numbers for people.

pub(crate) use lumel::counted;

/// Seconds: `1.23 s`, `4 min 05 s`, `3 h 12 min`.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..60 => seconds_only(seconds),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

fn seconds_only(seconds: f64) -> String {
    if seconds < 10.0 { format!("{seconds:.1} s") } else { format!("{seconds:.0} s") }
}

/// Bytes with three or four digits.
pub(crate) fn bytes(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["kB", "MB", "GB", "TB"];
    if bytes < 1000 {
        return format!("{bytes} B");
    }
    let mut size = bytes as f64 / 1000.0;
    let mut unit = 0;
    while size >= 999.5 && unit + 1 < UNITS.len() {
        size /= 1000.0;
        unit += 1;
    }
    let decimals = if size < 9.995 { 2 } else { usize::from(size < 99.95) };
    format!("{size:.decimals$} {}", UNITS[unit])
}

/// A fraction as a percentage.
pub(crate) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 || percent >= 0.1 { format!("{percent:.1} %") } else { format!("{percent:.2} %") }
}

/// A number with five significant digits.
pub(crate) fn significant(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.4e}");
    }
    let decimals = (4.0 - size.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Numbers with five significant digits, separated by spaces.
pub(crate) fn triple(values: [f32; 3]) -> String {
    values.map(|value| significant(f64::from(value))).join(" ")
}

/// A place in world space: five significant digits, or millimetres where those are less.
pub(crate) fn place(position: [f64; 3]) -> String {
    let coordinate = |value: f64| match value.abs() {
        10_000.0.. => format!("{value:.3}").trim_end_matches('0').trim_end_matches('.').to_owned(),
        _ => significant(value),
    };
    position.map(coordinate).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_have_sensible_units() {
        let texts = [0.04, 9.94, 59.4, 59.6, 245.0, 11520.0].map(duration);
        assert_eq!(texts, ["0.0 s", "9.9 s", "59 s", "1 min 00 s", "4 min 05 s", "3 h 12 min"]);
    }

    #[test]
    fn sizes_have_three_digits() {
        let texts = [0, 999, 1000, 1_234_567, 999_600, 45_600_000_000].map(bytes);
        assert_eq!(texts, ["0 B", "999 B", "1.00 kB", "1.23 MB", "1.00 MB", "45.6 GB"]);
    }

    #[test]
    fn numbers_keep_five_digits() {
        let texts = [0.0, 1.0, 0.199_825_4, 123.456, -2.5, 1e-9, 123_456.7].map(significant);
        assert_eq!(texts, ["0", "1", "0.19983", "123.46", "-2.5", "1.0000e-9", "123457"]);
    }
}
