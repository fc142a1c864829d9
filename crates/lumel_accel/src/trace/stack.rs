//! Nodes still to be visited.

use crate::bvh::{Child, MAX_STACK};

/// A node, and who is to visit it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Entry {
    /// Where the first of its rays enters it.
    pub(super) near: f32,
    pub(super) child: Child,
    /// The rays that do, of a packet.
    pub(super) lanes: u32,
}

/// A stack that is deep enough for every tree: building sees to that.
pub(crate) struct Stack {
    entries: [Entry; MAX_STACK],
    len: usize,
}

// So that an index is brought into range by a mask.
const _: () = assert!(MAX_STACK.is_power_of_two());

impl Stack {
    pub(crate) fn new() -> Self {
        Self { entries: [Entry::default(); MAX_STACK], len: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Pushes an entry if it is `wanted`, without a branch.
    #[inline(always)]
    pub(super) fn push_if(&mut self, wanted: bool, entry: Entry) {
        self.entries[self.len & (MAX_STACK - 1)] = entry;
        self.len += usize::from(wanted);
    }

    /// Pops, unless only `bottom` entries are left.
    #[inline(always)]
    pub(super) fn pop_above(&mut self, bottom: usize) -> Option<Entry> {
        if self.len <= bottom {
            return None;
        }
        self.len -= 1;
        Some(self.entries[self.len & (MAX_STACK - 1)])
    }
}
