//! Light on lumels, as far as it is known.

use crate::layout::Layout;
use crate::selection::Selection;
use glam::Vec3;
use lumel::{Directional, IncidentRadiance, Lightmap, LumelLight};
use lumel_basis::HARMONICS;
use lumel_lightmap::{Filter, LumelLighting};
use lumel_scene::{Irradiance, SurfacePoint};
use std::sync::Arc;

/// Light on the lumels of a layout, as far as it is known.
#[derive(Clone, Debug)]
pub struct LumelIllumination {
    /// Where the lumels lie.
    pub layout: Arc<Layout>,
    known: Known,
}

/// What is known.
#[derive(Clone, Debug)]
enum Known {
    /// What was measured so far, noisy and with open seams.
    Measured(Arc<LumelLight>),
    /// All of it.
    Finished(Arc<Lightmap>),
}

impl LumelIllumination {
    /// What was measured so far.
    pub fn measured(layout: Arc<Layout>, light: LumelLight) -> Self {
        Self { layout, known: Known::Measured(Arc::new(light)) }
    }

    /// A finished lightmap.
    pub fn finished(layout: Arc<Layout>, lightmap: Lightmap) -> Self {
        Self { layout, known: Known::Finished(Arc::new(lightmap)) }
    }

    /// The lightmap, once it is finished.
    pub fn lightmap(&self) -> Option<&Arc<Lightmap>> {
        match &self.known {
            Known::Measured(_) => None,
            Known::Finished(lightmap) => Some(lightmap),
        }
    }

    /// The chosen part of the light by lumel of all pages, W·m⁻²; `None` where it is not known. All light is never negative.
    pub fn select(&self, selection: Selection) -> Vec<Option<Vec3>> {
        let least = if selection.is_all() { Vec3::ZERO } else { Vec3::splat(f32::NEG_INFINITY) };
        match &self.known {
            Known::Measured(light) => {
                let tail = light.tail().filter(|_| selection.contains_tail());
                let bounces = light.bounces().iter().enumerate();
                let parts = bounces.filter(|(k, _)| selection.contains(*k)).map(|(_, values)| &values[..]);
                let parts: Vec<&[Vec3]> = parts.chain(tail).collect();
                let sum = |place: usize| parts.iter().map(|values| values[place]).sum::<Vec3>().max(least);
                self.on_pages(|place| is_known(light, place).then(|| sum(place)))
            }
            Known::Finished(lightmap) => {
                let chosen = lightmap.layers.iter().filter(|layer| Part::of(&layer.name).is_in(selection));
                let parts: Vec<&[Vec3]> = chosen.map(|layer| &*layer.values).collect();
                let sum = |lumel: usize| parts.iter().map(|values| values[lumel]).sum::<Vec3>().max(least);
                (0..lightmap.valid.len()).map(|lumel| Some(sum(lumel))).collect()
            }
        }
    }

    /// The chosen part by direction by lumel of all pages: known of all light, once the lightmap is finished.
    pub fn by_direction(&self, selection: Selection) -> Option<Vec<IncidentRadiance>> {
        let layers = &self.lightmap().filter(|_| selection.is_all())?.layers;
        let layer = |k: usize| layers.iter().find(|layer| layer.harmonic() == Some(k));
        let harmonics: Vec<&[Vec3]> = (0..HARMONICS).map_while(layer).map(|layer| &*layer.values).collect();
        let mut of_lumel = vec![Vec3::ZERO; harmonics.len()];
        let lumels = 0..harmonics.first()?.len();
        lumels
            .map(|lumel| {
                of_lumel.iter_mut().zip(&harmonics).for_each(|(c, values)| *c = values[lumel]);
                IncidentRadiance::new(&of_lumel)
            })
            .collect()
    }

    /// What is known of all light by direction, by lumel.
    pub fn directional(&self) -> Directional {
        let harmonics = self
            .lightmap()
            .map_or(0, |lightmap| lightmap.layers.iter().filter(|layer| layer.harmonic().is_some()).count());
        Directional::of_channels(1 + harmonics).unwrap_or_default()
    }

    /// All light at a point of the open scene, read bilinearly, once the lightmap is finished.
    pub fn at(&self, at: SurfacePoint) -> Option<Irradiance> {
        let values = &*self.lightmap()?.layers.first()?.values;
        Some(LumelLighting { atlas: &self.layout.refined, values, filter: Filter::Bilinear }.at(at))
    }

    /// The standard error of all light by lumel of all pages, W·m⁻², once the lightmap is finished.
    pub fn errors(&self) -> Option<Vec<Option<Vec3>>> {
        let layer = self.lightmap()?.layers.iter().find(|layer| layer.name == "error")?;
        Some(layer.values.iter().map(|error| Some(*error)).collect())
    }

    /// Whether a lumel sees anything but the inside of geometry, by its place in the coverage; `None` where it was not measured.
    pub fn validity(&self, place: usize) -> Option<bool> {
        match &self.known {
            Known::Measured(light) => is_measured(light, place).then(|| light.is_valid(place)),
            Known::Finished(lightmap) => {
                Some(lightmap.valid[self.layout.lumels.coverage.lumels()[place] as usize])
            }
        }
    }

    fn on_pages(&self, value: impl Fn(usize) -> Option<Vec3>) -> Vec<Option<Vec3>> {
        let mut values = vec![None; self.layout.lumels.atlas.lumel_count()];
        let lumels = self.layout.lumels.coverage.lumels().iter().enumerate();
        lumels.for_each(|(place, &lumel)| values[lumel as usize] = value(place));
        values
    }
}

fn is_measured(light: &LumelLight, place: usize) -> bool {
    light.round > 0 || place < light.done as usize
}

fn is_known(light: &LumelLight, place: usize) -> bool {
    is_measured(light, place) && light.is_valid(place)
}

/// Which part of the light a layer of a lightmap is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    All,
    Bounce(usize),
    Tail,
    None,
}

impl Part {
    fn of(name: &str) -> Self {
        let bounce = |name: &str| name.strip_prefix("bounce ").and_then(|k| k.parse().ok());
        match name {
            "irradiance" => Self::All,
            "direct" => Self::Bounce(0),
            "tail" => Self::Tail,
            name => bounce(name).map_or(Self::None, Self::Bounce),
        }
    }

    /// Whether it is one of the parts that make up a selection.
    fn is_in(self, selection: Selection) -> bool {
        match self {
            Self::All => selection.is_all(),
            Self::Bounce(k) => !selection.is_all() && selection.contains(k),
            Self::Tail => !selection.is_all() && selection.contains_tail(),
            Self::None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Part;
    use crate::selection::Selection;

    #[test]
    fn layers_make_up_selections() {
        let names = ["irradiance", "direct", "bounce 1", "bounce 2", "tail", "noisy", "error"];
        let chosen = |selection| names.map(|name| Part::of(name).is_in(selection)).map(u8::from);
        assert_eq!(chosen(Selection::All), [1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(chosen(Selection::DIRECT), [0, 1, 0, 0, 0, 0, 0]);
        assert_eq!(chosen(Selection::Indirect), [0, 0, 1, 1, 1, 0, 0]);
        assert_eq!(chosen(Selection::bounce(2)), [0, 0, 0, 1, 0, 0, 0]);
    }
}
