//! Whether a window can be opened here at all.

/// What to do when no window can be opened.
pub const WINDOW_HINT: &str = "on Debian a window needs libvulkan1, libxcursor1, libxi6, libxkbcommon-x11-0 and a Vulkan \
                               driver such as mesa-vulkan-drivers; --screenshot FILE needs no window";

/// Libraries that the window opens by their name, and the Debian packages that bring them.
#[cfg(target_os = "linux")]
const LIBRARIES: [(&str, &str); 3] = [
    ("libXcursor.so.1", "libxcursor1"),
    ("libXi.so.6", "libxi6"),
    ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
];

/// Checks that there is a display, and what a window on it needs.
///
/// # Errors
/// What is missing and how to get it.
#[cfg(target_os = "linux")]
pub fn check_display() -> anyhow::Result<()> {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET") {
        return Ok(());
    }
    if !set("DISPLAY") {
        anyhow::bail!(
            "there is no display: neither DISPLAY nor WAYLAND_DISPLAY is set\n  hint: start it on a desktop or under \
             xvfb-run, or draw a picture with --screenshot FILE"
        );
    }
    let missing: Vec<&str> =
        LIBRARIES.iter().filter(|(library, _)| !is_installed(library)).map(|(_, package)| *package).collect();
    if !missing.is_empty() {
        anyhow::bail!(
            "a window needs libraries that are not installed\n  hint: on Debian, apt-get install {}",
            missing.join(" ")
        );
    }
    Ok(())
}

/// Checks nothing: other systems always have what a window needs.
///
/// # Errors
/// None.
#[cfg(not(target_os = "linux"))]
pub fn check_display() -> anyhow::Result<()> {
    Ok(())
}

/// Whether the loader would find a library, as far as the usual folders tell. Where there are none, it is not refused.
#[cfg(target_os = "linux")]
fn is_installed(library: &str) -> bool {
    let folders = ["/usr/lib", "/usr/lib64", "/lib", "/lib64", "/usr/local/lib"];
    let arch = format!("/usr/lib/{}-linux-gnu", std::env::consts::ARCH);
    let custom = std::env::var("LD_LIBRARY_PATH").unwrap_or_default();
    let mut all = folders.iter().copied().chain([arch.as_str()]).chain(custom.split(':'));
    // Systems with folders of their own, such as NixOS, keep libraries where only their programs know.
    let unusual = !std::path::Path::new(&arch).is_dir() && !std::path::Path::new("/usr/lib64").is_dir();
    unusual || all.any(|folder| std::path::Path::new(folder).join(library).exists())
}
