//! Marko Dabrovic's Sponza, which is read from outside the repository, and a light for it.

use glam::Vec3;
use lumel::RectLight;
use lumel_scene::Radiance;
use lumel_testkit::shared;
use std::path::PathBuf;

/// The scene; the reason if it is not available.
pub(crate) fn file() -> Result<PathBuf, String> {
    let path = shared::path("scenes/sponza-dabrovic/sponza.obj");
    path.ok_or_else(|| format!("Sponza is read from the folder that {} names", shared::VARIABLE))
}

/// The light of Aalto University's course in its preset of the scene: above the courtyard, facing down.
pub(crate) fn light() -> RectLight {
    let half_size = 0.682_608_84;
    RectLight {
        center: Vec3::new(-5.206_645_5, 6.506_246_6, -0.159_730_85),
        u: Vec3::new(0.886_577_2, 0.383_867_98, -0.258_120_6) * half_size,
        v: Vec3::new(0.279_536_46, 0.0, 0.960_135_1) * half_size,
        radiance: Radiance(Vec3::splat(100.0)),
        texture: None,
    }
}
