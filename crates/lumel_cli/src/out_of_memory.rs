//! What happens when there is no memory left.
#![allow(
    unsafe_code,
    reason = "an allocator cannot be written without; it passes everything on to that of the system"
)]

use crate::console::Messages;
use crate::outcome::FAILED;
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The allocator of the system. When it has nothing left, the program ends with an error, and not by a signal.
pub(crate) struct OrError;

/// Whether errors are JSON objects.
static AS_JSON: AtomicBool = AtomicBool::new(false);
/// Whether the error is being told.
static TOLD: AtomicBool = AtomicBool::new(false);

/// How long other threads that have no memory either wait for the end of the program.
const PATIENCE: Duration = Duration::from_secs(5);

const MESSAGE: &str = "out of memory";
const HINT: &str = "close other programs, raise the limit of this one (ulimit -v), lower --memory or --threads, or split edges \
                    less finely; a bake goes on with --resume from its checkpoint, if there is one";

/// How the error is told.
pub(crate) fn tell_as(messages: Messages) {
    AS_JSON.store(messages == Messages::Json, Ordering::Relaxed);
}

/// Tells the error and ends the program. Nothing here allocates.
fn end(bytes: usize) {
    if TOLD.swap(true, Ordering::SeqCst) {
        std::thread::sleep(PATIENCE);
        return;
    }
    let mut out = io::stderr().lock();
    // If stderr is closed, nobody reads messages.
    let _ = if AS_JSON.load(Ordering::Relaxed) {
        let (open, close) = ('{', '}');
        writeln!(
            out,
            "{open}\"event\":\"error\",\"hint\":\"{HINT}\",\"message\":\"{MESSAGE}: no {bytes} bytes more\"{close}"
        )
    } else {
        writeln!(out, "error: {MESSAGE}: no {bytes} bytes more\n  hint: {HINT}")
    };
    drop(out);
    std::process::exit(i32::from(FAILED));
}

/// What the system gave; without it, there is no return.
fn given(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() {
        end(bytes);
    }
    memory
}

// SAFETY: every call is passed on to the allocator of the system unchanged, and what it returns is returned.
unsafe impl GlobalAlloc for OrError {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps what both promise.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps what both promise.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller keeps what both promise.
        given(unsafe { System.realloc(memory, layout, size) }, size)
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps what both promise.
        unsafe { System.dealloc(memory, layout) }
    }
}
