use crate::damage::{flips, truncations};
use crate::scenes::{light_on, plain};
use crate::tools::numpy;
use glam::Vec3;
use lumel_basis::{Coefficients, Directional, Lighting, irradiance_at_vertices};
use lumel_export::{
    Array, ArrayData, NpzReader, Solution, SolutionError, SolutionLayer, SolutionMeta, SolutionPoints,
    SolutionSelection, write_npz,
};
use lumel_scene::{Barycentrics, Scene, SurfacePoint, TriId};
use serde_json::json;
use std::fs;
use std::path::Path;

fn solution(scene: &Scene) -> Solution {
    let irradiance = light_on(scene);
    let coefficients = |share: f32| {
        let of_vertex = |e: &Vec3| [0, 1, 2, 3].map(|k| (share - 0.5 * k as f32) * *e);
        Coefficients::new(Directional::Sh1, irradiance.iter().flat_map(of_vertex).collect())
    };
    let layer = |(name, share): (&str, f32)| SolutionLayer {
        name: name.to_owned(),
        irradiance: irradiance.iter().map(|e| share * *e).collect(),
        directional: coefficients(share),
    };
    let layers = [("window", 0.75), ("light 2", 0.25)].map(layer).to_vec();
    let half: Vec<Vec3> = irradiance.iter().map(|e| 0.5 * *e).collect();
    Solution {
        meta: SolutionMeta::new(scene, json!({ "rays": 64, "seed": 1 })),
        positions: scene.world_positions().collect(),
        normals: scene.normals().to_vec(),
        bounces: vec![half.clone(), half.iter().map(|e| 0.5 * *e).collect()],
        tail: Some(half.iter().map(|e| 0.5 * *e).collect()),
        valid: (0..irradiance.len()).map(|v| v != 2).collect(),
        standard_error: Some(irradiance.iter().map(|e| 0.01 * *e).collect()),
        layers,
        directional: coefficients(1.0),
        occlusion: Some((0..irradiance.len()).map(|v| 0.01 * v as f32).collect()),
        splits: vec![[0, 1], [1, 7]],
        points: Some(points()),
        irradiance,
    }
}

/// Three points that carried light.
fn points() -> SolutionPoints {
    let values = |scale: f32| [1.0, 2.0, 3.0].map(|x| Vec3::new(x, 0.1, 0.0) * scale).to_vec();
    SolutionPoints {
        positions: values(1e5).iter().map(|p| p.as_dvec3() + 0.125).collect(),
        normals: vec![Vec3::Y; 3],
        radii: vec![0.5, 0.5, 0.25],
        levels: vec![0, 0, 1],
        valid: vec![true, false, true],
        bounces: vec![values(2.0), values(0.5)],
        tail: Some(values(0.1)),
    }
}

/// What is read back: saving fills in the meaning of the arrays.
fn saved_and_loaded(solution: &Solution, path: &Path) -> Solution {
    solution.save(path).unwrap();
    let mut loaded = Solution::load(path).unwrap();
    assert!(loaded.meta.arrays.contains_key("irradiance"));
    loaded.meta.arrays.clear();
    loaded
}

#[test]
fn a_solution_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let mut solution = solution(&plain("box"));
    solution.irradiance[0] = Vec3::new(-0.0, f32::MIN_POSITIVE / 2.0, 1.0 / 3.0);
    let loaded = saved_and_loaded(&solution, &path);
    assert_eq!(loaded, solution);
    assert_eq!(loaded.irradiance[0].x.to_bits(), (-0.0_f32).to_bits());
    solution.bounces.clear();
    (solution.tail, solution.standard_error) = (None, None);
    solution.layers.clear();
    solution.directional = None;
    solution.points = None;
    solution.meta.complete = false;
    solution.meta.statistics = json!({ "seconds": 1.5 });
    assert_eq!(saved_and_loaded(&solution, &path), solution);
}

#[test]
fn equal_solutions_are_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a.npz"), folder.path().join("b.npz"));
    solution(&plain("box")).save(&a).unwrap();
    Solution::load(&a).unwrap().save(&b).unwrap();
    assert_eq!(fs::read(a).unwrap(), fs::read(b).unwrap());
}

#[test]
fn points_that_do_not_belong_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let with = |points| Solution { points: Some(points), ..solution(&plain("box")) };
    let error = |points| with(points).save(&path).unwrap_err().to_string();
    let short = error(SolutionPoints { levels: vec![0], ..points() });
    assert!(short.contains("point_level") && short.contains('1') && short.contains('3'), "{short}");
    let nan = error(SolutionPoints { radii: vec![f32::NAN; 3], ..points() });
    assert!(nan.contains("point_radius"), "{nan}");
    let one_bounce = SolutionPoints { bounces: vec![vec![Vec3::ONE; 2]], ..points() };
    assert!(error(one_bounce).contains("point_bounces"));
    with(points()).save(&path).unwrap();
    let loaded = Solution::load(&path).unwrap();
    let arrays = ["points", "point_normals", "point_radius", "point_level", "point_valid", "point_bounces"];
    assert!(arrays.iter().all(|array| loaded.meta.arrays.contains_key(*array)));
}

#[test]
fn parts_are_selected_by_bounce_or_by_layer() {
    let solution = solution(&plain("box"));
    assert_eq!(solution.select(&SolutionSelection::Sum).unwrap(), solution.sum());
    assert_eq!(solution.select(&SolutionSelection::Bounce(1)).unwrap(), solution.bounces[1]);
    let error = solution.select(&SolutionSelection::Bounce(2)).unwrap_err().to_string();
    assert_eq!(error, "the solution has no bounce 2; it has 2 bounces, counted from 0 (direct light)");
    let layer = |name: &str| SolutionSelection::Layer(name.to_owned());
    assert_eq!(solution.select(&layer("light 2")).unwrap(), solution.layers[1].irradiance);
    let error = solution.select(&layer("lamp")).unwrap_err().to_string();
    assert_eq!(error, "the solution has no layer \"lamp\"; its layers are window, light 2");
}

#[test]
fn a_file_with_other_names_than_layers_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let good = solution(&plain("box"));
    write_npz(&path, |npz| {
        let meta = SolutionMeta { layers: vec!["only one".to_owned()], ..good.meta.clone() };
        npz.bytes("meta.json", &serde_json::to_vec(&meta).unwrap())?;
        for name in ["positions", "normals", "irradiance"] {
            npz.array(name, &Array::from_positions(&good.positions))?;
        }
        npz.array("bounces", &Array { shape: vec![0, 4, 3], data: ArrayData::F32(vec![]) })?;
        npz.array("layers", &Array { shape: vec![2, 4, 3], data: ArrayData::F32(vec![0.0; 24]) })
    })
    .unwrap();
    let error = Solution::load(&path).unwrap_err().to_string();
    assert!(error.contains("\"layers\" has 2 layers, but meta.json names 1"), "{error}");
}

#[test]
fn a_solution_of_another_scene_is_refused_with_both_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.npz");
    let (ours, theirs) = (plain("cornell-box"), crate::scenes::colourful());
    let solution = solution(&theirs);
    solution.check_belongs_to(&theirs).unwrap();
    let error = solution.check_belongs_to(&ours).unwrap_err().to_string();
    let hash = |scene: &Scene| scene.hash().geometry.to_hex()[..8].to_string();
    let expected = format!(
        "the solution was computed for scene \"{}\" ({} vertices, {}..), not for \"cornell-box\" \
         (4 vertices, {}..): bake this scene again or open the scene it belongs to",
        theirs.name(),
        theirs.vertex_count(),
        hash(&theirs),
        hash(&ours)
    );
    assert_eq!(error, expected);
    solution.save(&path).unwrap();
    Solution::load_for(&path, &theirs).unwrap();
    let error = Solution::load_for(&path, &ours).unwrap_err().to_string();
    assert!(error.starts_with("solution \"") && error.contains("x.npz\" was computed for scene"), "{error}");
}

#[test]
fn as_many_vertices_are_not_enough_to_belong_to_a_scene() {
    let scene = plain("box");
    let mut solution = solution(&scene);
    solution.meta.geometry_hash = "0".repeat(64);
    let error = solution.check_belongs_to(&scene).unwrap_err().to_string();
    assert!(
        error.contains("scene \"box\" (4 vertices, 00000000..), not for \"box\" (4 vertices, "),
        "{error}"
    );
}

#[test]
fn the_sum_and_each_bounce_are_lighting_on_the_scene_of_a_solution() {
    let scene = plain("box");
    let solution = solution(&scene);
    let middle = SurfacePoint { tri: TriId(1), bary: Barycentrics { u: 0.25, v: 0.5 } };
    for (selection, values) in
        [(SolutionSelection::Sum, &solution.irradiance), (SolutionSelection::Bounce(1), &solution.bounces[1])]
    {
        let lighting = solution.lighting(&scene, &selection).unwrap();
        assert_eq!(*irradiance_at_vertices(&scene, &lighting).unwrap(), **values);
        let [a, b, c] = scene.triangle(middle.tri).map(|v| values[v as usize]);
        assert_eq!(lighting.irradiance(middle, Vec3::Y).0, a * 0.25 + b * 0.5 + c * 0.25);
    }
    let error = solution.lighting(&scene, &SolutionSelection::Bounce(2)).unwrap_err();
    assert!(matches!(error, SolutionError::NoSuchBounce { wanted: 2, count: 2 }));
    let other = crate::scenes::colourful();
    let error = solution.lighting(&other, &SolutionSelection::Sum).unwrap_err();
    assert!(matches!(error, SolutionError::OtherScene { .. }));
}

#[test]
fn other_materials_keep_the_geometry_but_not_the_lighting() {
    let (scene, same) = (plain("box"), plain("a copy by another name"));
    let solution = solution(&scene);
    assert!(solution.has_lighting_of(&same));
    solution.check_belongs_to(&same).unwrap();
    let other = crate::scenes::colourful();
    assert!(!solution.has_lighting_of(&other));
}

#[test]
fn arrays_that_disagree_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let good = solution(&plain("box"));
    let refused = |change: fn(&mut Solution)| {
        let mut bad = good.clone();
        change(&mut bad);
        bad.save(&path).unwrap_err().to_string()
    };
    let message = refused(|s| s.bounces[1].truncate(3));
    assert_eq!(message, "the solution has 3 values of \"bounces[1]\" for 4 vertices");
    assert!(refused(|s| s.valid.push(true)).contains("5 values of \"valid\""));
    assert!(refused(|s| s.tail = Some(vec![])).contains("0 values of \"tail\""));
    assert!(refused(|s| s.standard_error = Some(vec![])).contains("0 values of \"standard_error\""));
    assert!(refused(|s| s.layers[0].irradiance.truncate(3)).contains("3 values of \"layers[window]\""));
    let message = refused(|s| s.irradiance[2].y = f32::NAN);
    assert_eq!(message, "the solution is not a finite number in \"irradiance\" at vertex 2");
    assert!(!path.exists());
}

#[test]
fn other_archives_and_newer_formats_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let refused = |meta: Option<&str>| {
        write_npz(&path, |npz| {
            meta.map_or(Ok(()), |meta| npz.bytes("meta.json", meta.as_bytes()))?;
            npz.array("irradiance", &Array::list(ArrayData::F32(vec![1.0])))
        })
        .unwrap();
        let error = Solution::load(&path).unwrap_err();
        assert!(matches!(error, SolutionError::Format { .. }), "{error}");
        error.to_string()
    };
    assert!(refused(None).starts_with("this archive is not a lumel solution: it has no meta.json"));
    assert!(refused(Some("{")).starts_with("this archive is not a lumel solution"));
    assert!(refused(Some("[[[[")).starts_with("this archive is not a lumel solution"));
    let other = r#"{ "format": "lumel-checkpoint", "format_version": 1 }"#;
    assert!(refused(Some(other)).starts_with("this archive holds a \"lumel-checkpoint\""));
    let newer = r#"{ "format": "lumel-solution", "format_version": 9 }"#;
    assert!(
        refused(Some(newer)).starts_with("this solution has format 9, this version of lumel reads format 1")
    );
    let short = r#"{ "format": "lumel-solution", "format_version": 1 }"#;
    assert!(refused(Some(short)).contains("is incomplete: missing field"));
}

#[test]
fn arrays_of_a_wrong_shape_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (path, bad) = (folder.path().join("a.npz"), folder.path().join("b.npz"));
    solution(&plain("box")).save(&path).unwrap();
    let wrong: [(&str, Array); 12] = [
        ("irradiance", Array { shape: vec![3, 4], data: ArrayData::F32(vec![0.0; 12]) }),
        ("positions", Array { shape: vec![4, 3], data: ArrayData::U32(vec![0; 12]) }),
        ("bounces", Array { shape: vec![4, 3], data: ArrayData::F32(vec![0.0; 12]) }),
        ("bounces", Array { shape: vec![1_000_000_000_000, 0, 3], data: ArrayData::F32(vec![]) }),
        ("layers", Array { shape: vec![2, 3, 4], data: ArrayData::F32(vec![0.0; 24]) }),
        ("sh", Array { shape: vec![4, 5, 3], data: ArrayData::F32(vec![0.0; 60]) }),
        ("layers_sh", Array { shape: vec![4, 4, 3], data: ArrayData::F32(vec![0.0; 48]) }),
        ("splits", Array { shape: vec![4], data: ArrayData::U32(vec![0; 4]) }),
        ("points", Array { shape: vec![9], data: ArrayData::F32(vec![0.0; 9]) }),
        ("point_bounces", Array { shape: vec![2, 4, 3], data: ArrayData::F32(vec![0.0; 24]) }),
        ("point_level", Array { shape: vec![3], data: ArrayData::F32(vec![0.0; 3]) }),
        ("valid", Array { shape: vec![4, 1], data: ArrayData::Bool(vec![true; 4]) }),
    ];
    for (name, array) in wrong {
        let mut npz = NpzReader::open(&path).unwrap();
        write_npz(&bad, |out| {
            out.bytes("meta.json", &npz.bytes("meta.json").unwrap())?;
            for other in [
                "positions",
                "normals",
                "irradiance",
                "bounces",
                "tail",
                "standard_error",
                "layers",
                "sh",
                "layers_sh",
                "occlusion",
                "splits",
                "points",
                "point_normals",
                "point_radius",
                "point_level",
                "point_valid",
                "point_bounces",
                "point_tail",
                "valid",
            ] {
                let old = npz.array(other).unwrap();
                out.array(other, if other == name { &array } else { &old })?;
            }
            Ok(())
        })
        .unwrap();
        let error = Solution::load(&bad).unwrap_err().to_string();
        assert!(error.starts_with(&format!("\"{name}\" has the shape")), "{error}");
    }
}

#[test]
fn damaged_solutions_are_errors_or_load_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    solution(&plain("box")).save(&path).unwrap();
    let good = fs::read(&path).unwrap();
    let expected = Solution::load(&path).unwrap();
    for cut in truncations(&good) {
        fs::write(&path, cut).unwrap();
        assert!(Solution::load(&path).is_err(), "{} bytes are a whole file", cut.len());
    }
    for damaged in flips(&good) {
        fs::write(&path, &damaged).unwrap();
        if let Ok(loaded) = Solution::load(&path) {
            assert_eq!(loaded, expected);
        }
    }
}

#[test]
fn numpy_reads_a_solution_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    solution(&plain("box")).save(&path).unwrap();
    let script = r#"
import json
f = np.load(path)
assert np.load(path)["irradiance"].shape == (4, 3)
assert f["bounces"].shape == (2, 4, 3) and f["tail"].shape == (4, 3)
assert np.array_equal(f["irradiance"], f["bounces"].sum(axis=0) + f["tail"] + 0.0 * f["normals"])
assert f["irradiance"][f["valid"]].shape == (3, 3)
meta = json.loads(f["meta.json"])
window = f["layers"][meta["layers"].index("window")]
assert np.array_equal(window, 0.75 * f["irradiance"])
assert meta["format"] == "lumel-solution" and meta["settings"]["rays"] == 64
assert set(meta["arrays"]) == set(f.files) - {"meta.json"}
"#;
    numpy(script, &path);
}
