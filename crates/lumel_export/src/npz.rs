//! Archives of arrays: NumPy's NPZ, a ZIP of uncompressed members.
//!
//! The only module that knows the ZIP library.

use crate::npy::{Array, unreadable};
use crate::quiet::Quiet;
use crate::{ExportError, ReadError, write_atomically};
use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};
use zip::read::{ZipArchive, ZipReadOptions};
use zip::result::ZipError;
use zip::write::{SimpleFileOptions, ZipWriter};
use zip::{CompressionMethod, DateTime, System};

/// Arrays begin at a multiple of this many bytes, so that they can be mapped into memory.
const ALIGNMENT: u16 = 64;

/// Writes an archive atomically, member by member: what `numpy.load` opens.
///
/// The same members give the same bytes: times and systems are not recorded.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_npz(
    path: &Path,
    write: impl FnOnce(&mut NpzWriter<'_>) -> io::Result<()>,
) -> Result<(), ExportError> {
    write_atomically(path, |out| write_members(out, write))
}

fn write_members(
    out: &mut BufWriter<File>,
    write: impl FnOnce(&mut NpzWriter<'_>) -> io::Result<()>,
) -> io::Result<()> {
    let failure = Cell::new(None);
    let mut npz = NpzWriter { zip: ZipWriter::new(Quiet::new(out, &failure)), failure: &failure };
    write(&mut npz)?;
    npz.zip.finish()?;
    failure.take().map_or(Ok(()), Err)
}

/// Takes the members of an archive, in their order.
pub struct NpzWriter<'a> {
    zip: ZipWriter<Quiet<'a, &'a mut BufWriter<File>>>,
    /// What went wrong when bytes were written.
    failure: &'a Cell<Option<io::Error>>,
}

impl NpzWriter<'_> {
    /// Adds an array: `numpy.load(file)[name]`.
    ///
    /// # Errors
    /// A name given twice, a shape that does not fit its numbers, and all that writing meets.
    pub fn array(&mut self, name: &str, array: &Array) -> io::Result<()> {
        self.start(&format!("{name}.npy"))?;
        array.write(&mut self.zip)?;
        self.check()
    }

    /// Adds a member that is no array, such as `meta.json`; `numpy.load(file)[name]` returns its bytes.
    ///
    /// # Errors
    /// A name given twice, and all that writing meets.
    pub fn bytes(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.start(name)?;
        self.zip.write_all(bytes)?;
        self.check()
    }

    /// What has failed since the last time.
    fn check(&self) -> io::Result<()> {
        self.failure.take().map_or(Ok(()), Err)
    }

    fn start(&mut self, member: &str) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::DEFAULT)
            .system(System::Unix)
            .unix_permissions(0o644)
            // Without it, members end at 4 GiB.
            .large_file(true)
            .with_alignment(ALIGNMENT);
        Ok(self.zip.start_file(member, options)?)
    }
}

/// An archive open for reading.
///
/// Every size is compared with that of the file before anything is allocated, and every member with its checksum.
pub struct NpzReader {
    path: PathBuf,
    file_size: u64,
    zip: ZipArchive<BufReader<File>>,
}

impl NpzReader {
    /// Opens an archive and reads its table of contents.
    ///
    /// # Errors
    /// A file that cannot be read, is no archive, or is damaged at its end.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let io_error = |source| ReadError::Io { path: path.to_owned(), source };
        let file = File::open(path).map_err(io_error)?;
        let about = file.metadata().map_err(io_error)?;
        let bad_file = |problem: String| ReadError::BadFile { path: path.to_owned(), problem };
        if !about.is_file() {
            return Err(bad_file("this is not a file".into()));
        }
        let zip = ZipArchive::new(BufReader::new(file)).map_err(|error| match error {
            ZipError::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => io_error(source),
            error => bad_file(format!(
                "this is not a NumPy archive (.npz), or it is damaged or incomplete ({error})"
            )),
        })?;
        if zip.has_duplicate_names() {
            return Err(bad_file("two members have the same name: the file is damaged".into()));
        }
        Ok(Self { path: path.to_owned(), file_size: about.len(), zip })
    }

    /// The file being read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Names of the arrays and other members, in their order; arrays without their `.npy`.
    pub fn names(&self) -> Vec<String> {
        let names = self.zip.file_names_raw().map(|name| String::from_utf8_lossy(name));
        names.map(|name| name.strip_suffix(".npy").unwrap_or(&name).to_owned()).collect()
    }

    /// Whether there is an array of this name.
    pub fn has_array(&self, name: &str) -> bool {
        self.zip.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// Reads an array.
    ///
    /// # Errors
    /// An array that is missing, damaged, compressed, or of a type that is not supported.
    pub fn array(&mut self, name: &str) -> Result<Array, ReadError> {
        self.member(&format!("{name}.npy"), name, |input, size| Array::read(&mut BufReader::new(input), size))
    }

    /// Reads a member that is no array, such as `meta.json`.
    ///
    /// # Errors
    /// A member that is missing, damaged or compressed.
    pub fn bytes(&mut self, name: &str) -> Result<Vec<u8>, ReadError> {
        self.member(name, name, |input, size| {
            let mut bytes = Vec::with_capacity(size as usize);
            input.read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
            Ok(bytes)
        })
    }

    /// Hands a member and its size to `read`; problems are told of `label`.
    fn member<T>(
        &mut self,
        member: &str,
        label: &str,
        read: impl FnOnce(&mut dyn Read, u64) -> Result<T, String>,
    ) -> Result<T, ReadError> {
        let path = self.path.clone();
        let Some(index) = self.zip.index_for_name(member) else {
            return Err(ReadError::Missing { path, member: label.to_owned() });
        };
        read_stored(&mut self.zip, index, self.file_size, read).map_err(|problem| ReadError::BadMember {
            path,
            member: label.to_owned(),
            problem,
        })
    }
}

fn read_stored<T>(
    zip: &mut ZipArchive<impl Read + Seek>,
    index: usize,
    file_size: u64,
    read: impl FnOnce(&mut dyn Read, u64) -> Result<T, String>,
) -> Result<T, String> {
    let broken = |error: ZipError| match error {
        ZipError::Io(error) => unreadable(&error),
        error => format!("is damaged ({error})"),
    };
    let entry = zip.by_index_data(index).map_err(broken)?;
    if entry.encrypted() {
        return Err("is encrypted, which is not supported".into());
    }
    if entry.compression() != CompressionMethod::Stored {
        return Err("is compressed (written with savez_compressed?); use numpy.savez".into());
    }
    let size = entry.size();
    if size != entry.compressed_size() || size > file_size {
        return Err("claims more bytes than the file has: the file is damaged".into());
    }
    let options = ZipReadOptions::new().enforce_header_consistency(true);
    let mut input = zip.by_index_with_options(index, options).map_err(broken)?;
    read(&mut input, size)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::ArrayData;
    use std::fs::OpenOptions;

    #[test]
    fn a_full_device_is_reported_as_such() {
        let device = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let array = Array::list(ArrayData::U8(vec![1; 100_000]));
        let error = write_members(&mut BufWriter::new(device), |npz| npz.array("a", &array)).unwrap_err();
        let error = ExportError::io(Path::new("a.npz"), error);
        assert!(matches!(error, ExportError::DiskFull { .. }), "{error}");
    }
}
