//! Checks of a PLY header, before anything is allocated.

use super::elements::INDEX_NAMES;
use crate::ImportError;
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};
use std::path::Path;

/// Refuses headers that declare more data than the file can contain.
pub(super) fn check_counts(path: &Path, header: &Header, length: u64) -> Result<(), ImportError> {
    let mut needed = 0_u64;
    for element in header.elements.values() {
        let properties = element.properties.values();
        let smallest: u64 = match header.encoding {
            Encoding::Ascii => 2 * properties.len() as u64,
            _ => properties.map(|property| smallest_size(&property.data_type)).sum(),
        };
        needed = needed.saturating_add(smallest.max(1).saturating_mul(element.count as u64));
        // One more, because the last line of a text file may lack its end.
        if needed > length + 1 {
            let message = format!("{} elements \"{}\" do not fit the file", element.count, element.name);
            return Err(ImportError::malformed(path, format!("{message}; it is cut off or damaged")));
        }
    }
    Ok(())
}

/// The fewest bytes a property takes in a binary file: lists may be empty.
fn smallest_size(property: &PropertyType) -> u64 {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = property;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Refuses faces and strips without indices.
pub(super) fn check_indices(path: &Path, element: &ElementDef) -> Result<(), ImportError> {
    if INDEX_NAMES.iter().any(|&name| element.properties.contains_key(name)) {
        return Ok(());
    }
    let message = format!("element \"{}\" has no property {}", element.name, INDEX_NAMES.join(" or "));
    Err(ImportError::malformed(path, message))
}
