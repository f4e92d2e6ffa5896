//! Long calls: they run on threads of this process, while the thread that called lets other Python threads run, tells how
//! far they are, and looks for Ctrl-C.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use bipenalty::interrupt;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// How often the calling thread looks for Ctrl-C: sooner than a finger leaves the key.
const LOOK: Duration = Duration::from_millis(50);

/// What a computation tells while it goes on, and whether it should end.
#[derive(Default)]
pub struct Watch {
    stop: AtomicBool,
    done: AtomicUsize,
}

/// What unwinds a computation that should end.
struct Stopped;

impl Watch {
    /// `more` parts are finished.
    pub fn add(&self, more: usize) {
        self.done.fetch_add(more, Ordering::Relaxed);
        self.look();
    }

    /// Ends the computation if it should.
    fn look(&self) {
        if self.stop.load(Ordering::Relaxed) {
            // Caught where the computation began; no message is printed.
            resume_unwind(Box::new(Stopped));
        }
    }

    /// So many parts are finished.
    pub fn set(&self, done: u64) {
        self.done.store(done as usize, Ordering::Relaxed);
    }

    /// Set when the computation should end.
    pub fn stop(&self) -> &AtomicBool {
        &self.stop
    }
}

/// The threads of this process: a child that was forked has none of its parent's.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*known {
        Some((process, pool)) if *process == std::process::id() => Ok(Arc::clone(pool)),
        _ => {
            let built = ThreadPoolBuilder::new().thread_name(|i| format!("bipenalty-{i}")).build();
            let pool = Arc::new(built.map_err(|e| PyRuntimeError::new_err(e.to_string()))?);
            // The parent's threads are not here to be ended.
            std::mem::forget(known.replace((std::process::id(), Arc::clone(&pool))));
            Ok(pool)
        }
    }
}

/// Runs `work` on the threads of this process. `progress` is called with the parts done and `total` now and then, if it
/// is not None.
///
/// # Errors
/// What a signal raises, Ctrl-C above all, and what `progress` raises: the computation ends at its next part.
pub fn long<T: Send + 'static>(
    py: Python<'_>,
    total: usize,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel::<Result<T, Box<dyn Any + Send>>>();
    let watch = Arc::new(Watch::default());
    let watched = Arc::clone(&watch);
    pool()?.spawn(move || {
        let looking = Arc::clone(&watched);
        let result = catch_unwind(AssertUnwindSafe(|| {
            interrupt::watched(Rc::new(move || looking.look()), || work(&watched))
        }));
        // Nobody waits any more after Ctrl-C.
        let _ = sender.send(result);
    });
    let tell = |done: usize| progress.map_or(Ok(()), |told| told.call1((done.min(total), total)).map(|_| ()));
    loop {
        // A receiver may be handed on, but not shared.
        let (found, back) = py.detach(move || (receiver.recv_timeout(LOOK), receiver));
        receiver = back;
        match found {
            Ok(Ok(result)) => return tell(total).map(|()| result),
            Ok(Err(panic)) if panic.is::<Stopped>() => return Err(PyKeyboardInterrupt::new_err(())),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a thread of the computation ended without a result"));
            }
            Err(RecvTimeoutError::Timeout) => {
                let looked = py.check_signals().and_then(|()| tell(watch.done.load(Ordering::Relaxed)));
                if let Err(raised) = looked {
                    watch.stop.store(true, Ordering::Relaxed);
                    return Err(raised);
                }
            }
        }
    }
}
