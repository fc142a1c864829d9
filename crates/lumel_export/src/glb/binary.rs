//! The binary chunk of a GLB file.

use serde_json::{Value, json};

/// The layout of the binary chunk, planned before anything is written.
#[derive(Default)]
pub(super) struct Binary {
    pub(super) length: u64,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Binary {
    /// Reserves space, a multiple of four bytes; returns the index of the view.
    pub(super) fn add_view(&mut self, length: u64, mut view: Value) -> usize {
        view["buffer"] = json!(0);
        view["byteOffset"] = json!(self.length);
        view["byteLength"] = json!(length);
        self.length += length.next_multiple_of(4);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Describes numbers; returns the index of the accessor.
    pub(super) fn add_accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}
