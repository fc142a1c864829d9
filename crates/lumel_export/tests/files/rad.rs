use crate::scenes::{light_on, plain};
use glam::Vec3;
use lumel_export::{RadFile, ReadError, position_md5};
use std::fs;
use std::path::{Path, PathBuf};

const COURSE_MD5: &str = "8be9aa68f5980b7a40a64073493a861b";

/// The course's files, when they lie beside the repository.
fn course() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes/course-cornell");
    if !folder.is_dir() {
        assert!(std::env::var_os("CI").is_none(), "CI must have {}", folder.display());
        println!("skipped: the course's files are not here");
        return None;
    }
    Some(folder)
}

#[test]
fn light_on_a_scene_survives() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rad");
    let scene = plain("box");
    let light = light_on(&scene);
    let rad = RadFile::from_irradiance(&scene, &light);
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
fn course_files_are_written_again_byte_for_byte() {
    let Some(course) = course() else { return };
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
    let Some(course) = course() else { return };
    let text = fs::read_to_string(course.join("cornell-tessellated.obj")).unwrap();
    let coordinates = text.lines().filter_map(|line| line.strip_prefix("v "));
    let positions: Vec<Vec3> = coordinates
        .map(|line| {
            let numbers: Vec<f32> = line.split_whitespace().map(|n| n.parse().unwrap()).collect();
            Vec3::from_slice(&numbers)
        })
        .collect();
    assert_eq!((positions.len(), position_md5(&positions).as_str()), (31_440, COURSE_MD5));
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
