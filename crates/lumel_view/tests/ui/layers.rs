//! Dimming the layers of a solve.

use crate::harness::Window;
use eframe::egui::accesskit::Role;
use lumel::Layers;
use lumel_view::selection::Selection;

#[test]
fn layers_are_dimmed_without_a_solve_and_saved_as_solved() {
    let Some(mut window) = Window::room() else { return };
    window.tab("Lights");
    window.click("Add");
    window.session().settings.layers = Layers::Lights;
    window.solve();
    let light = window.session().light.clone();
    let n = light.bounces[0].len();
    let names: Vec<&str> = light.layers.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(names, ["Lamp", "Light 1"]);
    let whole = light.select(Selection::All, n);
    let lit = window.picture();
    window.find(Role::Slider, "Lamp").set_value_accesskit(0.0);
    window.run_steps(2);
    assert!(!window.session().is_solving());
    let dimmed = window.session().light.select(Selection::All, n);
    assert_eq!(dimmed, *light.layers[1].values);
    assert!(window.picture() != lit, "the picture follows");
    let solution = window.session().solution().unwrap();
    assert_eq!((solution.irradiance == whole, solution.layers.len()), (true, 2));
    window.click("Reset layers");
    window.run_steps(2);
    assert_eq!(window.session().light.select(Selection::All, n), whole);
    assert!(!window.has(Role::Button, "Reset layers"));
}
