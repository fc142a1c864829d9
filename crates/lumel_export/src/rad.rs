//! The course's solution files, `*.rad`.

use crate::{ExportError, ReadError, write_atomically};
use glam::{DVec3, Vec3};
use lumel_basis::{Lighting, VertexCountError, irradiance_at_vertices};
use lumel_scene::{Irradiance, Radiance, Scene};
use md5::{Digest, Md5};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// Hexadecimal digits of an MD5.
const N_DIGITS: usize = 32;
/// Bytes of an RGB value.
const VALUE_SIZE: usize = 12;

/// One RGB value per vertex of a mesh that is identified by the MD5 of its positions.
///
/// A value is irradiance divided by π, summed over all bounces; times the albedo, it is radiance. The file
/// holds no lights, materials or settings.
#[derive(Clone, Debug, PartialEq)]
pub struct RadFile {
    /// MD5 of the packed `f32` positions, 32 lower-case hexadecimal digits.
    pub position_md5: String,
    /// Irradiance over π per vertex, W·m⁻²·sr⁻¹.
    pub values: Vec<Vec3>,
}

/// MD5 of positions in world space as defined by the course: over their packed little-endian `f32` coordinates.
pub fn position_md5(positions: impl IntoIterator<Item = DVec3>) -> String {
    let mut hasher = Md5::new();
    for number in positions.into_iter().flat_map(|p| p.as_vec3().to_array()) {
        hasher.update(number.to_le_bytes());
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

impl RadFile {
    /// The light at the vertices of a scene.
    ///
    /// # Errors
    /// [`VertexCountError`] for light of a different scene.
    pub fn from_lighting(scene: &Scene, lighting: &dyn Lighting) -> Result<Self, VertexCountError> {
        let irradiance = irradiance_at_vertices(scene, lighting)?;
        let values = irradiance.iter().map(|&e| crate::display::white_radiance(e)).collect();
        Ok(Self { position_md5: position_md5(scene.world_positions()), values })
    }

    /// Irradiance per vertex, W·m⁻².
    pub fn irradiance(&self) -> Vec<Vec3> {
        let irradiance = self.values.iter().map(|&value| {
            let Irradiance(e) = Radiance(value).cosine_sample();
            e
        });
        irradiance.collect()
    }

    /// Whether this is light for the scene's vertices, in the same order.
    pub fn matches(&self, scene: &Scene) -> bool {
        self.values.len() == scene.vertex_count()
            && self.position_md5 == position_md5(scene.world_positions())
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, is not of this format, or holds values that are not finite.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let mut bytes = Vec::new();
        File::open(path).and_then(|mut file| file.read_to_end(&mut bytes)).map_err(io_error)?;
        Self::parse(&bytes).map_err(|problem| ReadError::BadFile { path: path.to_owned(), problem })
    }

    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let not_rad = || "this is not a .rad file: it does not begin with the MD5 of a mesh".to_owned();
        let (length, rest) = bytes.split_first_chunk().ok_or_else(not_rad)?;
        let (digits, values) = rest.split_at_checked(N_DIGITS).ok_or_else(not_rad)?;
        let is_md5 = digits.iter().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'));
        if u32::from_le_bytes(*length) as usize != N_DIGITS || !is_md5 {
            return Err(not_rad());
        }
        if values.len() % VALUE_SIZE != 0 {
            return Err("the file ends within a value: it is incomplete".into());
        }
        let (numbers, _) = values.as_chunks::<4>();
        let numbers: Vec<f32> = numbers.iter().map(|&number| f32::from_le_bytes(number)).collect();
        let values: Vec<Vec3> = numbers.chunks_exact(3).map(Vec3::from_slice).collect();
        if let Some(vertex) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!("the value of vertex {vertex} is not a finite number"));
        }
        Ok(Self { position_md5: digits.iter().map(|&c| char::from(c)).collect(), values })
    }

    /// Writes the file, atomically.
    ///
    /// # Errors
    /// An MD5 that is not 32 lower-case hexadecimal digits, and the errors of [`write_atomically`].
    pub fn write(&self, path: &Path) -> Result<(), ExportError> {
        let digits = self.position_md5.as_bytes();
        if digits.len() != N_DIGITS || !digits.iter().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f')) {
            return Err(ExportError::content(path, format!("\"{}\" is not an MD5", self.position_md5)));
        }
        write_atomically(path, |out| self.encode(out))
    }

    fn encode(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&(N_DIGITS as u32).to_le_bytes())?;
        out.write_all(self.position_md5.as_bytes())?;
        for number in self.values.iter().flat_map(|v| v.to_array()) {
            out.write_all(&number.to_le_bytes())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> (RadFile, Vec<u8>) {
        let rad = RadFile {
            position_md5: "0123456789abcdef0123456789abcdef".into(),
            values: vec![Vec3::new(0.5, 1.0, -0.0), Vec3::splat(3e-9)],
        };
        let mut bytes = Vec::new();
        rad.encode(&mut bytes).unwrap();
        (rad, bytes)
    }

    #[test]
    fn files_survive_and_damaged_ones_are_refused() {
        let (rad, bytes) = small();
        assert_eq!(bytes.len(), 4 + 32 + 24);
        assert_eq!(RadFile::parse(&bytes).unwrap(), rad);
        for end in 0..bytes.len() {
            let cut = RadFile::parse(&bytes[..end]);
            // Nothing in a file says how many values it has.
            assert_eq!(cut.is_ok(), end >= 36 && (end - 36) % 12 == 0, "{end}");
        }
        for (at, byte) in [(0, 31), (3, 1), (4, b'A'), (35, b'g'), (39, 0x7f)] {
            let mut damaged = bytes.clone();
            damaged[at] = byte;
            damaged[38] = 0x80;
            assert!(RadFile::parse(&damaged).is_err(), "{at}");
        }
    }

    #[test]
    fn the_md5_is_that_of_the_packed_bytes() {
        // md5sum of 12 zero bytes.
        assert_eq!(position_md5([DVec3::ZERO]), "8dd6bb7329a71449b0a1b292b5999164");
        assert_eq!(position_md5([]), "d41d8cd98f00b204e9800998ecf8427e");
    }

    #[test]
    fn values_are_irradiance_over_pi() {
        let rad = RadFile { position_md5: String::new(), values: vec![Vec3::ONE] };
        let e = rad.irradiance()[0];
        assert!((crate::display::white_radiance(e) - Vec3::ONE).length() < 1e-6);
        assert!(e.x > 3.0);
    }
}
