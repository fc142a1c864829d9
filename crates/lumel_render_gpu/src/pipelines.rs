//! Render pipelines, created on first use.

use crate::Gpu;
use crate::attachments::{DEPTH, HDR, PICTURE, PLACES, POINT_LIGHT, Samples};
use crate::light::layers_of;
use crate::points;
use crate::shaders::{self, Shader};
use crate::vertices::{self, Attribute};
use lumel_basis::{Directional, Shading};
use lumel_lightmap::Filter;
use lumel_render_cpu::NormalMaps;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Values that do not need a material's textures; the numbers are those of `value.wgsl` and `lumel_value.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Value {
    Radiance = 0,
    Irradiance = 1,
    Albedo = 2,
    Luminance = 3,
    /// As colours, of lumels only: see `Key::Plain`.
    Color = 4,
    /// Vectors, as colours.
    Vector = 5,
}

/// Where values are read; the numbers are those of `lumels.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Reading {
    Vertices = 0,
    Nearest = 1,
    Bilinear = 2,
    Bicubic = 3,
}

impl From<Filter> for Reading {
    fn from(filter: Filter) -> Self {
        match filter {
            Filter::Nearest => Self::Nearest,
            Filter::Bilinear => Self::Bilinear,
            Filter::Bicubic => Self::Bicubic,
        }
    }
}

/// How linear values become sRGB codes; the numbers are those of `tone.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Curve {
    Srgb = 0,
    Reinhard = 1,
    Aces = 2,
    Agx = 3,
    None = 4,
    FalseColor = 5,
}

/// What `surface.wgsl` shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Quantity {
    Radiance,
    Albedo,
}

/// The attributes of a draw call besides light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Detail {
    pub(crate) albedo_map: bool,
    pub(crate) emission_map: bool,
    pub(crate) tint: bool,
    /// Whether parts of it are not there.
    pub(crate) transparent: bool,
}

/// Where green of a normal map points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Green {
    Up,
    Down,
}

impl Green {
    /// `None` if normal maps are not shown.
    pub(crate) fn of(maps: NormalMaps) -> Option<Self> {
        match maps {
            NormalMaps::Off => None,
            NormalMaps::Up => Some(Self::Up),
            NormalMaps::Down => Some(Self::Down),
        }
    }

    fn sign(self) -> f64 {
        match self {
            Self::Up => 1.0,
            Self::Down => -1.0,
        }
    }
}

/// What tilts normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Tilt {
    /// A normal map, if there is one.
    pub(crate) map: Option<Green>,
    /// Waves.
    pub(crate) ripple: bool,
}

impl Tilt {
    /// Constants of `tilt.wgsl`.
    fn constants(self) -> Vec<(&'static str, f64)> {
        let number = |flag: bool| f64::from(u8::from(flag));
        let green = self.map.map_or(1.0, Green::sign);
        vec![
            ("HAS_NORMAL_MAP", number(self.map.is_some())),
            ("IS_RIPPLED", number(self.ripple)),
            ("GREEN", green),
        ]
    }

    fn tangent(self) -> Attribute {
        if self.map.is_some() { vertices::TANGENT } else { vertices::NO_TANGENT }
    }
}

/// How light is found on tilted normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Shade {
    /// Its place in `Shading::ALL`.
    shading: u8,
    /// Whether band 2 is known.
    three_bands: bool,
    /// Whether lumels know coefficients of their own.
    on_lumels: bool,
}

impl Shade {
    pub(crate) fn new(shading: Shading, kind: Directional, on_lumels: bool) -> Self {
        let three_bands = kind == Directional::Sh2;
        // Without band 2, l2 is zh3.
        let shading = if shading == Shading::Quadratic && !three_bands { Shading::Zh3 } else { shading };
        let place = Shading::ALL.iter().position(|s| *s == shading).unwrap_or(0);
        Self { shading: place as u8, three_bands, on_lumels }
    }

    /// Layers of coefficients that each page of lumels has; 0 where those of the vertices are read.
    fn layers_of_lumels(self) -> u32 {
        match self {
            Self { on_lumels: false, .. } => 0,
            Self { three_bands: false, .. } => layers_of(Directional::Sh1),
            Self { three_bands: true, .. } => layers_of(Directional::Sh2),
        }
    }
}

/// Visible marks, or those behind surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Layer {
    Seen,
    Behind,
}

/// A pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Key {
    Value(Value, Samples),
    /// Of lumels; where they are not known, of vertices.
    LumelValue(Value, Reading, Samples),
    Surface(Quantity, Detail, Reading, Samples),
    /// Light on surfaces whose normals are tilted.
    Relief(Value, Detail, Reading, Tilt, Shade, Samples),
    /// Where surfaces are, of which parts may not be there.
    Places(Detail),
    /// Light of scattered points at those places.
    Gather,
    /// Surfaces under it.
    PointSurface(Value, Detail, Samples),
    Normals(Tilt, Samples),
    Plain(Samples),
    RectLight(Samples),
    /// The sky, which may be an image.
    Backdrop {
        is_image: bool,
        samples: Samples,
    },
    Tone(Curve),
    Dots(Layer, Samples),
    Lines(Layer, Samples),
    Edges(Samples),
    /// Borders of lumels.
    Grid(Samples),
    Composite,
}

/// Opacity of marks behind surfaces.
const FAINT: f64 = 0.25;

/// Layouts of bind groups, and the pipelines created so far.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) layouts: Layouts,
    modules: [wgpu::ShaderModule; Shader::ALL.len()],
    made: Mutex<BTreeMap<Key, wgpu::RenderPipeline>>,
}

/// Layouts of the shaders' inputs.
#[derive(Debug)]
pub(crate) struct Layouts {
    /// Camera and exposure.
    pub(crate) view: wgpu::BindGroupLayout,
    /// One material, at an offset.
    pub(crate) material: wgpu::BindGroupLayout,
    /// Albedo, emission and normal map, and alpha.
    pub(crate) textures: wgpu::BindGroupLayout,
    /// One texture.
    pub(crate) rect_light: wgpu::BindGroupLayout,
    /// The numbers of a sky, and its image.
    pub(crate) backdrop: wgpu::BindGroupLayout,
    /// The exposed picture, the tone mapper's settings and the map of false colours.
    pub(crate) tone: wgpu::BindGroupLayout,
    /// The overlay.
    pub(crate) composite: wgpu::BindGroupLayout,
    /// Pages of lumels, their sizes, and coefficients of light by direction.
    pub(crate) lumels: wgpu::BindGroupLayout,
    /// Levels of scattered points, the points, light at them, and their cells.
    pub(crate) points: wgpu::BindGroupLayout,
    /// Positions and normals by pixel.
    pub(crate) places: wgpu::BindGroupLayout,
    /// The same, and the light of points there.
    pub(crate) lit_places: wgpu::BindGroupLayout,
}

impl Layouts {
    fn new(device: &wgpu::Device) -> Self {
        let layout = |label, types: &[wgpu::BindingType]| {
            let entry = |(binding, ty): (usize, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
                binding: binding as u32,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: *ty,
                count: None,
            };
            let entries: Vec<_> = types.iter().enumerate().map(entry).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
        };
        let uniform = |has_dynamic_offset| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        };
        let texture = |filterable| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let layers = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        // A device without them shows no points.
        let has_storage = device.limits().max_storage_buffers_per_shader_stage >= points::BUFFERS;
        let storage = wgpu::BindingType::Buffer {
            ty: match has_storage {
                true => wgpu::BufferBindingType::Storage { read_only: true },
                false => wgpu::BufferBindingType::Uniform,
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let image = [texture(true), wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)];
        Self {
            view: layout("view", &[uniform(false)]),
            material: layout("material", &[uniform(true)]),
            textures: layout("textures", &[image; 4].concat()),
            rect_light: layout("rect_light", &image),
            backdrop: layout("backdrop", &[uniform(false), texture(false)]),
            tone: layout("tone", &[texture(false), uniform(false), texture(false)]),
            composite: layout("composite", &[texture(false)]),
            lumels: layout("lumels", &[layers, uniform(false), layers]),
            points: layout("points", &[uniform(false), storage, storage, storage, storage]),
            places: layout("places", &[texture(false); 2]),
            lit_places: layout("lit places", &[texture(false); 3]),
        }
    }
}

/// The key of a pipeline.
struct Recipe<'a> {
    shader: Shader,
    entries: [&'a str; 2],
    groups: Vec<Option<&'a wgpu::BindGroupLayout>>,
    vertices: Vec<Attribute>,
    constants: Vec<(&'a str, f64)>,
    surface: Surface,
    samples: Samples,
}

/// The attachments, and the depth test.
enum Surface {
    /// The exposed picture; the nearest wins.
    Scene,
    /// The exposed picture behind all of it.
    Backdrop,
    /// Position and normal of the nearest, one sample for each pixel.
    Places,
    /// Light at them.
    PointLight,
    /// The overlay; what depth leaves of the layer.
    Overlay(Layer, wgpu::PrimitiveTopology, wgpu::PolygonMode),
    /// The finished picture; all of it, or blended over it.
    Screen(Option<wgpu::BlendState>),
}

impl Pipelines {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let module = |shader: Shader| {
            gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&format!("{shader:?}")),
                source: wgpu::ShaderSource::Wgsl(shaders::source(shader).into()),
            })
        };
        Self { layouts: Layouts::new(gpu.device()), modules: Shader::ALL.map(module), made: Mutex::default() }
    }

    /// A pipeline; the first time it takes tens of milliseconds.
    pub(crate) fn get(&self, device: &wgpu::Device, key: Key) -> wgpu::RenderPipeline {
        // A thread that panicked has left no incomplete pipeline behind.
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.entry(key).or_insert_with(|| self.make(device, key, self.recipe(key))).clone()
    }

    fn recipe(&self, key: Key) -> Recipe<'_> {
        let Layouts { view, material, textures, rect_light, tone, composite, lumels, .. } = &self.layouts;
        let Layouts { points, places, lit_places, backdrop, .. } = &self.layouts;
        let [view, lumels] = [view, lumels].map(Some);
        let number = |flag: bool| f64::from(u8::from(flag));
        let scene = |shader, samples, groups, vertices, constants| Recipe {
            shader,
            entries: ["vertex", "fragment"],
            groups,
            vertices,
            constants,
            surface: Surface::Scene,
            samples,
        };
        let screen = |shader, group, constants, blend| Recipe {
            surface: Surface::Screen(blend),
            ..scene(shader, Samples::One, vec![Some(group)], vec![], constants)
        };
        let overlay = |layer, samples, entries, vertices, topology, mode| Recipe {
            entries,
            surface: Surface::Overlay(layer, topology, mode),
            ..scene(Shader::Overlay, samples, vec![view], vertices, vec![("OPACITY", layer_opacity(layer))])
        };
        let strip = wgpu::PrimitiveTopology::TriangleStrip;
        let list = wgpu::PrimitiveTopology::TriangleList;
        let fill = wgpu::PolygonMode::Fill;
        match key {
            Key::Value(value, samples) => {
                let vertices = vec![vertices::POSITION, vertices::LIGHT];
                let constants = vec![("VALUE", f64::from(value as u8))];
                scene(Shader::Value, samples, vec![view, Some(material)], vertices, constants)
            }
            Key::LumelValue(value, reading, samples) => {
                let vertices = vec![vertices::POSITION, vertices::LIGHT, vertices::NORMAL, vertices::PLACE];
                let constants =
                    vec![("VALUE", f64::from(value as u8)), ("READING", f64::from(reading as u8))];
                scene(Shader::LumelValue, samples, vec![view, None, None, lumels], vertices, constants)
            }
            Key::Surface(quantity, detail, reading, samples) => {
                let tint = if detail.tint { vertices::TINT } else { vertices::NO_TINT };
                let from_lumels = reading != Reading::Vertices;
                let place = if from_lumels { vertices::PLACE } else { vertices::NO_PLACE };
                let vertices = vec![vertices::POSITION, vertices::LIGHT, vertices::UV, tint, place];
                let constants = vec![
                    ("SHOWS_ALBEDO", number(quantity == Quantity::Albedo)),
                    ("HAS_ALBEDO_MAP", number(detail.albedo_map)),
                    ("HAS_EMISSION_MAP", number(detail.emission_map)),
                    ("IS_TRANSPARENT", number(detail.transparent)),
                    ("READING", f64::from(reading as u8)),
                ];
                let groups = vec![view, Some(material), Some(textures), lumels];
                scene(Shader::Surface, samples, groups, vertices, constants)
            }
            Key::Relief(value, detail, reading, tilt, shade, samples) => {
                let tint = if detail.tint { vertices::TINT } else { vertices::NO_TINT };
                let from_lumels = reading != Reading::Vertices;
                let place = if from_lumels { vertices::PLACE } else { vertices::NO_PLACE };
                let (entry, moments) = match shade.three_bands {
                    false => ("vertex", vertices::TWO_BANDS),
                    true => ("vertex_of_three_bands", vertices::THREE_BANDS),
                };
                let vertices = vec![
                    vertices::POSITION,
                    vertices::LIGHT,
                    vertices::UV,
                    tint,
                    place,
                    vertices::NORMAL,
                    tilt.tangent(),
                    moments,
                ];
                let mut constants = tilt.constants();
                constants.extend([
                    ("VALUE", f64::from(value as u8)),
                    ("HAS_ALBEDO_MAP", number(detail.albedo_map)),
                    ("HAS_EMISSION_MAP", number(detail.emission_map)),
                    ("IS_TRANSPARENT", number(detail.transparent)),
                    ("READING", f64::from(reading as u8)),
                    ("SHADING", f64::from(shade.shading)),
                    ("MOMENT_LAYERS", f64::from(shade.layers_of_lumels())),
                ]);
                let groups = vec![view, Some(material), Some(textures), lumels];
                let recipe = scene(Shader::Relief, samples, groups, vertices, constants);
                Recipe { entries: [entry, "fragment"], ..recipe }
            }
            Key::Places(detail) => {
                let vertices = vec![vertices::POSITION, vertices::UV, vertices::NORMAL];
                let constants = vec![("IS_TRANSPARENT", number(detail.transparent))];
                let groups = vec![view, Some(material), Some(textures)];
                let recipe = scene(Shader::Places, Samples::One, groups, vertices, constants);
                Recipe { surface: Surface::Places, ..recipe }
            }
            Key::Gather => {
                let groups = vec![Some(places), Some(points)];
                let recipe = scene(Shader::Gather, Samples::One, groups, vec![], vec![]);
                Recipe { surface: Surface::PointLight, ..recipe }
            }
            Key::PointSurface(value, detail, samples) => {
                let tint = if detail.tint { vertices::TINT } else { vertices::NO_TINT };
                let vertices =
                    vec![vertices::POSITION, vertices::LIGHT, vertices::UV, tint, vertices::NORMAL];
                let constants = vec![
                    ("VALUE", f64::from(value as u8)),
                    ("HAS_ALBEDO_MAP", number(detail.albedo_map)),
                    ("HAS_EMISSION_MAP", number(detail.emission_map)),
                    ("IS_TRANSPARENT", number(detail.transparent)),
                    ("IS_MULTISAMPLED", number(samples != Samples::One)),
                ];
                let groups = vec![view, Some(material), Some(textures), Some(lit_places)];
                scene(Shader::PointSurface, samples, groups, vertices, constants)
            }
            Key::Normals(tilt, samples) => {
                let vertices = vec![vertices::POSITION, vertices::NORMAL, vertices::UV, tilt.tangent()];
                let constants = tilt.constants();
                scene(
                    Shader::Normals,
                    samples,
                    vec![view, Some(material), Some(textures)],
                    vertices,
                    constants,
                )
            }
            Key::Plain(samples) => {
                let vertices = vec![vertices::POSITION, vertices::LIGHT, vertices::NORMAL];
                scene(Shader::Plain, samples, vec![view], vertices, vec![])
            }
            Key::RectLight(samples) => {
                let groups = vec![view, Some(rect_light)];
                scene(Shader::RectLight, samples, groups, vec![vertices::RECT_LIGHT], vec![])
            }
            Key::Backdrop { is_image, samples } => {
                let groups = vec![view, Some(backdrop)];
                let recipe =
                    scene(Shader::Backdrop, samples, groups, vec![], vec![("IS_IMAGE", number(is_image))]);
                Recipe { surface: Surface::Backdrop, ..recipe }
            }
            Key::Tone(curve) => screen(Shader::Tone, tone, vec![("CURVE", f64::from(curve as u8))], None),
            Key::Dots(layer, samples) => {
                let entries = ["dot_vertex", "dot_fragment"];
                overlay(layer, samples, entries, vec![vertices::DOT], strip, fill)
            }
            Key::Lines(layer, samples) => {
                let entries = ["line_vertex", "line_fragment"];
                overlay(layer, samples, entries, vec![vertices::LINE], strip, fill)
            }
            Key::Edges(samples) => {
                let entries = ["edge_vertex", "edge_fragment"];
                let vertices = vec![vertices::POSITION];
                overlay(Layer::Seen, samples, entries, vertices, list, wgpu::PolygonMode::Line)
            }
            Key::Grid(samples) => {
                let entries = ["grid_vertex", "grid_fragment"];
                let vertices = vec![vertices::POSITION, vertices::PLACE];
                overlay(Layer::Seen, samples, entries, vertices, list, fill)
            }
            Key::Composite => {
                let blend = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;
                screen(Shader::Composite, composite, vec![], Some(blend))
            }
        }
    }

    fn make(&self, device: &wgpu::Device, key: Key, recipe: Recipe<'_>) -> wgpu::RenderPipeline {
        let label = format!("{key:?}");
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &recipe.groups,
            immediate_size: 0,
        });
        let module = &self.modules[recipe.shader as usize];
        let options = wgpu::PipelineCompilationOptions { constants: &recipe.constants, ..Default::default() };
        let buffers = vertices::layouts(&recipe.vertices);
        let buffers: Vec<_> = buffers.iter().map(|buffer| Some(buffer.as_layout())).collect();
        let (formats, blend, primitive, depth_stencil) = recipe.surface.state();
        let target = |&format: &wgpu::TextureFormat| {
            Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
        };
        let targets: Vec<_> = formats.iter().map(target).collect();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(recipe.entries[0]),
                compilation_options: options.clone(),
                buffers: &buffers,
            },
            primitive,
            depth_stencil,
            multisample: wgpu::MultisampleState { count: recipe.samples.count(), ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(recipe.entries[1]),
                compilation_options: options,
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn layer_opacity(layer: Layer) -> f64 {
    match layer {
        Layer::Seen => 1.0,
        Layer::Behind => FAINT,
    }
}

type State = (
    &'static [wgpu::TextureFormat],
    Option<wgpu::BlendState>,
    wgpu::PrimitiveState,
    Option<wgpu::DepthStencilState>,
);

impl Surface {
    fn state(&self) -> State {
        // Nearer is greater.
        let depth = |writes, compare| {
            Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(writes),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            })
        };
        match *self {
            Self::Scene | Self::Places => {
                // Back faces are invisible.
                let primitive =
                    wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() };
                let formats = if let Self::Places = self { &PLACES[..] } else { &[HDR] };
                (formats, None, primitive, depth(true, wgpu::CompareFunction::Greater))
            }
            Self::Backdrop => {
                (&[HDR], None, wgpu::PrimitiveState::default(), depth(false, wgpu::CompareFunction::Always))
            }
            Self::Overlay(layer, topology, polygon_mode) => {
                let compare = match layer {
                    Layer::Seen => wgpu::CompareFunction::GreaterEqual,
                    Layer::Behind => wgpu::CompareFunction::Less,
                };
                // Strips of marks face the camera either way; edges and borders belong to visible faces.
                let of_faces = topology == wgpu::PrimitiveTopology::TriangleList;
                let primitive = wgpu::PrimitiveState {
                    topology,
                    polygon_mode,
                    cull_mode: of_faces.then_some(wgpu::Face::Back),
                    ..Default::default()
                };
                let blend = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;
                (&[PICTURE], Some(blend), primitive, depth(false, compare))
            }
            Self::PointLight => (&[POINT_LIGHT], None, wgpu::PrimitiveState::default(), None),
            Self::Screen(blend) => (&[PICTURE], blend, wgpu::PrimitiveState::default(), None),
        }
    }
}
