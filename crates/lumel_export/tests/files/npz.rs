use crate::damage::{flips, truncations};
use crate::tools::numpy;
use lumel_export::{Array, ArrayData, NpzReader, ReadError, write_npz};
use std::fs;
use std::path::{Path, PathBuf};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn members() -> Vec<(&'static str, Array)> {
    vec![
        (
            "irradiance",
            Array { shape: vec![2, 3], data: ArrayData::F32(vec![0.1, -2.5, 3e-9, 1.0, 2.0, 3.0]) },
        ),
        ("valid", Array::list(ArrayData::Bool(vec![true, false]))),
        ("count", Array { shape: vec![], data: ArrayData::U32(vec![7]) }),
        ("nothing", Array { shape: vec![0, 3], data: ArrayData::F64(vec![]) }),
        ("bytes", Array::list(ArrayData::U8(vec![0, 255]))),
        ("signed", Array::list(ArrayData::I32(vec![i32::MIN, -1]))),
    ]
}

fn write_small(path: &Path) {
    write_npz(path, |npz| {
        npz.bytes("meta.json", b"{\"seed\": 1}")?;
        members().iter().try_for_each(|(name, array)| npz.array(name, array))
    })
    .unwrap();
}

/// A name with its array or its bytes.
type Member = (String, Option<Array>, Vec<u8>);

/// All that can be read.
fn read_all(path: &Path) -> Result<Vec<Member>, ReadError> {
    let mut npz = NpzReader::open(path)?;
    let mut all = Vec::new();
    for name in npz.names() {
        let array = if npz.has_array(&name) { Some(npz.array(&name)?) } else { None };
        let bytes = if array.is_none() { npz.bytes(&name)? } else { Vec::new() };
        all.push((name, array, bytes));
    }
    Ok(all)
}

#[test]
fn arrays_and_bytes_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    write_small(&path);
    let mut npz = NpzReader::open(&path).unwrap();
    assert_eq!(npz.names()[..2], ["meta.json", "irradiance"]);
    for (name, array) in members() {
        assert_eq!(npz.array(name).unwrap(), array);
    }
    assert_eq!(npz.bytes("meta.json").unwrap(), b"{\"seed\": 1}");
    let error = npz.array("tail").unwrap_err().to_string();
    assert!(
        error.starts_with("there is no \"tail\" in the file: \"") && error.ends_with("a.npz\""),
        "{error}"
    );
}

#[test]
fn equal_content_gives_equal_bytes_and_arrays_are_aligned() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a.npz"), folder.path().join("b.npz"));
    write_small(&a);
    write_small(&b);
    let bytes = fs::read(&a).unwrap();
    assert_eq!(bytes, fs::read(&b).unwrap());
    let starts: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i..].starts_with(b"\x93NUMPY")).collect();
    assert_eq!(starts.len(), members().len());
    assert!(starts.iter().all(|start| start % 64 == 0), "{starts:?}");
    // The bytes themselves are part of the promise: another system or version must not change them.
    assert_eq!(&bytes[..10], b"PK\x03\x04\x2d\0\0\0\0\0");
    let header = b"\x93NUMPY\x01\0\x76\0{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
    assert!(bytes[starts[0]..].starts_with(header));
    assert_eq!(&bytes[starts[0] + 128..starts[0] + 132], 0.1_f32.to_le_bytes());
}

#[test]
fn files_written_by_numpy_are_read() {
    let mut npz = NpzReader::open(&data("numpy.npz")).unwrap();
    assert_eq!(npz.names(), ["irradiance", "valid", "scale"]);
    assert_eq!(npz.array("irradiance").unwrap(), members()[0].1);
    assert_eq!(npz.array("valid").unwrap(), members()[1].1);
    assert_eq!(npz.array("scale").unwrap(), Array { shape: vec![], data: ArrayData::F64(vec![0.1]) });
}

#[test]
fn compressed_files_are_refused_with_the_remedy() {
    let error = NpzReader::open(&data("numpy-compressed.npz")).unwrap().array("a").unwrap_err().to_string();
    assert!(
        error.starts_with("\"a\" is compressed (written with savez_compressed?); use numpy.savez: \""),
        "{error}"
    );
}

#[test]
fn numpy_reads_what_we_write() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    write_small(&path);
    let script = r#"
f = np.load(path)
assert f["irradiance"].dtype == np.float32 and f["irradiance"].shape == (2, 3)
assert f["irradiance"].tolist() == np.float32([[0.1, -2.5, 3e-9], [1, 2, 3]]).tolist()
assert f["irradiance"][f["valid"]].shape == (1, 3)
assert f["count"].dtype == np.uint32 and f["count"] == 7
assert f["nothing"].shape == (0, 3) and f["nothing"].dtype == np.float64
assert f["bytes"].tolist() == [0, 255] and f["signed"].tolist() == [-2**31, -1]
assert f["meta.json"] == b'{"seed": 1}'
import zipfile
assert zipfile.ZipFile(path).testzip() is None
"#;
    numpy(script, &path);
}

#[test]
fn we_read_what_numpy_writes_today() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let script = r#"
import zipfile
class Pipe:
    "An output that cannot seek, so that sizes follow the data."
    def __init__(self, f): self.f = f
    def write(self, b): return self.f.write(b)
    def flush(self): self.f.flush()
    read = None
a = dict(f4=np.arange(6, dtype="<f4").reshape(1, 2, 3), u1=np.uint8([1, 2]), b1=np.array([True]))
np.savez(path, i8=np.arange(3), fortran=np.asfortranarray(np.ones((2, 3), "<f4")), **a)
with open(path + ".stream.npz", "wb") as f: np.savez(Pipe(f), **a)
"#;
    if numpy(script, &path).is_none() {
        return;
    }
    for path in [path.clone(), folder.path().join("a.npz.stream.npz")] {
        let mut npz = NpzReader::open(&path).unwrap();
        let f4 = Array { shape: vec![1, 2, 3], data: ArrayData::F32(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]) };
        assert_eq!(npz.array("f4").unwrap(), f4);
        assert_eq!(npz.array("u1").unwrap(), Array::list(ArrayData::U8(vec![1, 2])));
        assert_eq!(npz.array("b1").unwrap(), Array::list(ArrayData::Bool(vec![true])));
    }
    let mut npz = NpzReader::open(&path).unwrap();
    assert!(npz.array("i8").unwrap_err().to_string().contains("\"i8\" has numbers of type <i8"));
    assert!(npz.array("fortran").unwrap_err().to_string().contains("Fortran order"));
}

#[test]
fn damaged_files_are_errors_or_read_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    write_small(&path);
    let ours = fs::read(&path).unwrap();
    for good in [ours, fs::read(data("numpy.npz")).unwrap()] {
        fs::write(&path, &good).unwrap();
        let expected = read_all(&path).unwrap();
        for cut in truncations(&good) {
            fs::write(&path, cut).unwrap();
            assert!(read_all(&path).is_err(), "{} bytes are a whole file", cut.len());
        }
        for damaged in flips(&good) {
            fs::write(&path, &damaged).unwrap();
            // Names have no checksum but are there twice; only the same flip in both could pass.
            if let Ok(all) = read_all(&path) {
                assert_eq!(all, expected);
            }
        }
    }
}

/// A ZIP of one stored member that all its headers claim to have `claimed` bytes.
fn zip_of(name: &str, data: &[u8], claimed: u32) -> Vec<u8> {
    let size = claimed.to_le_bytes();
    let name_length = (name.len() as u16).to_le_bytes();
    // Version 2.0, no flags, stored, 1980-01-01, a checksum of zero.
    let common =
        [&[20, 0, 0, 0, 0, 0, 0, 0, 33, 0, 0, 0, 0, 0], &size[..], &size, &name_length, &[0, 0]].concat();
    let local = [b"PK\x03\x04", &common[..], name.as_bytes(), data].concat();
    let central = [b"PK\x01\x02\x14\0", &common[..], &[0; 14], name.as_bytes()].concat();
    let (length, start) = ((central.len() as u32).to_le_bytes(), (local.len() as u32).to_le_bytes());
    let end = [b"PK\x05\x06\0\0\0\0\x01\0\x01\0", &length[..], &start, &[0, 0]].concat();
    [local, central, end].concat()
}

#[test]
fn sizes_beyond_the_file_are_refused_before_anything_is_allocated() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let header =
        b"\x93NUMPY\x01\0\x46\0{'descr': '|u1', 'fortran_order': False, 'shape': (4000000000,), }    ";
    assert_eq!(header.len(), 80);
    fs::write(&path, zip_of("a.npy", header, 4_000_000_080)).unwrap();
    let error = NpzReader::open(&path).unwrap().array("a").unwrap_err().to_string();
    assert!(error.starts_with("\"a\" claims more bytes than the file has"), "{error}");
    fs::write(&path, zip_of("meta.json", b"{}", u32::MAX - 1)).unwrap();
    let error = NpzReader::open(&path).unwrap().bytes("meta.json").unwrap_err().to_string();
    assert!(error.contains("claims more bytes than the file has"), "{error}");
}

#[test]
fn what_is_no_archive_is_said_to_be_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let message = |path: &Path| NpzReader::open(path).err().unwrap().to_string();
    fs::write(&path, "P6 1 1 255").unwrap();
    assert!(message(&path).starts_with("this is not a NumPy archive (.npz)"));
    fs::write(&path, "").unwrap();
    assert!(message(&path).starts_with("this is not a NumPy archive (.npz)"));
    assert!(message(folder.path()).contains("this is not a file"));
    assert!(message(&folder.path().join("b.npz")).starts_with("cannot read ("));
}

#[test]
fn a_wrong_shape_or_a_name_given_twice_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let array = Array { shape: vec![3], data: ArrayData::U8(vec![1, 2]) };
    let error = write_npz(&path, |npz| npz.array("a", &array)).unwrap_err();
    assert!(error.to_string().contains("shape [3] has 2 numbers"), "{error}");
    let twice = |npz: &mut lumel_export::NpzWriter<'_>| {
        npz.bytes("a", b"1")?;
        npz.bytes("a", b"2")
    };
    assert!(write_npz(&path, twice).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
