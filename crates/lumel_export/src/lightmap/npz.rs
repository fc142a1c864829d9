//! Lightmaps as NumPy archives, which lumel reads again.

use super::check;
use crate::error::SceneLabel;
use crate::members::{
    Kind, check_members, read_flags, read_format, read_meta, read_numbers, read_vectors, read_whole_numbers,
};
use crate::solution::is_lighting_of;
use crate::{Array, ArrayData, NpzReader, SolutionError, SolutionMeta, SolutionSelection, write_npz};
use glam::{Vec2, Vec3};
use lumel_lightmap::{Lightmap, LightmapLayer};
use lumel_scene::{ObjectId, Scene};
use lumel_uv::{Atlas, AtlasParts, ChartPlace};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// The version changes only when the layout does.
pub(crate) const KIND: Kind = Kind {
    format: "lumel-lightmap",
    version: 1,
    name: "lightmap",
    remedy: "make one with a bake whose basis is lightmap",
};

const VALID: &str = "valid";
const PAGES: &str = "pages";
const ATLAS: &str = "atlas";
const CORNERS: &str = "corners";
const CHARTS: &str = "charts";
const CHART_PLACES: &str = "chart_places";
const CHART_DENSITIES: &str = "chart_densities";

/// The arrays beside the layers, and what they hold.
const ARRAYS: [(&str, &str); 7] = [
    (VALID, "(lumel) true where light was measured, false where it comes from other lumels"),
    (PAGES, "(page, 2) width and height in lumels; the lumels of all pages follow each other, row by row"),
    (ATLAS, "(2) lumels per metre, and lumels between charts"),
    (
        CORNERS,
        "(triangle, corner, xy) on the page, lumels: the centre of lumel (x, y) is at (x + 0.5, y + 0.5)",
    ),
    (CHARTS, "(triangle) its chart"),
    (CHART_PLACES, "(chart, 6) object, page, first column and row, column and row after the last"),
    (CHART_DENSITIES, "(chart) lumels per metre"),
];

/// The result of a bake into a lightmap: irradiance by lumel, W·m⁻² (lux where the scene's lights are photometric), linear
/// Rec. 709, and where each triangle's light is.
///
/// As a file it is a NumPy archive of an array (lumel, rgb) for each layer, under its name, of the atlas, and of `meta.json`,
/// which says what each array holds.
#[derive(Clone, Debug)]
pub struct LightmapSolution {
    /// Where it comes from: the scene as it was unwrapped, and the settings.
    pub meta: SolutionMeta,
    /// The light.
    pub lightmap: Arc<Lightmap>,
}

impl LightmapSolution {
    /// A lightmap of a scene.
    pub fn new(scene: &Scene, settings: Value, lightmap: impl Into<Arc<Lightmap>>) -> Self {
        Self { meta: SolutionMeta::of_kind(&KIND, scene, settings), lightmap: lightmap.into() }
    }

    /// Checks that this is light on the scene's geometry; its materials and lights may have changed since.
    ///
    /// # Errors
    /// [`SolutionError::OtherScene`] names both scenes.
    pub fn check_belongs_to(&self, scene: &Scene) -> Result<(), SolutionError> {
        let theirs = SceneLabel {
            name: self.meta.scene.clone(),
            vertices: scene.vertex_count(),
            geometry_hash: self.meta.geometry_hash.clone(),
        };
        theirs.check_is(scene, None)
    }

    /// Whether the scene's materials, lights and sky are those of the bake.
    pub fn has_lighting_of(&self, scene: &Scene) -> bool {
        is_lighting_of(&self.meta.lighting_hash, scene)
    }

    /// The layer that holds a part of the light.
    ///
    /// # Errors
    /// A bounce or a layer that there is not.
    pub fn layer(&self, selection: &SolutionSelection) -> Result<usize, SolutionError> {
        let named = |wanted: &str| self.lightmap.layers.iter().position(|layer| layer.name == wanted);
        match selection {
            SolutionSelection::Sum => Ok(0),
            SolutionSelection::Bounce(wanted) => named(&LightmapLayer::of_bounce(*wanted))
                .ok_or_else(|| self.meta.no_bounce(*wanted, self.bounces().len())),
            SolutionSelection::Layer(wanted) => named(wanted).ok_or_else(|| {
                let names = self.lightmap.layers.iter().map(|layer| layer.name.clone()).collect();
                SolutionError::NoSuchLayer { wanted: wanted.clone(), names }
            }),
        }
    }

    /// Direct light and each bounce, by lumel of all pages.
    pub fn bounces(&self) -> Vec<&[Vec3]> {
        let layers = &self.lightmap.layers;
        let named = |bounce| layers.iter().find(|layer| layer.name == LightmapLayer::of_bounce(bounce));
        (0..).map_while(named).map(|layer| layer.values.as_slice()).collect()
    }

    /// Writes the lightmap, atomically.
    ///
    /// # Errors
    /// Light that is not finite, a layer whose name another array has, and all that writing meets.
    pub fn save(&self, path: &Path) -> Result<(), SolutionError> {
        let refuse = |problem| SolutionError::Lightmap { path: path.to_owned(), problem };
        let Lightmap { atlas, valid, layers } = &*self.lightmap;
        check(path, &self.lightmap)?;
        let mut meta = SolutionMeta {
            arrays: ARRAYS.map(|(name, what)| (name.to_owned(), what.to_owned())).into(),
            layers: layers.iter().map(|layer| layer.name.clone()).collect(),
            ..self.meta.clone()
        };
        for (number, layer) in layers.iter().enumerate() {
            let what = if number == 0 { "all arriving light" } else { "a part of it, or what its name says" };
            let what =
                format!("(lumel, rgb) {what}, W/m^2 (lux if the lights are photometric), linear Rec. 709");
            if meta.arrays.insert(layer.name.clone(), what).is_some() {
                return Err(refuse(format!("has two arrays called \"{}\"", layer.name)));
            }
        }
        write_npz(path, |npz| {
            npz.bytes("meta.json", &serde_json::to_vec_pretty(&meta)?)?;
            for layer in layers {
                npz.array(&layer.name, &Array::from_vectors(&layer.values))?;
            }
            npz.array(VALID, &Array::list(ArrayData::Bool(valid.clone())))?;
            atlas_arrays(atlas).into_iter().try_for_each(|(name, array)| npz.array(name, &array))
        })?;
        Ok(())
    }

    /// Whether a file says that it is a lightmap. What is wrong with others is told when they are read.
    pub fn is_file(path: &Path) -> bool {
        NpzReader::open(path).is_ok_and(|mut npz| read_format(&mut npz).as_deref() == Some(KIND.format))
    }

    /// Reads where a lightmap comes from and leaves its light.
    ///
    /// # Errors
    /// A file that is no lightmap, of a newer format, or damaged.
    pub fn load_meta(path: &Path) -> Result<SolutionMeta, SolutionError> {
        read_meta(&mut NpzReader::open(path)?, &KIND)
    }

    /// Whether both are light at the same lumels of the same surfaces.
    pub fn same_lumels_as(&self, other: &Self) -> bool {
        self.meta.geometry_hash == other.meta.geometry_hash
            && self.lightmap.atlas.identity() == other.lightmap.atlas.identity()
    }

    /// Reads a lightmap.
    ///
    /// # Errors
    /// A file that is no lightmap, of a newer format, or damaged.
    pub fn load(path: &Path) -> Result<Self, SolutionError> {
        let npz = &mut NpzReader::open(path)?;
        let refuse = |problem: String| SolutionError::Lightmap { path: path.to_owned(), problem };
        let meta: SolutionMeta = read_meta(npz, &KIND)?;
        check_members(npz, meta.arrays.keys())?;
        let layer =
            |name: &String| Ok(LightmapLayer { name: name.clone(), values: read_vectors(npz, name)? });
        let layers = meta.layers.iter().map(layer).collect::<Result<_, SolutionError>>()?;
        let valid = read_flags(npz, VALID)?;
        let atlas = read_atlas(npz)?
            .ok_or_else(|| refuse("has arrays of an atlas that do not fit together".to_owned()))?;
        let atlas =
            Arc::new(atlas.atlas().map_err(|problem| refuse(format!("has a damaged atlas ({problem})")))?);
        let lightmap = Lightmap { atlas, valid, layers };
        check(path, &lightmap).map_err(|error| refuse(format!("is damaged ({error})")))?;
        Ok(Self { meta, lightmap: Arc::new(lightmap) })
    }
}

fn atlas_arrays(atlas: &Atlas) -> [(&'static str, Array); 6] {
    let AtlasParts { pages, density, gutter, corners, charts, places } = AtlasParts::from(atlas);
    let place = |place: &ChartPlace| {
        let ([left, top], [right, bottom]) = (place.min, place.max);
        [place.object.0, place.page, left, top, right, bottom]
    };
    let corner_values = corners.iter().flatten().flat_map(|corner| corner.to_array()).collect();
    [
        (PAGES, Array { shape: vec![pages.len(), 2], data: ArrayData::U32(pages.concat()) }),
        (ATLAS, Array::list(ArrayData::F32(vec![density, gutter as f32]))),
        (CORNERS, Array { shape: vec![corners.len(), 3, 2], data: ArrayData::F32(corner_values) }),
        (CHARTS, Array::list(ArrayData::U32(charts))),
        (
            CHART_PLACES,
            Array {
                shape: vec![places.len(), 6],
                data: ArrayData::U32(places.iter().flat_map(place).collect()),
            },
        ),
        (CHART_DENSITIES, Array::list(ArrayData::F32(places.iter().map(|place| place.density).collect()))),
    ]
}

/// The parts of the atlas; `None` if lengths do not fit together.
fn read_atlas(npz: &mut NpzReader) -> Result<Option<AtlasParts>, SolutionError> {
    let pages = read_whole_numbers(npz, PAGES)?;
    let about = read_numbers(npz, ATLAS)?;
    let corners = read_numbers(npz, CORNERS)?;
    let charts = read_whole_numbers(npz, CHARTS)?;
    let places = read_whole_numbers(npz, CHART_PLACES)?;
    let densities = read_numbers(npz, CHART_DENSITIES)?;
    let (&[density, gutter], true) = (&*about, places.len() == 6 * densities.len()) else { return Ok(None) };
    let (pages, []) = pages.as_chunks() else { return Ok(None) };
    let (corners, []) = corners.as_chunks::<6>() else { return Ok(None) };
    let (places, _) = places.as_chunks();
    let place = |(&[object, page, left, top, right, bottom], &density): (&[u32; 6], &f32)| ChartPlace {
        object: ObjectId(object),
        page,
        min: [left, top],
        max: [right, bottom],
        density,
    };
    Ok(Some(AtlasParts {
        pages: pages.to_vec(),
        density,
        gutter: gutter as u32,
        corners: corners
            .iter()
            .map(|&[ax, ay, bx, by, cx, cy]| [Vec2::new(ax, ay), Vec2::new(bx, by), Vec2::new(cx, cy)])
            .collect(),
        charts,
        places: places.iter().zip(&densities).map(place).collect(),
    }))
}
