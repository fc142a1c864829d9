//! Lengths with their units.

/// Units in metres, each before those whose name it ends with.
const UNITS: [(&str, f64); 6] =
    [("mm", 1e-3), ("cm", 1e-2), ("km", 1e3), ("m", 1.0), ("in", 0.0254), ("ft", 0.3048)];

/// The metres that a text says; plain numbers are metres. `None` if it is no length.
///
/// ```
/// assert_eq!(lumel::metres("10cm"), Some(0.1));
/// assert_eq!(lumel::metres("2.5 mm"), Some(0.0025));
/// assert_eq!(lumel::metres("0.1"), Some(0.1));
/// assert_eq!(lumel::metres("10 yd"), None);
/// ```
pub fn metres(text: &str) -> Option<f32> {
    let text = text.trim();
    let unit = UNITS.iter().find_map(|(name, metres)| Some((text.strip_suffix(name)?, *metres)));
    let (number, metres) = unit.unwrap_or((text, 1.0));
    Some((number.trim_end().parse::<f64>().ok()? * metres) as f32)
}
