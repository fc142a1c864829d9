//! The picture in the window and what lies over it: flying, picking, the divider, the handles, the legend.

mod axes;
mod banner;
mod flight;
mod ground;
mod hand;
mod inspector;
mod legend;
mod marks;
mod orbit;
mod overlay;
mod ripple;
mod start;
mod state;

pub(crate) use orbit::{focus, frame, toggle_parallel, view_from};
pub use state::{Subject, Viewport};

use crate::notice::Level;
use crate::stage::Showing;
use crate::theme;
use eframe::egui::{self, FontId, Rect, Sense, Ui, vec2};
use state::SETTLE;
use std::time::Instant;

impl Viewport {
    /// Shows the picture and takes what is done to it.
    pub fn show(&mut self, subject: &mut Subject<'_>, ui: &mut Ui) {
        let size = ui.available_size().max(vec2(16.0, 16.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, "Scene"));
        (self.id, self.area) = (Some(response.id), Some(rect));
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        let before = subject.session.camera;
        let taken = hand::divide(self, subject, ui, &response) || hand::handles(self, subject, ui, &response);
        if !taken {
            hand::drag(self, subject, ui, &response);
            hand::click(subject, &response);
        }
        hand::wheel(self, subject, ui, &response);
        flight::fly(self, subject, ui, &response);
        if subject.session.camera != before {
            self.moved = Some(Instant::now());
        }
        if self.is_moving() {
            // One more picture, as good as it gets, when all is still.
            ui.ctx().request_repaint_after(SETTLE);
        }
        self.picture(subject, ui, rect);
        overlay::show(self, subject, ui, rect);
    }

    fn picture(&mut self, subject: &mut Subject<'_>, ui: &mut Ui, rect: Rect) {
        let scale = ui.ctx().pixels_per_point();
        let pixels = [rect.width(), rect.height()].map(|x| (x * scale).round().max(1.0) as u32);
        let ripple = ripple::waves(self, subject, ui);
        let quality = self.quality(subject.session);
        let showing = Showing {
            session: &*subject.session,
            view: &subject.prefs.view,
            split: subject.comparison.split(),
            marks: self.marks.update(subject.session, &subject.prefs.view, subject.pick.as_ref()),
            quality,
            ripple,
        };
        let Some(stage) = &mut subject.stage else {
            let text = "No graphics device.\nInstall a Vulkan driver; on Debian: mesa-vulkan-drivers";
            return message(ui, rect, text);
        };
        match stage.show(&showing, pixels) {
            Ok(Some(shown)) => {
                ui.painter().add(shown.shape(rect));
                self.problem = None;
            }
            Ok(None) if subject.session.is_opening() => message(ui, rect, "Opening..."),
            Ok(None) => start::show(subject, ui, rect),
            Err(error) => {
                let text = crate::document::error_text(&error);
                message(ui, rect, &format!("This scene cannot be shown:\n{text}"));
                if self.problem.as_ref() != Some(&text) {
                    subject.session.notices.push(Level::Error, format!("Cannot show the scene: {text}"));
                    self.problem = Some(text);
                }
            }
        }
    }
}

fn message(ui: &Ui, rect: Rect, text: &str) {
    ui.painter().rect_filled(rect, 0.0, theme::DEEP);
    let mut job = egui::text::LayoutJob::simple(
        text.to_owned(),
        FontId::proportional(15.0),
        theme::WEAK,
        (rect.width() - 40.0).max(40.0),
    );
    job.halign = egui::Align::Center;
    let galley = ui.painter().layout_job(job);
    let top = rect.center() - vec2(0.0, 0.5 * galley.size().y);
    ui.painter().galley(top, galley, theme::WEAK);
}
