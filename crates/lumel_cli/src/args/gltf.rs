//! What `.glb` files hold.

use super::Target;
use crate::failure::hinted;
use clap::{Args, ValueEnum};
use lumel_export::{ColorScale, GlbOptions, GltfMaterials, LightmapTarget};
use lumel_render_cpu::Exposure;

/// How a .glb file shows a scene.
#[derive(Debug, Args)]
pub(crate) struct GltfArgs {
    /// What the materials of a .glb file are. [default: unlit; with a lightmap, as --target says]
    #[arg(long, value_enum, value_name = "MATERIALS", help_heading = "GLB files")]
    pub(crate) gltf_materials: Option<Materials>,

    /// Exposure of what unlit materials show: a number of stops (EV), auto, or max if nothing is to be clipped. [default: auto]
    ///
    /// Their colours end at white. auto shows all but the brightest fiftieth of the surfaces without clipping. The exposure that was
    /// used is in the file, as "exposure" in the extras of "asset": viewers with a tone curve can undo it.
    #[arg(long, value_name = "EV|auto|max", value_parser = color_scale, help_heading = "GLB files")]
    #[arg(allow_negative_numbers = true)]
    pub(crate) gltf_exposure: Option<ColorScale>,
}

/// What the materials of a GLB file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Materials {
    /// Those of the scene, which viewers light, with normal maps, metal and roughness. The light of vertices is in the attribute
    /// _IRRADIANCE alone.
    Keep,
    /// Unlit ones, which show the light of the bake in any viewer.
    Unlit,
}

impl GltfArgs {
    /// How lit meshes are written.
    pub(crate) fn options(&self) -> GlbOptions {
        let materials = match self.gltf_materials {
            Some(Materials::Keep) => GltfMaterials::Keep,
            Some(Materials::Unlit) | None => GltfMaterials::Unlit,
        };
        GlbOptions { materials, exposure: self.gltf_exposure.unwrap_or_default() }
    }

    /// Checks that they go with each other, and with the target if light is stored in a lightmap.
    pub(crate) fn check(&self, lightmap: Option<LightmapTarget>) -> anyhow::Result<()> {
        if let (Some(target), Some(materials)) = (lightmap, self.gltf_materials) {
            let keeps = target != LightmapTarget::Any;
            if keeps != (materials == Materials::Keep) {
                let name = |value: &dyn Fn() -> Option<clap::builder::PossibleValue>| {
                    value().map(|value| value.get_name().to_owned()).unwrap_or_default()
                };
                let target = name(&|| Target::from(target).to_possible_value());
                let materials = name(&|| materials.to_possible_value());
                let does = if keeps { "keeps the materials of the scene" } else { "shows nothing but light" };
                let hint = "leave it out, or choose another --target";
                return Err(hinted(
                    format!("--gltf-materials {materials} does not go with --target {target}, which {does}"),
                    hint,
                ));
            }
        }
        let shows_exposed = lightmap.is_none() && self.gltf_materials != Some(Materials::Keep);
        if self.gltf_exposure.is_some() && !shows_exposed {
            let message = "--gltf-exposure has no effect without unlit materials";
            return Err(hinted(message, "leave it out, or bake to vertices with --gltf-materials unlit"));
        }
        Ok(())
    }
}

fn color_scale(text: &str) -> Result<ColorScale, String> {
    if text == "max" {
        return Ok(ColorScale::Unclipped);
    }
    match text.parse::<Exposure>() {
        Ok(Exposure::Auto) => Ok(ColorScale::Auto),
        Ok(Exposure::Stops(stops)) => Ok(ColorScale::Factor(stops.exp2())),
        Err(_) => Err("it must be auto, max or a number of stops between -100 and 100".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_go_with_the_targets_of_a_lightmap_that_have_them() {
        let check = |gltf_materials, gltf_exposure, target| {
            GltfArgs { gltf_materials, gltf_exposure }.check(target).map_err(|error| error.to_string())
        };
        let (keep, unlit) = (Some(Materials::Keep), Some(Materials::Unlit));
        let (three, any) = (Some(LightmapTarget::Three), Some(LightmapTarget::Any));
        for (materials, target) in [(keep, None), (unlit, None), (keep, three), (unlit, any), (None, any)] {
            assert!(check(materials, None, target).is_ok(), "{materials:?} {target:?}");
        }
        assert!(check(unlit, None, three).unwrap_err().contains("unlit does not go with --target three"));
        assert!(check(keep, None, any).unwrap_err().contains("keep does not go with --target any"));
        let scale = Some(ColorScale::Unclipped);
        assert!(check(unlit, scale, None).is_ok() && check(None, scale, None).is_ok());
        assert!(check(keep, scale, None).is_err() && check(None, scale, any).is_err());
    }

    #[test]
    fn exposure_is_in_stops() {
        assert_eq!(color_scale("-2"), Ok(ColorScale::Factor(0.25)));
        assert_eq!(color_scale("auto"), Ok(ColorScale::Auto));
        assert_eq!(color_scale("max"), Ok(ColorScale::Unclipped));
        assert!(color_scale("bright").is_err() && color_scale("nan").is_err());
    }
}
