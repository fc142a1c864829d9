//! Undo and redo.

/// The states to undo and redo; `T` is everything that can be undone.
#[derive(Clone, Debug)]
pub struct History<T> {
    past: Vec<T>,
    future: Vec<T>,
    present: T,
}

/// More steps than this are forgotten, oldest first.
const MAX_STEPS: usize = 200;

impl<T: Clone + PartialEq> History<T> {
    /// A history that begins here.
    pub fn new(present: T) -> Self {
        Self { past: Vec::new(), future: Vec::new(), present }
    }

    /// Records the state after a complete change, such as at the end of a drag.
    pub fn commit(&mut self, now: &T) {
        if *now == self.present {
            return;
        }
        self.past.push(std::mem::replace(&mut self.present, now.clone()));
        if self.past.len() > MAX_STEPS {
            self.past.remove(0);
        }
        self.future.clear();
    }

    /// The state before the last change; `None` when there was none.
    pub fn undo(&mut self) -> Option<T> {
        let before = self.past.pop()?;
        self.future.push(std::mem::replace(&mut self.present, before));
        Some(self.present.clone())
    }

    /// The state after the change that was undone last.
    pub fn redo(&mut self) -> Option<T> {
        let after = self.future.pop()?;
        self.past.push(std::mem::replace(&mut self.present, after));
        Some(self.present.clone())
    }

    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_goes_back_and_forth_until_something_new_is_done() {
        let mut history = History::new(0);
        for n in [1, 1, 2, 3] {
            history.commit(&n);
        }
        assert_eq!([history.undo(), history.undo()], [Some(2), Some(1)]);
        assert_eq!(history.redo(), Some(2));
        history.commit(&7);
        assert_eq!(history.redo(), None);
        assert_eq!(
            [history.undo(), history.undo(), history.undo(), history.undo()],
            [Some(2), Some(1), Some(0), None]
        );
        assert!(history.can_redo() && !history.can_undo());
    }

    #[test]
    fn history_has_an_end() {
        let mut history = History::new(0);
        (1..=1000).for_each(|n| history.commit(&n));
        let steps = std::iter::from_fn(|| history.undo()).count();
        assert_eq!(steps, MAX_STEPS);
    }
}
