//! The loop of window events, which tells keys of the number pad from digits.

use crate::input::{Numpad, Pad};
use eframe::{AppCreator, EframeWinitApplication, NativeOptions, UserEvent};
use std::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, ElementState, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::WindowId;

/// Runs a program in a window until that is closed.
///
/// # Errors
/// When there is no window to be had.
pub fn run(
    name: &str,
    options: NativeOptions,
    create: AppCreator<'_>,
    numpad: Arc<Numpad>,
) -> Result<(), String> {
    let event_loop = EventLoop::<UserEvent>::with_user_event().build().map_err(|e| e.to_string())?;
    event_loop.set_control_flow(ControlFlow::Wait);
    let outcome = Rc::new(Cell::new(Outcome::NoDevice));
    let told = Rc::clone(&outcome);
    let create: AppCreator<'_> = Box::new(move |cc| {
        let app = create(cc);
        told.set(if app.is_ok() { Outcome::Shown } else { Outcome::NoProgram });
        app
    });
    let app = eframe::create_native(name, options, create, &event_loop);
    event_loop.run_app(&mut Forwarding { app, numpad }).map_err(|e| e.to_string())?;
    match outcome.get() {
        Outcome::Shown => Ok(()),
        Outcome::NoProgram => Err("the system gives no threads".to_owned()),
        Outcome::NoDevice => Err("no graphics device can show it; RUST_LOG=error says why".to_owned()),
    }
}

/// How far the start got: eframe keeps its errors to itself when it does not own the loop.
#[derive(Clone, Copy)]
enum Outcome {
    NoDevice,
    NoProgram,
    Shown,
}

/// Hands all events to eframe, and notes keys of the number pad on the way.
struct Forwarding<'a> {
    app: EframeWinitApplication<'a>,
    numpad: Arc<Numpad>,
}

impl ApplicationHandler<UserEvent> for Forwarding<'_> {
    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        if let WindowEvent::KeyboardInput { event: key, is_synthetic: false, .. } = &event
            && key.state == ElementState::Pressed
            && !key.repeat
            && let Some(pad) = pad_of(key.physical_key)
        {
            self.numpad.press(pad);
        }
        self.app.window_event(event_loop, window, event);
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        self.app.new_events(event_loop, cause);
    }

    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.app.resumed(event_loop);
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: UserEvent) {
        self.app.user_event(event_loop, event);
    }

    fn device_event(&mut self, event_loop: &ActiveEventLoop, device: DeviceId, event: DeviceEvent) {
        self.app.device_event(event_loop, device, event);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.app.about_to_wait(event_loop);
    }

    fn suspended(&mut self, event_loop: &ActiveEventLoop) {
        self.app.suspended(event_loop);
    }

    fn exiting(&mut self, event_loop: &ActiveEventLoop) {
        self.app.exiting(event_loop);
    }

    fn memory_warning(&mut self, event_loop: &ActiveEventLoop) {
        self.app.memory_warning(event_loop);
    }
}

/// The key of the number pad, if it is one that does something.
fn pad_of(key: PhysicalKey) -> Option<Pad> {
    let PhysicalKey::Code(code) = key else { return None };
    Some(match code {
        KeyCode::Numpad1 => Pad::Digit(1),
        KeyCode::Numpad3 => Pad::Digit(3),
        KeyCode::Numpad5 => Pad::Digit(5),
        KeyCode::Numpad7 => Pad::Digit(7),
        KeyCode::NumpadDecimal => Pad::Decimal,
        _ => return None,
    })
}
