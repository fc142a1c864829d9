//! Packages of the system that the tests of renderer and viewer need: a Vulkan driver, a display, and what the viewer
//! loads when it opens a window.

use crate::shell::{say, succeeds};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a package is looked for by.
#[derive(Clone, Copy, Debug)]
enum Sign {
    /// The name of a shared library.
    Library(&'static str),
    /// The description of any Vulkan driver.
    Driver,
    /// A program.
    Program(&'static str),
}

/// Debian's packages, and how one sees that they, or what stands for them, are there.
const PACKAGES: [(&str, Sign); 7] = [
    ("libvulkan1", Sign::Library("libvulkan.so.1")),
    ("mesa-vulkan-drivers", Sign::Driver),
    ("libxcursor1", Sign::Library("libXcursor.so.1")),
    ("libxi6", Sign::Library("libXi.so.6")),
    ("libxkbcommon-x11-0", Sign::Library("libxkbcommon-x11.so.0")),
    ("xvfb", Sign::Program("Xvfb")),
    ("xdotool", Sign::Program("xdotool")),
];

/// Packages without which nothing can be drawn; without the others no window can be opened.
const FOR_DRAWING: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];

/// Where drivers describe themselves.
const DRIVER_FOLDERS: [&str; 3] =
    ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"];

/// Installs what is missing where that needs no questions; else says what to install and which tests go without.
///
/// Only on Linux: other systems have their own drivers and displays.
///
/// # Errors
/// In CI, where no test may be skipped, when something is missing.
pub(crate) fn provide() -> Result<()> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let mut missing = Machine::look().missing();
    if !missing.is_empty() && install(&missing) {
        missing = Machine::look().missing();
    }
    if missing.is_empty() {
        return Ok(());
    }
    let message = message(&missing);
    if std::env::var_os("CI").is_some() {
        bail!("CI must not skip tests: {message}");
    }
    say(&format!("skipped: {message}"));
    Ok(())
}

fn message(missing: &[&str]) -> String {
    let nothing_drawn = missing.iter().any(|package| FOR_DRAWING.contains(package));
    let tests = if nothing_drawn { "that draw or open a window" } else { "that open a window" };
    format!(
        "tests of lumel_render_gpu and lumel_view {tests} need `apt-get install -y --no-install-recommends {}`, or what \
         other systems have in their place",
        missing.join(" ")
    )
}

/// Whether packages could be installed.
fn install(packages: &[&str]) -> bool {
    let Some(mut update) = apt_get() else { return false };
    let Some(mut install) = apt_get() else { return false };
    say(&format!("installing {}", packages.join(" ")));
    install.args(["install", "-y", "--no-install-recommends"]).args(packages);
    // An update that fails for one source out of several need not be in the way.
    succeeds(update.arg("update"));
    succeeds(&mut install)
}

/// The package manager, for those who may use it without being asked anything.
fn apt_get() -> Option<Command> {
    if !succeeds(Command::new("apt-get").arg("--version")) {
        return None;
    }
    let id = Command::new("id").arg("-u").stderr(Stdio::null()).output().ok()?;
    let mut command = if id.stdout.trim_ascii() == b"0" {
        Command::new("env")
    } else if succeeds(Command::new("sudo").args(["-n", "true"])) {
        let mut sudo = Command::new("sudo");
        sudo.args(["-n", "env"]);
        sudo
    } else {
        return None;
    };
    command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get"]);
    Some(command)
}

/// What a machine has.
#[derive(Default)]
struct Machine {
    /// Names of shared libraries.
    libraries: Vec<String>,
    has_driver: bool,
    /// Where programs are.
    path: Vec<PathBuf>,
}

impl Machine {
    fn look() -> Self {
        let path = std::env::var_os("PATH").unwrap_or_default();
        // Set by those who keep a driver elsewhere.
        let elsewhere = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];
        Self {
            libraries: libraries(),
            has_driver: elsewhere.iter().any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()))
                || DRIVER_FOLDERS.iter().any(|folder| has_json(Path::new(folder))),
            path: std::env::split_paths(&path).collect(),
        }
    }

    /// The packages it lacks.
    fn missing(&self) -> Vec<&'static str> {
        let lacks = |sign: &Sign| match *sign {
            Sign::Library(name) => !self.libraries.iter().any(|library| library == name),
            Sign::Driver => !self.has_driver,
            Sign::Program(name) => !self.path.iter().any(|folder| folder.join(name).is_file()),
        };
        PACKAGES.iter().filter(|(_, sign)| lacks(sign)).map(|(package, _)| *package).collect()
    }
}

/// All shared libraries that the loader knows.
fn libraries() -> Vec<String> {
    // Not on the path of ordinary users everywhere.
    let lists = ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"].map(|ldconfig| {
        Command::new(ldconfig).arg("-p").stderr(Stdio::null()).output().map(|out| out.stdout)
    });
    let list = lists.into_iter().flatten().find(|list| !list.is_empty()).unwrap_or_default();
    names_in(&String::from_utf8_lossy(&list))
}

/// The first word of each line but the heading: `libXi.so.6 (libc6,x86-64) => /lib/…`.
fn names_in(list: &str) -> Vec<String> {
    let entries = list.lines().filter(|line| line.contains("=>"));
    entries.filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

fn has_json(folder: &Path) -> bool {
    let is_json = |path: PathBuf| path.extension().is_some_and(|extension| extension == "json");
    std::fs::read_dir(folder).is_ok_and(|entries| entries.flatten().any(|entry| is_json(entry.path())))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "812 libs found in cache `/etc/ld.so.cache'\n\
                        \tlibXi.so.60 (libc6,x86-64) => /lib/x86_64-linux-gnu/libXi.so.60\n\
                        \tlibvulkan.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libvulkan.so.1\n";

    #[test]
    fn a_bare_machine_lacks_everything() {
        let missing = Machine::default().missing();
        assert_eq!(missing.len(), PACKAGES.len());
        let message = message(&missing);
        assert!(
            message.contains("draw or open a window") && message.contains("libvulkan1 mesa-vulkan-drivers")
        );
    }

    #[test]
    fn only_what_is_lacking_is_asked_for() {
        let machine = Machine { libraries: names_in(LIST), has_driver: true, path: Vec::new() };
        let missing = machine.missing();
        assert_eq!(missing, ["libxcursor1", "libxi6", "libxkbcommon-x11-0", "xvfb", "xdotool"]);
        assert!(message(&missing).contains("lumel_view that open a window need"));
    }

    #[test]
    fn libraries_are_told_by_their_whole_names() {
        assert_eq!(names_in(LIST), ["libXi.so.60", "libvulkan.so.1"]);
    }
}
