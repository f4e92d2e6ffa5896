//! Long calls: they run on threads of this process, while the thread that called lets other Python threads run, tells how
//! far they are, and looks for Ctrl-C.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
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

/// Pools of this process that compute nothing now. A call has one to itself: in a common one a thread that waits for a part of
/// one call would take up another call whole, and wait for a model that it holds itself.
static IDLE: Mutex<Idle> = Mutex::new(Idle { process: 0, pools: Vec::new() });

struct Idle {
    process: u32,
    pools: Vec<Arc<ThreadPool>>,
}

/// What lies idle in this process: a child that was forked has none of its parent's threads.
fn idle() -> MutexGuard<'static, Idle> {
    let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    if idle.process != std::process::id() {
        // The parent's threads are not here to be ended.
        std::mem::forget(std::mem::take(&mut idle.pools));
        idle.process = std::process::id();
    }
    idle
}

fn pool() -> PyResult<Arc<ThreadPool>> {
    if let Some(pool) = idle().pools.pop() {
        return Ok(pool);
    }
    let built = ThreadPoolBuilder::new().thread_name(|i| format!("bipenalty-{i}")).build();
    Ok(Arc::new(built.map_err(|e| PyRuntimeError::new_err(e.to_string()))?))
}

/// Keeps a pool for the next call, if there are not as many idle pools as threads in one: more calls at a time gain nothing.
fn give_back(pool: Arc<ThreadPool>) {
    let mut idle = idle();
    if idle.pools.len() < pool.current_num_threads() {
        idle.pools.push(pool);
    }
}

/// Runs `work` on threads of its own. `progress` is called with the parts done and `total` now and then, if it
/// is not None.
///
/// # Errors
/// What a signal raises, Ctrl-C above all, and what `progress` raises. Both are raised at once; the computation ends at its next
/// part, on its own threads. What it works on lives until then.
pub fn long<T: Send + 'static>(
    py: Python<'_>,
    total: usize,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel::<Result<T, Box<dyn Any + Send>>>();
    let watch = Arc::new(Watch::default());
    let watched = Arc::clone(&watch);
    let pool = pool()?;
    let own = Arc::clone(&pool);
    pool.spawn(move || {
        let looking = Arc::clone(&watched);
        let result = catch_unwind(AssertUnwindSafe(|| {
            interrupt::watched(Arc::new(move || looking.look()), || work(&watched))
        }));
        give_back(own);
        // Nobody waits any more after Ctrl-C.
        let _ = sender.send(result);
    });
    drop(pool);
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
