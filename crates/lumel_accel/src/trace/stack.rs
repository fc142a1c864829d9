//! Nodes still to be visited.

use crate::bvh::{Child, MAX_STACK};
use std::cell::RefCell;

/// A node, and who is to visit it.
#[derive(Clone, Copy, Debug)]
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
    /// The blocks of triangles that were in the way of shadow rays last, the last one first.
    in_the_way: [usize; GUESSES],
}

/// Blocks that are tried before the tree is walked: in a penumbra, several take turns.
const GUESSES: usize = 4;

// So that an index is brought into range by a mask.
const _: () = assert!(MAX_STACK.is_power_of_two());

thread_local! {
    /// Of this thread: to fill a new one with zeros takes longer than many a ray.
    static OF_THREAD: RefCell<Stack> =
        const { RefCell::new(Stack::new()) };
}

impl Stack {
    const fn new() -> Self {
        let entry = Entry { near: 0.0, child: Child::ROOT, lanes: 0 };
        Self { entries: [entry; MAX_STACK], len: 0, in_the_way: [usize::MAX; GUESSES] }
    }

    /// The nodes on it, the next one last.
    pub(crate) fn children(&self) -> impl ExactSizeIterator<Item = Child> + '_ {
        self.entries[..self.len].iter().map(|entry| entry.child)
    }

    /// Lends the thread's stack, empty. What it is lent to must not ask for it again.
    #[inline]
    pub(crate) fn lend<T>(to: impl FnOnce(&mut Self) -> T) -> T {
        OF_THREAD.with_borrow_mut(|stack| {
            stack.clear();
            to(stack)
        })
    }

    /// Blocks that may be in the way of shadow rays, the most likely one first; there may be no such block.
    #[inline(always)]
    pub(super) fn guesses(&self) -> [usize; GUESSES] {
        self.in_the_way
    }

    /// Notes a block that is in the way.
    #[inline(always)]
    pub(super) fn is_in_the_way(&mut self, block: usize) {
        let place = self.in_the_way.iter().position(|&known| known == block).unwrap_or(GUESSES - 1);
        self.in_the_way[..=place].rotate_right(1);
        self.in_the_way[0] = block;
    }

    /// None of them is: they are not tried again.
    #[inline(always)]
    pub(super) fn forget_guesses(&mut self) {
        self.in_the_way = [usize::MAX; GUESSES];
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: Entry) {
        self.push_if(true, entry);
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
