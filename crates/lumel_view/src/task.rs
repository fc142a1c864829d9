//! Background work that must not block the window: files, measurements, pictures.

use crate::wake::Wake;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// A result that is being made on a thread of its own.
pub struct Background<T> {
    what: String,
    result: Receiver<Result<T, String>>,
}

impl<T: Send + 'static> Background<T> {
    /// Begins; `wake` is called when it is done. `what` says in messages what is being done: "opening a.glb".
    pub fn start(
        what: impl Into<String>,
        wake: Wake,
        make: impl FnOnce() -> Result<T, String> + Send + 'static,
    ) -> Self {
        let what = what.into();
        let (sender, result) = channel();
        let name = what.clone();
        std::thread::spawn(move || {
            let made = catch_unwind(AssertUnwindSafe(make))
                .unwrap_or_else(|_| Err(format!("this is a bug in lumel, please report it: {name}")));
            // Nobody waits for it when the window was closed meanwhile.
            let _ = sender.send(made);
            wake();
        });
        Self { what, result }
    }

    /// What is being done.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// The result, once it is there.
    pub fn poll(&self) -> Option<Result<T, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(format!("{} ended without a result", self.what))),
        }
    }

    /// Waits for the result.
    pub fn wait(self) -> Result<T, String> {
        self.result.recv().unwrap_or_else(|_| Err(format!("{} ended without a result", self.what)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn results_and_panics_arrive() {
        let wake: Wake = Arc::new(|| {});
        let good = Background::start("counting", Arc::clone(&wake), || Ok(7));
        assert_eq!(good.what(), "counting");
        assert_eq!(good.wait(), Ok(7));
        let bad: Background<u32> = Background::start("falling", wake, || panic!("on purpose"));
        assert!(bad.wait().unwrap_err().contains("bug in lumel, please report it: falling"));
    }
}
