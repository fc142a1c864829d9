//! The window as a whole, pixel by pixel. `UPDATE_SNAPSHOTS=1` makes new ones after a change that is meant.

use crate::harness::{Setup, Window, folder};
use eframe::egui::Key;
use lumel::BounceLimit;
use lumel_view::document::OpenRequest;

#[test]
fn the_window_looks_as_it_did() {
    let small = |setup: &mut Setup| {
        setup.size = [1000.0, 640.0];
        setup.start.open = Some(OpenRequest::new("cornell-box"));
    };
    let Some(mut window) = Window::start(folder(), small) else { return };
    let renderer = window.state().stage.as_ref().unwrap().gpu().name();
    if !renderer.starts_with("llvmpipe") {
        println!("skipped: the picture was drawn by llvmpipe, and {renderer} rounds differently");
        return;
    }
    let settings = &mut window.session().settings;
    (settings.direct_samples, settings.indirect_samples) = (4, 16);
    settings.bounces = BounceLimit::Count(2);
    window.solve();
    // The line at the bottom tells how long a solve took, but not of one from a file.
    let file = window.file("cornell.npz");
    for key in [Key::K, Key::L] {
        window.press(key);
        window.answer(&file);
        window.wait_for_files();
    }
    window.dismiss_messages();
    window.settle();
    window.snapshot("window");
}
