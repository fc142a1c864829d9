//! Typed, checked access to vertex data and indices.
//!
//! Every accessor is checked once, in 64 bits and before anything is allocated; afterwards, reading elements cannot
//! fail. Elements are read in place, so that a small primitive in a huge accessor costs little.
//!
//! Khronos Group, *glTF 2.0 Specification*, 3.6.2.

use super::buffers::Buffers;
use super::document::Document;
use super::fault::Fault;
use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{Accessor, ComponentType, Type};
use gltf_json::validation::Checked;
use std::cell::OnceCell;

/// The largest number of elements of an accessor without a buffer view: zeros, or zeros with a few sparse values. Real
/// files use them for morph targets that move few vertices.
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

    /// The elements of an accessor; `user` names the referring item in messages.
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
            Checked::Valid(Type::Mat4) => 16,
            _ => return Err(Fault::at(place, "its type is none of SCALAR, VEC2, VEC3, VEC4 and MAT4")),
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
    /// Components per element: 1 to 4, or 16.
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

/// Sparse values, which replace a few of the others.
#[derive(Clone, Copy, Debug)]
struct Overlay<'a> {
    /// The indices of the elements, in increasing order.
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
    /// `None` means zeros.
    stored: Option<Array<'a>>,
    sparse: Option<Overlay<'a>>,
}

impl Elements<'_> {
    /// The number of elements.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Components per element: 1 to 4, or 16.
    pub(super) fn width(&self) -> usize {
        self.layout.width
    }

    /// Whether they can be indices: unsigned scalars.
    pub(super) fn are_indices(&self) -> bool {
        self.layout.width == 1 && self.are_unsigned()
    }

    /// Whether their components are unsigned integers.
    pub(super) fn are_unsigned(&self) -> bool {
        use ComponentType::{U8, U16, U32};
        matches!(self.layout.component, U8 | U16 | U32)
    }

    /// Whether integers are read as fractions of their largest value.
    pub(super) fn is_normalized(&self) -> bool {
        self.layout.normalized
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

    /// An element's first `N` components as indices, zero where it has fewer. `i` must be less than the count.
    pub(super) fn indices<const N: usize>(&self, i: usize) -> [u32; N] {
        let component = self.layout.component;
        let mut components = self.bytes(i).chunks_exact(component.size());
        std::array::from_fn(|_| components.next().map_or(0, |bytes| unsigned(component, bytes)))
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
mod tests;
