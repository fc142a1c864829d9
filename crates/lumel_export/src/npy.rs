//! One array as NumPy stores it: a text header, then the numbers.

use std::io::{self, Read, Write};

const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// The whole header is a multiple of this, so that the numbers can be mapped into memory.
const ALIGNMENT: usize = 64;
/// No header that NumPy writes for a plain array comes near it.
const MAX_HEADER: usize = 1 << 16;

/// An array of numbers, the last index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length along each axis; empty for a single number.
    pub shape: Vec<usize>,
    /// The numbers; as many as the product of `shape`.
    pub data: ArrayData,
}

/// Numbers of one type. All are little-endian in files.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayData {
    /// `<f4`
    F32(Vec<f32>),
    /// `<f8`
    F64(Vec<f64>),
    /// `<u4`
    U32(Vec<u32>),
    /// `<i4`
    I32(Vec<i32>),
    /// `|u1`
    U8(Vec<u8>),
    /// `|b1`; an array that selects from others in NumPy, which one of bytes would not.
    Bool(Vec<bool>),
}

impl Array {
    /// A list of vectors: shape `(n, 3)`.
    pub fn from_vectors(vectors: &[glam::Vec3]) -> Self {
        let values = vectors.iter().flat_map(|v| v.to_array()).collect();
        Self { shape: vec![vectors.len(), 3], data: ArrayData::F32(values) }
    }

    /// A list of positions: shape `(n, 3)`; of `<f4` if that holds them exactly, else of `<f8`.
    pub fn from_positions(positions: &[glam::DVec3]) -> Self {
        let rounded: Vec<glam::Vec3> = positions.iter().map(|v| v.as_vec3()).collect();
        if rounded.iter().zip(positions).all(|(rounded, exact)| rounded.as_dvec3() == *exact) {
            return Self::from_vectors(&rounded);
        }
        let values = positions.iter().flat_map(|v| v.to_array()).collect();
        Self { shape: vec![positions.len(), 3], data: ArrayData::F64(values) }
    }

    /// A list: shape `(n)`.
    pub fn list(data: ArrayData) -> Self {
        Self { shape: vec![data.len()], data }
    }

    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        if element_count(&self.shape) != Some(self.data.len() as u64) {
            let problem = format!("an array of shape {:?} has {} numbers", self.shape, self.data.len());
            return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
        }
        out.write_all(&header(self.data.descr(), &self.shape))?;
        match &self.data {
            ArrayData::F32(values) => write_numbers(out, values, f32::to_le_bytes),
            ArrayData::F64(values) => write_numbers(out, values, f64::to_le_bytes),
            ArrayData::U32(values) => write_numbers(out, values, u32::to_le_bytes),
            ArrayData::I32(values) => write_numbers(out, values, i32::to_le_bytes),
            ArrayData::U8(values) => out.write_all(values),
            ArrayData::Bool(values) => write_numbers(out, values, |bit| [u8::from(bit)]),
        }
    }

    /// Reads an array that must take exactly `size` bytes, and the end of the input behind it.
    ///
    /// # Errors
    /// What is wrong, as the end of a sentence that begins with the array's name.
    pub(crate) fn read(input: &mut impl Read, size: u64) -> Result<Self, String> {
        let (header_size, text) = read_header(input, size)?;
        let Header { descr, shape } = Header::parse(&text)?;
        let item = item_size(&descr).ok_or_else(|| {
            format!("has numbers of type {descr}, which is not supported; convert it with astype(\"<f4\")")
        })?;
        let bytes = element_count(&shape).and_then(|n| n.checked_mul(item));
        if bytes != Some(size.saturating_sub(header_size)) {
            return Err(format!("has the shape {shape:?} but not as many numbers: the file is damaged"));
        }
        // Fits: the numbers are in a file that exists.
        let n = ((size - header_size) / item) as usize;
        let data = match descr.as_str() {
            "<f4" => ArrayData::F32(read_numbers(input, n, f32::from_le_bytes)?),
            "<f8" => ArrayData::F64(read_numbers(input, n, f64::from_le_bytes)?),
            "<u4" => ArrayData::U32(read_numbers(input, n, u32::from_le_bytes)?),
            "<i4" => ArrayData::I32(read_numbers(input, n, i32::from_le_bytes)?),
            "|b1" => ArrayData::Bool(read_numbers(input, n, |[byte]: [u8; 1]| byte != 0)?),
            _ => ArrayData::U8(read_numbers(input, n, |[byte]: [u8; 1]| byte)?),
        };
        // Only at the end of its input does an archive compare the checksum.
        match input.read(&mut [0]) {
            Ok(0) => Ok(Self { shape, data }),
            Ok(_) => Err("goes on behind its last number: the file is damaged".into()),
            Err(error) => Err(unreadable(&error)),
        }
    }
}

impl ArrayData {
    /// How many numbers.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::U8(values) => values.len(),
            Self::Bool(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// NumPy's name of the type.
    pub fn descr(&self) -> &'static str {
        match self {
            Self::F32(_) => "<f4",
            Self::F64(_) => "<f8",
            Self::U32(_) => "<u4",
            Self::I32(_) => "<i4",
            Self::U8(_) => "|u1",
            Self::Bool(_) => "|b1",
        }
    }
}

/// Bytes per number of the types that can be read.
fn item_size(descr: &str) -> Option<u64> {
    match descr {
        "<f8" => Some(8),
        "<f4" | "<u4" | "<i4" => Some(4),
        "|u1" | "|b1" => Some(1),
        _ => None,
    }
}

fn element_count(shape: &[usize]) -> Option<u64> {
    shape.iter().try_fold(1_u64, |n, &length| n.checked_mul(length as u64))
}

/// The header of format 1.0, as `numpy.save` writes it.
fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let mut text =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}{comma}), }}", lengths.join(", "));
    let before_text = MAGIC.len() + 4;
    let padded = (before_text + text.len() + 1).next_multiple_of(ALIGNMENT) - before_text;
    text = format!("{text:<width$}\n", width = padded - 1);
    // Some thousand dimensions would be needed for more than 16 bits.
    let length = u16::try_from(text.len()).unwrap_or(u16::MAX);
    [MAGIC.as_slice(), &[1, 0], &length.to_le_bytes(), text.as_bytes()].concat()
}

/// Reads up to the numbers; returns how many bytes that was, and the text of the header.
fn read_header(input: &mut impl Read, size: u64) -> Result<(u64, String), String> {
    let mut start = [0; 8];
    read_exact(input, &mut start)?;
    if start[..6] != *MAGIC {
        return Err("is not a NumPy array".into());
    }
    let (before_text, length) = match start[6] {
        1 => {
            let mut length = [0; 2];
            read_exact(input, &mut length)?;
            (10, usize::from(u16::from_le_bytes(length)))
        }
        2 | 3 => {
            let mut length = [0; 4];
            read_exact(input, &mut length)?;
            (12, u32::from_le_bytes(length) as usize)
        }
        version => return Err(format!("is a NumPy array of the unknown format {version}")),
    };
    if length > MAX_HEADER || (before_text + length) as u64 > size {
        return Err("has a header longer than itself: the file is damaged".into());
    }
    let mut text = vec![0; length];
    read_exact(input, &mut text)?;
    let text = String::from_utf8(text).map_err(|_| "has an unreadable header")?;
    Ok(((before_text + length) as u64, text))
}

/// What a header says.
struct Header {
    descr: String,
    shape: Vec<usize>,
}

impl Header {
    /// Reads the Python dictionary literal that NumPy writes; its keys may come in any order.
    fn parse(text: &str) -> Result<Self, String> {
        let damaged = || format!("has a header that is not NumPy's: {}", text.trim_end());
        let inside = text.trim().strip_prefix('{').and_then(|t| t.strip_suffix('}')).ok_or_else(damaged)?;
        let (mut descr, mut fortran, mut shape) = (None, None, None);
        let mut rest = inside.trim_start();
        while !rest.is_empty() {
            let (key, after_key) = quoted(rest).ok_or_else(damaged)?;
            let value = after_key.trim_start().strip_prefix(':').ok_or_else(damaged)?.trim_start();
            let end = match key {
                "descr" => {
                    let (name, after) = quoted(value).ok_or_else(|| {
                        "is an array of records, which is not supported; save its fields one by one"
                            .to_owned()
                    })?;
                    descr = Some(name.to_owned());
                    after
                }
                "fortran_order" => {
                    let (flag, after) = boolean(value).ok_or_else(damaged)?;
                    fortran = Some(flag);
                    after
                }
                "shape" => {
                    let (lengths, after) = tuple(value).ok_or_else(damaged)?;
                    shape = Some(lengths);
                    after
                }
                _ => return Err(damaged()),
            };
            let end = end.trim_start();
            rest = end.strip_prefix(',').unwrap_or(end).trim_start();
        }
        match (descr, fortran, shape) {
            (Some(descr), Some(false), Some(shape)) => Ok(Self { descr, shape }),
            (_, Some(true), _) => {
                Err("is stored column by column (Fortran order); save numpy.ascontiguousarray of it instead"
                    .into())
            }
            _ => Err(damaged()),
        }
    }
}

/// A quoted string at the start of `text`, and what follows it.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(quote)
}

fn boolean(text: &str) -> Option<(bool, &str)> {
    let as_true = text.strip_prefix("True").map(|after| (true, after));
    as_true.or_else(|| text.strip_prefix("False").map(|after| (false, after)))
}

fn tuple(text: &str) -> Option<(Vec<usize>, &str)> {
    let (inside, after) = text.strip_prefix('(')?.split_once(')')?;
    let items = inside.trim();
    let items = items.strip_suffix(',').unwrap_or(items);
    if items.is_empty() {
        return Some((Vec::new(), after));
    }
    // Python 2 wrote long integers with an L.
    let lengths = items.split(',').map(|n| n.trim().trim_end_matches('L').parse().ok());
    Some((lengths.collect::<Option<_>>()?, after))
}

fn write_numbers<T: Copy, const N: usize>(
    out: &mut impl Write,
    values: &[T],
    bytes: fn(T) -> [u8; N],
) -> io::Result<()> {
    let mut block = Vec::with_capacity(N * 4096);
    for values in values.chunks(4096) {
        block.clear();
        block.extend(values.iter().flat_map(|&value| bytes(value)));
        out.write_all(&block)?;
    }
    Ok(())
}

fn read_numbers<T, const N: usize>(
    input: &mut impl Read,
    n: usize,
    number: fn([u8; N]) -> T,
) -> Result<Vec<T>, String> {
    let mut values = Vec::with_capacity(n);
    let mut block = vec![[0; N]; n.min(4096)];
    while values.len() < n {
        let wanted = (n - values.len()).min(block.len());
        read_exact(input, block[..wanted].as_flattened_mut())?;
        values.extend(block[..wanted].iter().map(|&bytes| number(bytes)));
    }
    Ok(values)
}

fn read_exact(input: &mut impl Read, bytes: &mut [u8]) -> Result<(), String> {
    input.read_exact(bytes).map_err(|error| unreadable(&error))
}

pub(crate) fn unreadable(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "ends too early: the file is damaged or incomplete".into(),
        io::ErrorKind::InvalidData => format!("is damaged ({error})"),
        _ => format!("cannot be read ({error})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Array, String> {
        Array::read(&mut &bytes[..], bytes.len() as u64)
    }

    fn with_header(text: &str, data: &[u8]) -> Vec<u8> {
        [MAGIC.as_slice(), &[1, 0], &(text.len() as u16).to_le_bytes(), text.as_bytes(), data].concat()
    }

    #[test]
    fn headers_are_byte_for_byte_those_of_numpy() {
        let expected =
            b"\x93NUMPY\x01\x00\x76\x00{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
        let header = super::header("<f4", &[2, 3]);
        assert_eq!(header.len(), 128);
        assert!(header.starts_with(expected));
        assert!(header[expected.len()..127].iter().all(|&byte| byte == b' '));
        assert_eq!(header[127], b'\n');
        assert!(super::header("|b1", &[5]).windows(6).any(|part| part == b"(5,), "));
        assert!(super::header("<f8", &[]).windows(4).any(|part| part == b"(), "));
    }

    #[test]
    fn every_type_and_shape_survives() {
        let arrays = [
            Array::list(ArrayData::F32(vec![0.1, -0.0, f32::MIN_POSITIVE, f32::INFINITY])),
            Array { shape: vec![2, 2], data: ArrayData::F64(vec![1e300, -0.1, 0.0, 5.0]) },
            Array { shape: vec![1, 1, 3], data: ArrayData::U32(vec![0, 1, u32::MAX]) },
            Array { shape: vec![], data: ArrayData::I32(vec![i32::MIN]) },
            Array::list(ArrayData::U8((0..=255).collect())),
            Array::list(ArrayData::Bool(vec![true, false, true])),
            Array { shape: vec![0, 7, 3], data: ArrayData::F32(vec![]) },
            Array::list(ArrayData::F32((0..10_000).map(|i| i as f32).collect())),
        ];
        for array in arrays {
            let mut bytes = Vec::new();
            array.write(&mut bytes).unwrap();
            assert_eq!(read(&bytes).unwrap(), array);
        }
    }

    #[test]
    fn a_shape_without_its_numbers_is_not_written() {
        let array = Array { shape: vec![2, 3], data: ArrayData::U8(vec![1; 5]) };
        assert!(array.write(&mut Vec::new()).unwrap_err().to_string().contains("[2, 3] has 5 numbers"));
    }

    #[test]
    fn other_orders_of_keys_quotes_and_spaces_are_read() {
        let text = "{\"shape\" : ( 2L, 1L ), 'fortran_order':False,'descr' : \"|u1\"}\n";
        let array = read(&with_header(text, &[3, 4])).unwrap();
        assert_eq!(array, Array { shape: vec![2, 1], data: ArrayData::U8(vec![3, 4]) });
    }

    #[test]
    fn what_is_not_supported_is_refused_by_name() {
        let refused = |text: &str| read(&with_header(text, &[0; 8])).unwrap_err();
        let fortran = refused("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 1), }\n");
        assert!(fortran.contains("Fortran order") && fortran.contains("ascontiguousarray"), "{fortran}");
        for descr in [">f4", "<f2", "<i8", "<c8", "|O", "<U2", "<M8[ns]"] {
            let message =
                refused(&format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (1,), }}\n"));
            assert!(message.contains(descr) && message.contains("astype"), "{message}");
        }
        let records = refused("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1,), }\n");
        assert!(records.contains("records"), "{records}");
    }

    #[test]
    fn absurd_shapes_and_headers_are_errors_without_allocating() {
        for shape in
            ["(18446744073709551615, 2)", "(99999999999999999999,)", "(1000000000000,)", "(-1,)", "(1"]
        {
            let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
            assert!(read(&with_header(&text, &[0; 8])).is_err(), "{shape}");
        }
        for text in ["", "{", "{}", "{'descr'}", "{'descr': '<f4'}", "{'é': 1}", "{'shape': (1,), 'x': 1}"] {
            assert!(read(&with_header(text, &[])).is_err(), "{text}");
        }
        assert!(read(b"\x93NUMPY\x02\x00\xff\xff\xff\xff").is_err());
        assert!(read(b"\x93NUMPY\x09\x00\x00\x00").is_err());
        assert!(read(b"GIF89a\x00\x00").unwrap_err().contains("not a NumPy array"));
    }
}
