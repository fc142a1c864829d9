//! Typed, checked access to vertex data and indices.
//!
//! Every accessor is checked once, in 64 bits and before anything is allocated; reading elements cannot fail after
//! that. Elements are read where they lie, so that a small primitive of a huge accessor costs little.
//!
//! Khronos Group, *glTF 2.0 Specification*, 3.6.2.

use super::buffers::Buffers;
use super::document::Document;
use super::fault::Fault;
use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{Accessor, ComponentType, Type};
use gltf_json::validation::Checked;
use std::cell::OnceCell;

/// The most elements an accessor may have of which the file holds none: nothing but zeros, or zeros with a few sparse
/// values. Real files have them for a morph target's few moved vertices.
const MAX_UNSTORED: u64 = 1 << 22;

/// The accessors of a document.
pub(super) struct Accessors<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    checked: Vec<OnceCell<Elements<'a>>>,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'a>) -> Self {
        let checked = document.accessors.iter().map(|_| OnceCell::new()).collect();
        Self { document, buffers, checked }
    }

    /// The elements of an accessor; `user` is who asks.
    pub(super) fn elements(&self, index: usize, user: &str) -> Result<Elements<'a>, Fault> {
        let absent = || Fault::absent(user, "accessor", index, self.checked.len());
        let cell = self.checked.get(index).ok_or_else(absent)?;
        if let Some(elements) = cell.get() {
            return Ok(*elements);
        }
        let elements = self.check(&self.document.accessors[index], &format!("accessor {index}"))?;
        Ok(*cell.get_or_init(|| elements))
    }

    fn check(&self, accessor: &Accessor, place: &str) -> Result<Elements<'a>, Fault> {
        let Checked::Valid(component) = accessor.component_type else {
            return Err(Fault::at(place, "its componentType is none of 5120 to 5123, 5125 and 5126"));
        };
        let width = match accessor.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            Checked::Valid(Type::Vec4) => 4,
            _ => return Err(Fault::at(place, "its type is none of SCALAR, VEC2, VEC3 and VEC4")),
        };
        let layout = Layout { component: component.0, normalized: accessor.normalized, width };
        let count = accessor.count.0;
        let stored = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                Some(self.array(view.value(), offset, count, layout.size(), place)?)
            }
            None if count > MAX_UNSTORED => {
                let problem =
                    format!("it has {count} elements but no bufferView; at most {MAX_UNSTORED} can be");
                return Err(Fault::at(place, problem));
            }
            None => None,
        };
        let sparse = accessor.sparse.as_ref().map(|sparse| self.overlay(sparse, count, layout, place));
        Ok(Elements { layout, count: count as usize, stored, sparse: sparse.transpose()? })
    }

    /// `count` elements of `size` bytes in a buffer view.
    fn array(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
        place: &str,
    ) -> Result<Array<'a>, Fault> {
        let bytes = self.buffers.view(view, place)?;
        let stride = self.document.views[view].byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            let problem =
                format!("bufferView {view} has a byteStride of {stride} for elements of {size} bytes");
            return Err(Fault::at(place, problem));
        }
        let end = match count.checked_sub(1) {
            None => Some(offset),
            Some(gaps) => (gaps.checked_mul(stride as u64))
                .and_then(|start| start.checked_add(size as u64))
                .and_then(|length| length.checked_add(offset)),
        };
        match end {
            Some(end) if end <= bytes.len() as u64 => {
                Ok(Array { bytes: &bytes[offset as usize..end as usize], stride, size })
            }
            _ => {
                let (size, room) = (size, bytes.len());
                let problem = format!(
                    "{count} elements of {size} bytes, {stride} apart, do not fit the {room} bytes of bufferView \
                     {view} from byte {offset}"
                );
                Err(Fault::at(place, problem))
            }
        }
    }

    fn overlay(
        &self,
        sparse: &Sparse,
        count: u64,
        layout: Layout,
        place: &str,
    ) -> Result<Overlay<'a>, Fault> {
        let place = format!("{place}, sparse");
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(Fault::at(place, "its indices' componentType is none of 5121, 5123 and 5125"));
        };
        let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
        let indices = self.array(view, offset, sparse.count.0, component.0.size(), &place)?;
        let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
        let values = self.array(view, offset, sparse.count.0, layout.size(), &place)?;
        let overlay = Overlay { indices, component: component.0, values, count: sparse.count.0 as usize };
        let mut least = 0;
        for i in 0..overlay.count {
            let index = u64::from(overlay.index(i));
            if index < least || index >= count {
                let problem =
                    format!("index {index} at {i} is not above the one before it and below {count}");
                return Err(Fault::at(place, problem));
            }
            least = index + 1;
        }
        Ok(overlay)
    }
}

/// How the components of an element are stored.
#[derive(Clone, Copy, Debug)]
struct Layout {
    component: ComponentType,
    normalized: bool,
    /// Components per element, 1 to 4.
    width: usize,
}

impl Layout {
    fn size(self) -> usize {
        self.component.size() * self.width
    }
}

/// Elements side by side or `stride` apart; the bytes reach from the first to the end of the last.
#[derive(Clone, Copy, Debug)]
struct Array<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Array<'a> {
    fn get(&self, index: usize) -> &'a [u8] {
        let start = index * self.stride;
        self.bytes.get(start..start + self.size).unwrap_or_default()
    }
}

/// Values that replace a few of the others.
#[derive(Clone, Copy, Debug)]
struct Overlay<'a> {
    /// Which elements, in rising order.
    indices: Array<'a>,
    component: ComponentType,
    values: Array<'a>,
    count: usize,
}

impl<'a> Overlay<'a> {
    fn index(&self, i: usize) -> u32 {
        unsigned(self.component, self.indices.get(i))
    }

    fn get(&self, index: usize) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low + (high - low) / 2;
            match (self.index(middle) as usize).cmp(&index) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
                std::cmp::Ordering::Equal => return Some(self.values.get(middle)),
            }
        }
        None
    }
}

/// The elements of an accessor whose bounds have been checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elements<'a> {
    layout: Layout,
    count: usize,
    /// `None` stands for zeros.
    stored: Option<Array<'a>>,
    sparse: Option<Overlay<'a>>,
}

impl Elements<'_> {
    /// How many.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Components per element, 1 to 4.
    pub(super) fn width(&self) -> usize {
        self.layout.width
    }

    /// Whether they can be indices: unsigned scalars.
    pub(super) fn are_indices(&self) -> bool {
        use ComponentType::{U8, U16, U32};
        self.layout.width == 1 && matches!(self.layout.component, U8 | U16 | U32)
    }

    /// The same elements, integers read as fractions of their largest value.
    pub(super) fn normalized(mut self) -> Self {
        self.layout.normalized = true;
        self
    }

    /// An element as an index. `i` must be less than the count.
    pub(super) fn index(&self, i: usize) -> u32 {
        unsigned(self.layout.component, self.bytes(i))
    }

    /// An element's first `N` components as numbers, zero where it has fewer. `i` must be less than the count.
    pub(super) fn vector<const N: usize>(&self, i: usize) -> [f32; N] {
        let Layout { component, normalized, .. } = self.layout;
        let mut components = self.bytes(i).chunks_exact(component.size());
        std::array::from_fn(|_| components.next().map_or(0.0, |bytes| number(component, normalized, bytes)))
    }

    fn bytes(&self, i: usize) -> &[u8] {
        let replaced = self.sparse.as_ref().and_then(|sparse| sparse.get(i));
        replaced.or(self.stored.as_ref().map(|stored| stored.get(i))).unwrap_or_default()
    }
}

/// A component as a whole number; zero for signed and floating-point ones.
fn unsigned(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, &[a]) => u32::from(a),
        (ComponentType::U16, &[a, b]) => u32::from(u16::from_le_bytes([a, b])),
        (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}

/// A component as a number; the equations for normalised integers are those of the specification, 3.6.2.2.
fn number(component: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, largest) = match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
        (ComponentType::I8, &[a]) => (f32::from(a as i8), f32::from(i8::MAX)),
        (ComponentType::I16, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])), f32::from(i16::MAX)),
        (ComponentType::U8, _) => (unsigned(component, bytes) as f32, f32::from(u8::MAX)),
        (ComponentType::U16, _) => (unsigned(component, bytes) as f32, f32::from(u16::MAX)),
        (ComponentType::U32, _) => (unsigned(component, bytes) as f32, u32::MAX as f32),
        _ => return 0.0,
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PathPolicy;
    use crate::gltf::container::Container;
    use crate::gltf::testing::{F32, Model, U8, U16, U32};
    use crate::paths::Resolver;
    use lumel_scene::Warnings;
    use serde_json::json;
    use std::path::Path;

    /// The elements of the last accessor, or what is wrong with it.
    fn elements<const N: usize>(model: &Model) -> Result<Vec<[f32; N]>, String> {
        let glb = model.glb();
        let container = Container::open(&glb).unwrap();
        let document = Document::parse(container.json, &mut Warnings::default()).unwrap();
        let resolver = Resolver::new(Path::new("model.glb"), PathPolicy::WithinFolder).unwrap();
        let buffers = Buffers::new(&document, container.bin, &resolver);
        let accessors = Accessors::new(&document, &buffers);
        let elements = accessors.elements(document.accessors.len() - 1, "test").map_err(|e| e.to_string())?;
        Ok((0..elements.count()).map(|i| elements.vector(i)).collect())
    }

    fn one(component: u32, kind: &str, count: u64, bytes: &[u8]) -> Model {
        let mut model = Model::empty();
        model.accessor(component, kind, count, bytes);
        model
    }

    #[test]
    fn every_component_type_is_read_plain_and_normalised() {
        let i16s = [0x80_u8, 0xff, 0x00, 0x80]; // -128, -32768
        let cases: [(u32, &[u8], [f32; 2], [f32; 2]); 6] = [
            (5120, &[0x7f, 0x80], [127.0, -128.0], [1.0, -1.0]),
            (U8, &[0, 255], [0.0, 255.0], [0.0, 1.0]),
            (5122, &i16s, [-128.0, -32_768.0], [-128.0 / 32_767.0, -1.0]),
            (U16, &[0xff, 0xff, 1, 0], [65_535.0, 1.0], [1.0, 1.0 / 65_535.0]),
            (U32, &[0xff; 8], [4_294_967_295.0; 2], [1.0; 2]),
            (F32, &[0, 0, 0, 0xbf, 0, 0, 0x20, 0x40], [-0.5, 2.5], [-0.5, 2.5]),
        ];
        for (component, bytes, plain, normalized) in cases {
            let mut model = one(component, "VEC2", 1, bytes);
            assert_eq!(elements(&model).unwrap(), [plain], "{component}");
            model.json["accessors"][0]["normalized"] = json!(true);
            assert_eq!(elements(&model).unwrap(), [normalized], "{component}");
        }
    }

    #[test]
    fn strides_and_offsets_are_followed() {
        let mut model = one(U8, "VEC2", 3, &[9, 9, 1, 2, 9, 3, 4, 9, 5, 6]);
        model.json["bufferViews"][0]["byteOffset"] = json!(1);
        model.json["bufferViews"][0]["byteLength"] = json!(9);
        model.json["bufferViews"][0]["byteStride"] = json!(3);
        model.json["accessors"][0]["byteOffset"] = json!(1);
        assert_eq!(elements(&model).unwrap(), [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]);
        model.json["accessors"][0]["byteOffset"] = json!(2);
        assert_eq!(
            elements::<2>(&model).unwrap_err(),
            "accessor 0: 3 elements of 2 bytes, 3 apart, do not fit the 9 bytes of bufferView 0 from byte 2"
        );
        model.json["bufferViews"][0]["byteStride"] = json!(1);
        assert!(elements::<2>(&model).unwrap_err().contains("byteStride of 1 for elements of 2 bytes"));
    }

    #[test]
    fn without_a_buffer_view_there_are_zeros() {
        let mut model = one(F32, "VEC3", 2, &[]);
        model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        assert_eq!(elements(&model).unwrap(), [[0.0; 3]; 2]);
    }

    fn sparse(indices: &[u8], n_values: u8) -> Model {
        let mut model = Model::empty();
        let indices_view = model.view(indices);
        let values: Vec<u8> = (0..n_values).map(|v| 100 + v).collect();
        let values_view = model.view(&values);
        model.accessor(U8, "SCALAR", 5, &[1, 2, 3, 4, 5]);
        model.json["accessors"][0]["sparse"] = json!({
            "count": indices.len(),
            "indices": { "bufferView": indices_view, "componentType": U8 },
            "values": { "bufferView": values_view },
        });
        model
    }

    #[test]
    fn sparse_values_replace_their_elements() {
        let mut model = sparse(&[0, 3, 4], 3);
        assert_eq!(elements(&model).unwrap(), [[100.0], [2.0], [3.0], [101.0], [102.0]]);
        model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        assert_eq!(elements(&model).unwrap(), [[100.0], [0.0], [0.0], [101.0], [102.0]]);
    }

    #[test]
    fn sparse_indices_must_rise_and_stay_inside() {
        for bad in [[1, 1], [3, 2], [2, 5]] {
            let message = elements::<1>(&sparse(&bad, 2)).unwrap_err();
            assert!(message.starts_with("accessor 0, sparse: index "), "{bad:?}: {message}");
        }
        assert!(elements::<1>(&sparse(&[0, 1], 1)).unwrap_err().contains("do not fit"));
    }

    #[test]
    fn absurd_sizes_are_refused_before_anything_is_allocated() {
        let mut zeros = one(F32, "VEC3", 4_000_000_000, &[]);
        zeros.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        assert_eq!(
            elements::<3>(&zeros).unwrap_err(),
            "accessor 0: it has 4000000000 elements but no bufferView; at most 4194304 can be"
        );
        for count in [2, 4_294_967_297, u64::MAX / 12, u64::MAX] {
            let message = elements::<3>(&one(F32, "VEC3", count, &[0; 12])).unwrap_err();
            assert!(message.contains("do not fit the 12 bytes"), "{count}: {message}");
        }
        let mut far = one(F32, "VEC3", 1, &[0; 12]);
        far.json["accessors"][0]["byteOffset"] = json!(u64::MAX);
        assert!(elements::<3>(&far).unwrap_err().contains("do not fit"));
        far.json["accessors"][0]["byteOffset"] = json!(0);
        far.json["bufferViews"][0]["byteStride"] = json!(u64::from(u32::MAX));
        assert!(elements::<3>(&far).is_ok(), "the last element needs no stride");
        assert_eq!(elements::<3>(&one(F32, "VEC3", 0, &[])).unwrap(), [[0.0; 3]; 0]);
    }

    #[test]
    fn unknown_types_and_references_are_named() {
        assert!(elements::<1>(&one(5124, "SCALAR", 1, &[0; 4])).unwrap_err().contains("componentType"));
        assert!(elements::<1>(&one(F32, "MAT2", 1, &[0; 16])).unwrap_err().contains("its type is none of"));
        let mut lost = one(F32, "SCALAR", 1, &[0; 4]);
        lost.json["accessors"][0]["bufferView"] = json!(7);
        assert_eq!(elements::<1>(&lost).unwrap_err(), "accessor 0: refers to bufferView 7 of 1");
    }
}
