//! A long computation looks up between its parts: whoever started it may count them, or end it.
//!
//! What is called belongs to the thread that computes, so that no signature carries it; parts that other threads take over
//! look up by what [`handed`] gives them.
//!
//! ```
//! use std::{panic, sync::Arc, sync::atomic::{AtomicUsize, Ordering}, thread};
//! use bipenalty::interrupt::{handed, look, watched};
//! let parts = Arc::new(AtomicUsize::new(0));
//! let seen = Arc::clone(&parts);
//! watched(Arc::new(move || { seen.fetch_add(1, Ordering::Relaxed); }), || {
//!     look();
//!     let here = handed();
//!     thread::scope(|scope| { scope.spawn(|| { look(); here.look() }); });
//! });
//! look(); // nobody watches any more, nor the other thread by itself
//! assert_eq!(parts.load(Ordering::Relaxed), 2);
//! // To end it is to unwind; `resume_unwind` prints nothing.
//! let end = Arc::new(|| panic::resume_unwind(Box::new("enough")));
//! assert!(panic::catch_unwind(|| watched(end, look)).is_err());
//! ```

use std::cell::RefCell;
use std::sync::Arc;

/// What is called between parts.
pub type Watch = Arc<dyn Fn() + Send + Sync>;

thread_local! {
    /// What is called on this thread.
    static WATCH: RefCell<Option<Watch>> = const { RefCell::new(None) };
}

/// Takes the watch back, also from a computation that unwinds.
struct Before(Option<Watch>);

impl Drop for Before {
    fn drop(&mut self) {
        WATCH.set(self.0.take());
    }
}

/// Does `work`, which calls `watch` between its parts; `watch` may unwind, which ends it.
pub fn watched<R>(watch: Watch, work: impl FnOnce() -> R) -> R {
    let _before = Before(WATCH.replace(Some(watch)));
    work()
}

/// What watched the thread that asked for it, for threads that take over its parts.
#[derive(Clone)]
pub struct Handed(Option<Watch>);

impl Handed {
    /// Calls what watches.
    pub fn look(&self) {
        if let Some(watch) = &self.0 {
            watch();
        }
    }
}

/// What watches this thread.
pub fn handed() -> Handed {
    Handed(WATCH.with_borrow(Option::clone))
}

/// Calls what watches this thread.
pub fn look() {
    handed().look();
}
