//! Memory that every frame takes and gives back.

/// Of what was freed, this much stays with the program, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT: i32 = 64 << 20;

/// What is asked of the system ahead of need, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const AHEAD: i32 = 16 << 20;

/// Lets the C library keep memory that was freed, where it can be told to; whether it does.
///
/// A software renderer allocates what the vertex shaders of each draw call write. To return that to the system and to have it filled with
/// zeros again took a sixth of the time of a frame.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code, reason = "a function of C sets up its allocator")]
pub(crate) fn keep_freed_memory() -> bool {
    let options = [(libc::M_TRIM_THRESHOLD, KEPT), (libc::M_TOP_PAD, AHEAD)];
    // SAFETY: it takes two numbers, changes settings of the allocator alone, and refuses what it does not know.
    options.iter().all(|&(option, value)| unsafe { libc::mallopt(option, value) } == 1)
}

/// Other C libraries decide for themselves.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn keep_freed_memory() -> bool {
    false
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_c_library_of_gnu_keeps_what_was_freed() {
        assert_eq!(super::keep_freed_memory(), cfg!(all(target_os = "linux", target_env = "gnu")));
    }
}
