//! Surfaces that are made two-sided, whatever their file says.

use lumel_scene::{MaterialId, SceneBuilder, Sides};

/// Makes the materials or objects of a name two-sided; all for "all" and "*". Whether there were any.
///
/// "none" leaves those one-sided of which the file does not say it.
/// Objects get two-sided copies of their materials, so that others that share these stay as they are.
pub(crate) fn make_two_sided(scene: &mut SceneBuilder, name: &str) -> bool {
    if name == "none" {
        let of_shape = scene.materials.iter_mut().filter(|material| material.sides == Sides::Shape);
        of_shape.for_each(|material| material.sides = Sides::Front);
        return true;
    }
    let all = name == "all" || name == "*";
    let mut found = false;
    for material in scene.materials.iter_mut().filter(|material| all || material.name == name) {
        material.sides = Sides::Both;
        found = true;
    }
    if all {
        return found;
    }
    let SceneBuilder { objects, materials, .. } = scene;
    let mut copies: Vec<Option<MaterialId>> = vec![None; materials.len()];
    for object in objects.iter_mut().filter(|object| object.name == name) {
        found = true;
        for face in &mut object.faces {
            let Some(copy) = copies.get_mut(face.material.index()) else { continue };
            face.material = *copy.get_or_insert_with(|| {
                let two_sided = materials[face.material.index()].clone().two_sided();
                materials.push(two_sided);
                MaterialId(materials.len() as u32 - 1)
            });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel_scene::{Material, ObjectMesh};

    fn scene() -> SceneBuilder {
        let mut scene = SceneBuilder::new("two");
        let paint = scene.add_material(Material::diffuse("paint", [0.5; 3]));
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for name in ["card", "wall"] {
            scene.add_mesh(name, corners, [[0, 1, 2]], paint);
        }
        scene
    }

    fn two_sided(name: &str) -> (bool, Vec<bool>) {
        let mut scene = scene();
        let found = make_two_sided(&mut scene, name);
        let sides =
            |object: &ObjectMesh| scene.materials[object.faces[0].material.index()].sides == Sides::Both;
        (found, scene.objects.iter().map(sides).collect())
    }

    #[test]
    fn names_are_those_of_materials_or_objects() {
        assert_eq!(two_sided("paint"), (true, vec![true, true]));
        assert_eq!(two_sided("card"), (true, vec![true, false]));
        assert_eq!(two_sided("all"), (true, vec![true, true]));
        assert_eq!(two_sided("*"), (true, vec![true, true]));
        assert_eq!(two_sided("glass"), (false, vec![false, false]));
    }
}
