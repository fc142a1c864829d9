//! Images of the sky from files.

use super::Session;
use crate::document::error_text;
use crate::notice::Level;
use crate::sky::EditSky;
use crate::task::Background;
use lumel::{SkyEntry, SkyImageEntry};
use lumel_scene::Warnings;
use std::path::Path;
use std::sync::Arc;

/// A sky from a file.
pub(super) struct LoadedSky {
    sky: EditSky,
    /// What is doubtful about it.
    warnings: Vec<String>,
}

/// Reads a sky that may be an image, whose path leads to it from here.
pub(super) fn read(entry: &SkyEntry) -> Result<LoadedSky, String> {
    let mut warnings = Warnings::default();
    let sky = entry.load(entry.file(), &mut warnings).map_err(|e| error_text(&e))?;
    let file = entry.file().map(Path::to_owned);
    Ok(LoadedSky { sky: EditSky { sky, file }, warnings: warnings.iter().map(ToString::to_string).collect() })
}

impl Session {
    /// Lights the scene from an image of the sky.
    pub fn load_sky(&mut self, path: &Path) {
        if self.document.is_none() {
            self.notices.push(Level::Warning, "Open a scene first, then an image of its sky");
            return;
        }
        let image = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let entry = SkyEntry::Image(SkyImageEntry { image, rotation: 0.0, strength: 1.0 });
        let what = format!("reading {}", path.display());
        self.loading_sky = Some(Background::start(what, Arc::clone(&self.wakes.event), move || read(&entry)));
    }

    pub(super) fn poll_sky(&mut self) {
        let Some(result) = self.loading_sky.as_ref().and_then(Background::poll) else { return };
        self.loading_sky = None;
        match result {
            Ok(loaded) => self.light_from(loaded),
            Err(problem) => self.notices.push(Level::Error, format!("Cannot load the sky: {problem}")),
        }
    }

    /// Lights the scene from this sky.
    pub(super) fn light_from(&mut self, LoadedSky { sky, warnings }: LoadedSky) {
        for warning in warnings {
            self.notices.push(Level::Warning, warning);
        }
        self.sky = sky;
    }
}
