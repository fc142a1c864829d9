use crate::scenes::{AtVertices, light_on, plain};
use glam::Vec3;
use lumel_export::{RadFile, ReadError, position_md5};
use lumel_testkit::shared;
use std::fs;

const COURSE_MD5: &str = "8be9aa68f5980b7a40a64073493a861b";

#[test]
fn light_on_a_scene_survives() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rad");
    let scene = plain("box");
    let light = light_on(&scene);
    let rad = RadFile::from_lighting(&scene, &AtVertices(light.clone())).unwrap();
    rad.write(&path).unwrap();
    let read = RadFile::read(&path).unwrap();
    assert_eq!(read, rad);
    assert!(read.matches(&scene));
    assert!(!read.matches(&crate::scenes::colourful()));
    for (a, b) in read.irradiance().iter().zip(&light) {
        assert!((*a - *b).length() <= 1e-6 * b.length());
    }
    let bad = RadFile { position_md5: "AB".into(), ..rad };
    assert!(bad.write(&path).unwrap_err().to_string().starts_with("\"AB\" is not an MD5: \""));
    assert_eq!(RadFile::read(&path).unwrap(), read);
}

#[test]
fn a_file_is_the_length_of_the_md5_the_md5_and_little_endian_numbers() {
    let positions = [Vec3::new(0.0, 0.5, -1.0), Vec3::new(1.25, 2.0, -0.0)];
    // Computed by Python's hashlib over `struct.pack("<6f", 0, 0.5, -1, 1.25, 2, -0.0)`.
    let md5 = "9f641ed3893aebac32cb57f8a1de62fa";
    assert_eq!(position_md5(positions.map(|p| p.as_dvec3())), md5);
    let mut bytes = b"\x20\0\0\0".to_vec();
    bytes.extend_from_slice(md5.as_bytes());
    // 1, 0.5, 0 and -2, 0, 0.25.
    bytes.extend_from_slice(b"\0\0\x80\x3f\0\0\0\x3f\0\0\0\0\0\0\0\xc0\0\0\0\0\0\0\x80\x3e");
    let folder = tempfile::tempdir().unwrap();
    let [given, written] = ["given.rad", "written.rad"].map(|name| folder.path().join(name));
    fs::write(&given, &bytes).unwrap();
    let rad = RadFile::read(&given).unwrap();
    assert_eq!(rad.position_md5, md5);
    assert_eq!(rad.values, [Vec3::new(1.0, 0.5, 0.0), Vec3::new(-2.0, 0.0, 0.25)]);
    rad.write(&written).unwrap();
    assert_eq!(fs::read(&written).unwrap(), bytes);
}

#[test]
fn course_files_are_written_again_byte_for_byte() {
    let Some(course) = shared::path_or_skip("scenes/course-cornell") else { return };
    let folder = tempfile::tempdir().unwrap();
    for name in ["cornell-2bounces.rad", "student2013-0bounces.rad", "student2013-2bounces.rad"] {
        let rad = RadFile::read(&course.join(name)).unwrap();
        assert_eq!((rad.values.len(), rad.position_md5.as_str()), (31_440, COURSE_MD5));
        let copy = folder.path().join(name);
        rad.write(&copy).unwrap();
        assert!(fs::read(&copy).unwrap() == fs::read(course.join(name)).unwrap());
    }
}

#[test]
fn the_md5_of_the_course_mesh_is_that_in_its_solutions() {
    let Some(course) = shared::path_or_skip("scenes/course-cornell") else { return };
    let text = fs::read_to_string(course.join("cornell-tessellated.obj")).unwrap();
    let coordinates = text.lines().filter_map(|line| line.strip_prefix("v "));
    let positions: Vec<Vec3> = coordinates
        .map(|line| {
            let numbers: Vec<f32> = line.split_whitespace().map(|n| n.parse().unwrap()).collect();
            Vec3::from_slice(&numbers)
        })
        .collect();
    assert_eq!(
        (positions.len(), position_md5(positions.iter().map(|p| p.as_dvec3())).as_str()),
        (31_440, COURSE_MD5)
    );
}

#[test]
fn other_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rad");
    fs::write(&path, "#?RADIANCE\n").unwrap();
    let error = RadFile::read(&path).unwrap_err();
    assert!(matches!(error, ReadError::BadFile { .. }));
    assert!(error.to_string().starts_with("this is not a .rad file"), "{error}");
    assert!(matches!(RadFile::read(folder.path()), Err(ReadError::Io { .. })));
}
