//! Numbers in the words of messages.

/// A count and what is counted.
///
/// ```
/// assert_eq!(lumel::counted(1, "bounce", "bounces"), "1 bounce");
/// assert_eq!(lumel::counted(0, "bounce", "bounces"), "0 bounces");
/// ```
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Rays per second in words; `None` where there are none to speak of.
///
/// ```
/// assert_eq!(lumel::ray_rate(2_345_678.0).as_deref(), Some("2.35 Mrays/s"));
/// assert_eq!(lumel::ray_rate(1234.0).as_deref(), Some("1234 rays/s"));
/// assert_eq!(lumel::ray_rate(0.2), None);
/// ```
pub fn ray_rate(rays_per_second: f64) -> Option<String> {
    match rays_per_second {
        10_000.0.. => Some(format!("{:.2} Mrays/s", 1e-6 * rays_per_second)),
        0.5.. => Some(format!("{rays_per_second:.0} rays/s")),
        _ => None,
    }
}
