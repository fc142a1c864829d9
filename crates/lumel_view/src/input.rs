//! Every key and what it does: the one table that handles them, explains them and fills the menus.

use crate::camera::ViewSide;
use crate::prefs::ViewMode;
use eframe::egui::{self, Key, Modifiers};
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Something that can be done by a key, from a menu or by a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// Ask for a scene to open.
    Open,
    /// Reload the scene.
    Reload,
    /// Ask where to save the lit mesh.
    SaveMesh,
    /// Save the project, asking where if there is none.
    SaveProject,
    /// Ask where to save the project.
    SaveProjectAs,
    /// Ask for a solution to load.
    LoadSolution,
    /// Ask for a solution to compare with.
    CompareSolution,
    /// Ask for an image of the sky.
    LoadSky,
    /// Ask where to save the solution.
    SaveSolution,
    /// Ask where to save the lightmap.
    SaveLightmap,
    /// Save a screenshot.
    Screenshot,
    /// Close the window.
    Quit,
    /// Take back the last change.
    Undo,
    /// Make it again.
    Redo,
    /// Put the active light where the camera is.
    PlaceLight,
    /// Add a light at the camera.
    AddLight,
    /// Remove the active light.
    RemoveLight,
    /// Hide or show the active light.
    ToggleLight,
    /// Make the next light the active one.
    NextLight,
    /// Turn the active light towards the picked spot, or what is in the middle of the picture.
    AimLight,
    /// Move until the picked object, or everything, fits the picture.
    Frame,
    /// Look from a side.
    View(ViewSide),
    /// Switch between a perspective and a nearly parallel projection.
    Parallel,
    /// Level the horizon.
    AlignUp,
    /// Go back to where the scene was opened.
    ResetCamera,
    /// Start the solve.
    Solve,
    /// Solve from scratch.
    SolveAnew,
    /// Stop the solve; close what is open above the picture.
    Stop,
    /// Switch between the random and the Sobol sampler.
    ToggleQmc,
    /// Show all light.
    ShowAll,
    /// Show direct light.
    ShowDirect,
    /// Show indirect light.
    ShowIndirect,
    /// Show the previous bounce.
    PreviousBounce,
    /// Show the bounce after.
    NextBounce,
    /// Draw the edges of triangles.
    Wireframe,
    /// Draw the borders of lumels.
    LumelGrid,
    /// Show one way of looking at the scene, or the usual one if it is shown already.
    Show(ViewMode),
    /// Mark where the most light is still to be reflected.
    Shooters,
    /// Add what is still to come on average.
    Ambient,
    /// Show normal maps and ripples, or not.
    Relief,
    /// Show the same light with and without them side by side.
    SplitRelief,
    /// Keep the light to compare with.
    KeepLight,
    /// Show two lights side by side.
    Split,
    /// Show all keys.
    Help,
    /// Hide or show the panels.
    Panels,
    /// Full screen, or not.
    FullScreen,
    /// Save camera, lights and settings under a digit.
    SaveSlot(u8),
    /// Recall them.
    RecallSlot(u8),
}

/// How the camera moves while a key is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Along the line of sight.
    Forward,
    /// Against it.
    Back,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Up in the world.
    Up,
    /// Down in the world.
    Down,
    /// Roll against the clock.
    RollLeft,
    /// Roll with the clock.
    RollRight,
    /// Look to the left.
    LookLeft,
    /// Look to the right.
    LookRight,
    /// Look up.
    LookUp,
    /// Look down.
    LookDown,
}

/// What a line of the help belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Scenes, solutions and pictures.
    Files,
    /// Flying.
    Camera,
    /// Lights.
    Lights,
    /// Solving.
    Solve,
    /// What is seen.
    View,
}

impl Group {
    /// All groups, in the order of the help.
    pub const ALL: [Self; 5] = [Self::Files, Self::Camera, Self::Lights, Self::Solve, Self::View];

    /// The heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Files => "Files",
            Self::Camera => "Camera",
            Self::Lights => "Lights",
            Self::Solve => "Solve",
            Self::View => "View",
        }
    }
}

/// A key that does something once.
pub struct Binding {
    /// What it does.
    pub command: Command,
    /// With these held.
    pub modifiers: Modifiers,
    /// The key.
    pub key: Key,
    /// What it does, in words.
    pub text: &'static str,
    /// Where it is in the help.
    pub group: Group,
}

const fn bind(command: Command, key: Key, text: &'static str, group: Group) -> Binding {
    Binding { command, modifiers: Modifiers::NONE, key, text, group }
}

const fn with(modifiers: Modifiers, binding: Binding) -> Binding {
    Binding { modifiers, ..binding }
}

/// Keys that do something once. Digits are handled apart: see [`command_of`].
pub const BINDINGS: &[Binding] = &[
    bind(Command::Open, Key::M, "Open a mesh, project or built-in scene", Group::Files),
    with(
        Modifiers::COMMAND,
        bind(Command::Open, Key::O, "Open a mesh, project or built-in scene", Group::Files),
    ),
    bind(Command::Reload, Key::F5, "Reload the scene", Group::Files),
    bind(Command::SaveMesh, Key::O, "Save the lit mesh (OBJ, GLB, PLY)", Group::Files),
    with(Modifiers::COMMAND, bind(Command::SaveProject, Key::S, "Save the project", Group::Files)),
    with(
        Modifiers::COMMAND.plus(Modifiers::SHIFT),
        bind(Command::SaveProjectAs, Key::S, "Save the project as", Group::Files),
    ),
    bind(Command::LoadSolution, Key::L, "Load a solution", Group::Files),
    bind(Command::SaveSolution, Key::K, "Save the solution", Group::Files),
    with(
        Modifiers::SHIFT,
        bind(Command::SaveLightmap, Key::K, "Save the lightmap (EXR, GLB, PNG)", Group::Files),
    ),
    bind(Command::Screenshot, Key::F12, "Save a screenshot", Group::Files),
    with(Modifiers::COMMAND, bind(Command::Quit, Key::Q, "Quit; unsaved work is kept", Group::Files)),
    bind(Command::AlignUp, Key::U, "Level the horizon", Group::Camera),
    bind(Command::ResetCamera, Key::Home, "Reset the camera", Group::Camera),
    bind(Command::PlaceLight, Key::Space, "Move the light to the camera", Group::Lights),
    bind(Command::AddLight, Key::Insert, "Add a light at the camera", Group::Lights),
    bind(Command::RemoveLight, Key::Delete, "Remove the light", Group::Lights),
    bind(Command::ToggleLight, Key::H, "Hide or show the light", Group::Lights),
    bind(Command::NextLight, Key::N, "Select the next light", Group::Lights),
    with(
        Modifiers::SHIFT,
        bind(Command::AimLight, Key::T, "Aim the light at the picked spot", Group::Lights),
    ),
    with(
        Modifiers::COMMAND,
        bind(Command::Undo, Key::Z, "Undo a change to lights, materials or slots", Group::Lights),
    ),
    with(Modifiers::COMMAND.plus(Modifiers::SHIFT), bind(Command::Redo, Key::Z, "Redo", Group::Lights)),
    with(Modifiers::COMMAND, bind(Command::Redo, Key::Y, "Redo", Group::Lights)),
    bind(Command::Solve, Key::Enter, "Start or resume the solve", Group::Solve),
    with(Modifiers::SHIFT, bind(Command::SolveAnew, Key::Enter, "Solve from scratch", Group::Solve)),
    bind(Command::Stop, Key::Escape, "Stop the solve; close a dialog", Group::Solve),
    bind(Command::ToggleQmc, Key::F2, "Switch between Sobol and random samples", Group::Solve),
    bind(Command::ShowAll, Key::B, "Show all light", Group::View),
    bind(Command::ShowDirect, Key::G, "Show direct light", Group::View),
    bind(Command::ShowIndirect, Key::J, "Show indirect light", Group::View),
    bind(Command::PreviousBounce, Key::Comma, "Show the previous bounce", Group::View),
    bind(Command::NextBounce, Key::Period, "Show the next bounce", Group::View),
    bind(Command::Wireframe, Key::X, "Wireframe", Group::View),
    bind(Command::LumelGrid, Key::T, "Lumel grid", Group::View),
    bind(Command::Show(ViewMode::Charts), Key::V, "Show the charts of the lightmap", Group::View),
    bind(Command::Show(ViewMode::Chequerboard), Key::I, "Show lumels as a chequerboard", Group::View),
    bind(Command::Show(ViewMode::LumelDensity), Key::Y, "Show the density of lumels", Group::View),
    bind(Command::Show(ViewMode::Validity), Key::F3, "Show what lies inside geometry", Group::View),
    bind(Command::Show(ViewMode::Seams), Key::F4, "Show the seams of the lightmap", Group::View),
    bind(Command::Show(ViewMode::Unshot), Key::F6, "Show what is still to be reflected", Group::View),
    bind(Command::Shooters, Key::F7, "Mark the brightest shooters", Group::View),
    bind(Command::Ambient, Key::F8, "Ambient term while a solve is not finished", Group::View),
    bind(Command::Relief, Key::Z, "Light normal maps by direction, or not", Group::View),
    with(
        Modifiers::SHIFT,
        bind(Command::SplitRelief, Key::Z, "Compare with and without normal maps", Group::View),
    ),
    bind(Command::KeepLight, Key::P, "Keep this solution for comparison", Group::View),
    bind(Command::Split, Key::C, "Compare side by side", Group::View),
    bind(Command::Help, Key::F1, "Show all keys", Group::View),
    bind(Command::Panels, Key::F10, "Hide or show the panels", Group::View),
    bind(Command::FullScreen, Key::F11, "Full screen", Group::View),
];

/// Keys that move the camera while they are held.
pub const MOTIONS: &[(Motion, Key, &str)] = &[
    (Motion::Forward, Key::W, "Fly forward"),
    (Motion::Left, Key::A, "Fly left"),
    (Motion::Back, Key::S, "Fly backward"),
    (Motion::Right, Key::D, "Fly right"),
    (Motion::Up, Key::R, "Fly up"),
    (Motion::Down, Key::F, "Fly down"),
    (Motion::RollLeft, Key::Q, "Roll left"),
    (Motion::RollRight, Key::E, "Roll right"),
    (Motion::LookLeft, Key::ArrowLeft, "Look left"),
    (Motion::LookRight, Key::ArrowRight, "Look right"),
    (Motion::LookUp, Key::ArrowUp, "Look up"),
    (Motion::LookDown, Key::ArrowDown, "Look down"),
];

/// What mouse and modifiers do; the viewport handles them.
pub const MOUSE: &[(&str, &str, Group)] = &[
    ("Left drag", "Look around", Group::Camera),
    ("Middle drag, Alt + left", "Orbit around the picked spot", Group::Camera),
    ("Shift + middle drag", "Pan", Group::Camera),
    ("Right, Ctrl + middle drag", "Dolly", Group::Camera),
    ("Wheel", "Fly faster or slower", Group::Camera),
    ("Ctrl + wheel", "Move nearer or away", Group::Camera),
    ("F tapped", "Frame the picked object, or all", Group::Camera),
    ("Shift, Ctrl", "Hold to fly faster, slower", Group::Camera),
    ("Alt + digit", "Save camera, lights and settings", Group::Camera),
    ("Digit", "Recall camera, lights and settings", Group::Camera),
    ("Click", "Inspect the light on a surface", Group::View),
    ("Drag a handle", "Move, turn or resize the active light", Group::Lights),
    ("Ctrl + drag a handle", "Snap to a grid, to 15°, to surfaces", Group::Lights),
];

/// The key that flies when it is held and frames when it is tapped.
pub const FRAME_KEY: Key = Key::F;

/// A key of the number pad, which the window system tells from the digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pad {
    /// A digit.
    Digit(u8),
    /// The decimal point.
    Decimal,
}

impl Pad {
    /// Whether this key of the pad may have caused a key event, whatever the lock of the pad makes of it.
    fn may_be(self, key: Key, physical: Option<Key>) -> bool {
        match self {
            Self::Digit(digit) => [Some(key), physical].contains(&Some(DIGITS[usize::from(digit)])),
            Self::Decimal => matches!(key, Key::Period | Key::Comma | Key::Delete),
        }
    }
}

/// What keys of the number pad do: alone, with Ctrl the opposite.
pub const NUMPAD: &[(Pad, bool, Command, &str)] = &[
    (Pad::Digit(1), false, Command::View(ViewSide::Front), "View from the front"),
    (Pad::Digit(1), true, Command::View(ViewSide::Back), "View from the back"),
    (Pad::Digit(3), false, Command::View(ViewSide::Right), "View from the right"),
    (Pad::Digit(3), true, Command::View(ViewSide::Left), "View from the left"),
    (Pad::Digit(7), false, Command::View(ViewSide::Top), "View from the top"),
    (Pad::Digit(7), true, Command::View(ViewSide::Bottom), "View from below"),
    (Pad::Digit(5), false, Command::Parallel, "Nearly parallel projection, or perspective"),
    (Pad::Decimal, false, Command::Frame, "Frame the picked object, or all"),
];

fn pad_keys(pad: Pad, ctrl: bool) -> String {
    let key = match pad {
        Pad::Digit(digit) => digit.to_string(),
        Pad::Decimal => ".".to_owned(),
    };
    format!("{}Numpad {key}", if ctrl { "Ctrl+" } else { "" })
}

/// Presses of keys on the number pad that have not been handled: egui takes them for digits.
#[derive(Debug, Default)]
pub struct Numpad(Mutex<VecDeque<Pad>>);

impl Numpad {
    /// Notes that a key was pressed; its event comes next.
    pub fn press(&self, pad: Pad) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push_back(pad);
    }

    /// Takes the key that a key event came from, if that was one of the pad.
    fn take(&self, key: Key, physical: Option<Key>) -> Option<Pad> {
        let mut presses = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let pad = *presses.front().filter(|pad| pad.may_be(key, physical))?;
        presses.pop_front();
        Some(pad)
    }
}

fn pad_command(pad: Pad, modifiers: Modifiers) -> Option<Command> {
    let ctrl = modifiers.ctrl || modifiers.command;
    NUMPAD.iter().find(|(key, with, ..)| *key == pad && *with == ctrl).map(|(_, _, command, _)| *command)
}

const DIGITS: [Key; 10] = [
    Key::Num0,
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

/// What a key pressed with these modifiers does.
///
/// Pass the modifiers of the key event: on a slow frame, Alt may already be up when the frame ends.
pub fn command_of(key: Key, modifiers: Modifiers) -> Option<Command> {
    if let Some(digit) = DIGITS.iter().position(|digit| *digit == key) {
        let digit = digit as u8;
        let plain = !(modifiers.ctrl || modifiers.command || modifiers.mac_cmd);
        return plain.then_some(if modifiers.alt {
            Command::SaveSlot(digit)
        } else {
            Command::RecallSlot(digit)
        });
    }
    let fits = |binding: &&Binding| {
        let wanted = binding.modifiers;
        let command = modifiers.command || modifiers.ctrl;
        binding.key == key
            && wanted.command == command
            && !modifiers.alt
            // Shift flies fast, so it only matters where it changes what a key does.
            && (wanted.shift == modifiers.shift || (!modifiers.shift_matters(key) && !wanted.shift))
    };
    BINDINGS.iter().find(fits).map(|binding| binding.command)
}

trait ShiftMatters {
    fn shift_matters(&self, key: Key) -> bool;
}

impl ShiftMatters for Modifiers {
    /// Whether the key does something else with Shift.
    fn shift_matters(&self, key: Key) -> bool {
        BINDINGS.iter().any(|b| b.key == key && b.modifiers.shift)
    }
}

/// Whether a key moves the camera while it is held.
pub fn is_motion(key: Key) -> bool {
    MOTIONS.iter().any(|(_, motion, _)| *motion == key)
}

impl Command {
    /// What it does, in words.
    pub fn text(self) -> &'static str {
        match self {
            Self::CompareSolution => "Load a solution for comparison",
            Self::LoadSky => "Load an image of the sky",
            Self::SaveSlot(_) => "Save camera, lights and settings",
            Self::RecallSlot(_) => "Recall camera, lights and settings",
            _ => match BINDINGS.iter().find(|b| b.command == self) {
                Some(binding) => binding.text,
                None => NUMPAD.iter().find(|pad| pad.2 == self).map_or("", |pad| pad.3),
            },
        }
    }

    /// Its first key, as text for menus; empty when it has none.
    pub fn keys(self) -> String {
        let pad = || NUMPAD.iter().find(|pad| pad.2 == self).map(|pad| pad_keys(pad.0, pad.1));
        BINDINGS.iter().find(|b| b.command == self).map(Binding::keys).or_else(pad).unwrap_or_default()
    }
}

impl Binding {
    /// Key and modifiers as text.
    pub fn keys(&self) -> String {
        let mut text = String::new();
        if self.modifiers.command {
            text += "Ctrl+";
        }
        if self.modifiers.shift {
            text += "Shift+";
        }
        text + key_name(self.key)
    }
}

/// The name of a key that is on it.
pub fn key_name(key: Key) -> &'static str {
    match key {
        Key::Comma => ",",
        Key::Period => ".",
        Key::Escape => "Esc",
        Key::ArrowLeft => "Left",
        Key::ArrowRight => "Right",
        Key::ArrowUp => "Up",
        Key::ArrowDown => "Down",
        key => key.name(),
    }
}

/// Lines of the help for a group: keys and what they do. The same command's keys are on one line.
pub fn help(group: Group) -> Vec<(String, &'static str)> {
    let mut lines: Vec<(String, &'static str)> = Vec::new();
    if group == Group::Camera {
        lines.extend(MOTIONS.iter().map(|(_, key, text)| (key_name(*key).to_owned(), *text)));
    }
    lines.extend(
        MOUSE.iter().filter(|(_, _, g)| *g == group).map(|(keys, text, _)| ((*keys).to_owned(), *text)),
    );
    if group == Group::Camera {
        lines.extend(NUMPAD.iter().map(|(pad, ctrl, _, text)| (pad_keys(*pad, *ctrl), *text)));
    }
    let mut of_command: Vec<(Command, usize)> = Vec::new();
    for binding in BINDINGS.iter().filter(|b| b.group == group) {
        match of_command.iter().find(|(command, _)| *command == binding.command) {
            Some((_, line)) => lines[*line].0 += &format!(" or {}", binding.keys()),
            None => {
                of_command.push((binding.command, lines.len()));
                lines.push((binding.keys(), binding.text));
            }
        }
    }
    lines
}

/// Commands of the keys pressed in this frame, with the keys that must not move the camera while they stay down.
pub fn pressed(input: &egui::InputState, numpad: &Numpad) -> Vec<(Command, Key)> {
    let command = |event: &egui::Event| match event {
        egui::Event::Key { key, pressed: true, repeat: false, modifiers, physical_key } => {
            let command = match numpad.take(*key, *physical_key) {
                Some(pad) => pad_command(pad, *modifiers),
                None => command_of(*key, *modifiers),
            };
            Some((command?, *key))
        }
        _ => None,
    };
    input.events.iter().filter_map(command).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_commands_share_a_key() {
        for (i, a) in BINDINGS.iter().enumerate() {
            for b in &BINDINGS[i + 1..] {
                assert!(a.key != b.key || a.modifiers != b.modifiers, "{} {}", a.keys(), a.text);
            }
            let moves = is_motion(a.key);
            assert!(!moves || a.modifiers.command, "{} flies and does something", a.keys());
        }
    }

    #[test]
    fn keys_do_what_the_table_says() {
        for binding in BINDINGS {
            assert_eq!(
                command_of(binding.key, binding.modifiers),
                Some(binding.command),
                "{}",
                binding.keys()
            );
        }
        for (pad, ctrl, command, _) in NUMPAD {
            let modifiers = if *ctrl { Modifiers::CTRL } else { Modifiers::NONE };
            assert_eq!(pad_command(*pad, modifiers), Some(*command), "{}", command.keys());
        }
        assert_eq!(command_of(Key::Num3, Modifiers::ALT), Some(Command::SaveSlot(3)));
        assert_eq!(command_of(Key::Num3, Modifiers::NONE), Some(Command::RecallSlot(3)));
        assert_eq!(command_of(Key::W, Modifiers::NONE), None);
        assert_eq!(command_of(Key::S, Modifiers::CTRL | Modifiers::COMMAND), Some(Command::SaveProject));
        assert_eq!(command_of(Key::S, Modifiers::NONE), None);
        // Flying fast, one may still put the light somewhere.
        assert_eq!(command_of(Key::Space, Modifiers::SHIFT), Some(Command::PlaceLight));
        assert_eq!(command_of(Key::Enter, Modifiers::SHIFT), Some(Command::SolveAnew));
    }

    #[test]
    fn keys_of_the_number_pad_are_told_from_digits_by_the_order_of_events() {
        let numpad = Numpad::default();
        assert_eq!(numpad.take(Key::Num1, Some(Key::Num1)), None);
        numpad.press(Pad::Digit(1));
        numpad.press(Pad::Decimal);
        assert_eq!(numpad.take(Key::Num3, None), None);
        // Without its lock, the pad has other keys.
        assert_eq!(numpad.take(Key::End, Some(Key::Num1)), Some(Pad::Digit(1)));
        assert_eq!(numpad.take(Key::Comma, None), Some(Pad::Decimal));
        assert_eq!(numpad.take(Key::Num1, Some(Key::Num1)), None);
    }

    #[test]
    fn every_command_is_in_the_help_once() {
        let lines: Vec<_> = Group::ALL.into_iter().flat_map(help).collect();
        for binding in BINDINGS {
            let with_text =
                lines.iter().filter(|(keys, text)| *text == binding.text && keys.contains(&binding.keys()));
            assert_eq!(with_text.count(), 1, "{}", binding.text);
        }
        assert!(lines.iter().any(|(keys, _)| keys == "M or Ctrl+O"));
    }

    #[test]
    fn the_readme_lists_the_keys_of_the_table() {
        let mut table = String::new();
        for group in Group::ALL {
            table += &format!("| **{}** | |\n", group.title());
            help(group).into_iter().for_each(|(keys, text)| table += &format!("| {keys} | {text} |\n"));
        }
        let readme = include_str!("../README.md");
        assert!(readme.contains(&table), "README.md is to have these lines:\n{table}");
    }
}
