//! What the renderer draws, on any adapter: a software one will do.

mod agreement;
mod common;
mod golden;
mod marks;
mod pictures;
mod robust;
mod scenes;
