//! A long computation looks up between its parts: whoever started it may count them, or end it.
//!
//! What is called belongs to the thread that computes, so that no signature carries it; parts that other threads take over
//! do not look up.
//!
//! ```
//! use std::{cell::Cell, panic, rc::Rc};
//! use bipenalty::interrupt::{look, watched};
//! let parts = Rc::new(Cell::new(0));
//! let seen = Rc::clone(&parts);
//! watched(Rc::new(move || seen.set(seen.get() + 1)), look);
//! look(); // nobody watches any more
//! assert_eq!(parts.get(), 1);
//! // To end it is to unwind; `resume_unwind` prints nothing.
//! let end = Rc::new(|| panic::resume_unwind(Box::new("enough")));
//! assert!(panic::catch_unwind(|| watched(end, look)).is_err());
//! ```

use std::cell::RefCell;
use std::rc::Rc;

thread_local! {
    /// What is called on this thread.
    static WATCH: RefCell<Option<Rc<dyn Fn()>>> = const { RefCell::new(None) };
}

/// Takes the watch back, also from a computation that unwinds.
struct Before(Option<Rc<dyn Fn()>>);

impl Drop for Before {
    fn drop(&mut self) {
        WATCH.set(self.0.take());
    }
}

/// Does `work`, which calls `watch` between its parts; `watch` may unwind, which ends it.
pub fn watched<R>(watch: Rc<dyn Fn()>, work: impl FnOnce() -> R) -> R {
    let _before = Before(WATCH.replace(Some(watch)));
    work()
}

/// Calls what watches this thread.
pub fn look() {
    let watch = WATCH.with_borrow(Option::clone);
    if let Some(watch) = watch {
        watch();
    }
}
