//! What lights are called.

/// A name for each of so many lights: the given one, or "light 1", "light 2" and so on by its place where that is
/// missing or empty.
pub(crate) fn complete(mut given: Vec<String>, lights: usize) -> Vec<String> {
    given.resize(lights, String::new());
    for (place, name) in (1..).zip(&mut given) {
        if name.is_empty() {
            *name = format!("light {place}");
        }
    }
    given
}

#[cfg(test)]
mod tests {
    use crate::testing::quad;
    use crate::{Light, Material, PointLight, SceneBuilder};
    use glam::Vec3;

    #[test]
    fn lights_without_a_name_are_called_by_their_place_and_relit_ones_keep_their_names() {
        let point = PointLight { position: Vec3::Z, intensity: Vec3::ONE, range: f32::INFINITY };
        let light = Light::Point(point);
        let mut builder = SceneBuilder {
            objects: vec![quad("floor")],
            materials: vec![Material::default()],
            lights: vec![light],
            ..SceneBuilder::default()
        };
        builder.add_named_light("lamp", light);
        builder.add_named_light("", light);
        let scene = builder.clone().build().unwrap().0;
        assert_eq!(scene.light_names(), ["light 1", "lamp", "light 3"]);
        let dimmer = Light::Point(PointLight { intensity: Vec3::splat(0.5), ..point });
        assert_eq!(scene.relit(vec![dimmer; 3]).unwrap().light_names(), scene.light_names());
        assert_eq!(scene.relit(vec![dimmer; 2]).unwrap().light_names(), ["light 1", "light 2"]);
        let renamed = scene.clone().with_light_names(vec!["sun".into()]);
        assert_eq!(renamed.light_names(), ["sun", "light 2", "light 3"]);
        assert_eq!(renamed.hash(), scene.hash(), "a name is no light");
        builder.clear_lights();
        assert!(builder.build().unwrap().0.light_names().is_empty());
    }
}
