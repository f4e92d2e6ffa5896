"""Long calls: they let other threads run, tell how far they are, end on Ctrl-C, and no thread changes a number."""

import multiprocessing
import os
import subprocess
import sys
import threading
import time

import bipenalty as bp
import numpy as np
import pytest

BETA_S, RATIO = np.logspace(-3, 12, 300), np.logspace(-1, 3, 300)

# Calls that take longer than anyone waits.
LONG = {
    "map": "bp.Model.from_scene('hunek', mass='consistent').stability_map(np.logspace(-3, 12, 9000), "
    "np.logspace(-1, 3, 900), limit='park')",
    "impact": "bp.Model.from_scene('hunek', elements=2000).impact(1e3, 1.0, duration=1e2, every=10**6)",
    "verify": "bp.Model.from_scene('hunek', elements=20000).verify(1e3, 1.0, scheme='park')",
    "matrices": "bp.Model.from_matrices(K, M, Z).stability_map(np.logspace(-3, 12, 400), np.logspace(-1, 3, 400), "
    "tolerance=1e-12)",
    "assembly": "bp.Model.from_scene(BRICK.replace('CELLS', '[150, 150, 90]'))",
    "patches": "BRICKS.stability_map(np.logspace(-3, 9, 60), np.logspace(-1, 3, 60), patch=3)",
    "impact of a mesh": "BRICKS.impact(1e2, 0.25, duration=1e6, every=10**6)",
    "stepping a mesh": "BRICKS.verify(1e2, 0.25, scheme='predictor-corrector')",
}
SETUP = """
import signal, sys, threading, time, os
import bipenalty as bp
import numpy as np
import scipy.sparse as sp
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background is begun without
line = sp.diags([-np.ones(89), 2 * np.ones(90), -np.ones(89)], [-1, 0, 1])
K = sp.csr_matrix(sp.kronsum(line, line))
M, Z = sp.csr_matrix(K * 1e-2 + sp.eye(8100)), sp.eye(8100, format='csr')[:, :90]
BRICK = '''
name = "brick"
dimension = 3
[[body]]
name = "brick"
box = [3.0, 2.0, 1.0]
cells = CELLS
element = "hex8"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
velocity = [0.0, -0.01, 0.0]
[[contact]]
surfaces = ["brick.bottom", "wall"]
[impact]
duration = 5.0
'''
BRICKS = bp.Model.from_scene(BRICK.replace("CELLS", "[30, 20, 10]"))
"""


@pytest.mark.parametrize("name", LONG)
def test_interrupt(name):
    """Ctrl-C ends the call, and the computation with it: a second at most, or what a busy machine makes of it."""
    script = f"""{SETUP}
def press():
    time.sleep(1.0)
    global pressed
    pressed = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=press).start()
try:
    {LONG[name]}
except KeyboardInterrupt:
    late = time.perf_counter() - pressed
    time.sleep(2.0)
    used = time.process_time()
    time.sleep(1.0)
    print(late, time.process_time() - used)
else:
    print("ended by itself")
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300, check=True)
    assert run.stdout != "ended by itself\n", "the call is too short for this test"
    late, used = map(float, run.stdout.split())
    assert late < 10.0
    assert used < 0.5, "the computation went on"


def test_interrupted_factorisation():
    """A factor cannot be left half done: the call ends at once, the factor when it is ready, what it reads lives on."""
    script = f"""{SETUP}
import gc
n = 26
line = sp.diags([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], [-1, 0, 1])
K = sp.csr_matrix(sp.kronsum(sp.kronsum(line, line), line))
model = bp.Model.from_matrices(K, np.ones(n**3), sp.eye(n**3, format='csr')[:, :n])
want = bp.Model.from_matrices(K.copy(), np.ones(n**3), sp.eye(n**3, format='csr')[:, :n]).critical_step(10.0, 2.0)
def press(after):
    time.sleep(after)
    global pressed
    pressed = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
late = []
for after in np.linspace(0.05, 2.0, 8):
    other = bp.Model.from_matrices(K.copy(), np.ones(n**3), sp.eye(n**3, format='csr')[:, :n])
    threading.Thread(target=press, args=(after,)).start()
    try:
        [other.critical_step(10.0 + i, 2.0, tolerance=1e-11) for i in range(1000)]
    except KeyboardInterrupt:
        late.append(time.perf_counter() - pressed)
    del other  # what still computes holds its arrays
    gc.collect()
    _ = [np.full(n**3, np.nan) for _ in range(20)]
found = model.critical_step(10.0, 2.0)
print(len(late), max(late), (found.lower, found.upper) == (want.lower, want.upper))
"""
    environment = {**os.environ, "PYTHONMALLOC": "debug"}
    command = [sys.executable, "-c", script]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=True)
    count, late, same = run.stdout.split()
    assert (count, same) == ("8", "True")
    assert float(late) < 10.0


def test_ctrl_c_ends_a_script():
    """Nobody waits for what still computes."""
    script = f"""{SETUP}
import bipenalty
signal.setitimer(signal.ITIMER_REAL, 1.0)
signal.signal(signal.SIGALRM, signal.default_int_handler)
{LONG["stepping a mesh"]}
"""
    start = time.perf_counter()
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300, check=False)
    assert "KeyboardInterrupt" in run.stderr
    assert time.perf_counter() - start < 30.0


def test_one_model_from_threads():
    """Threads that ask one model wait for each other, and no thread for itself."""
    script = f"""{SETUP}
line = sp.diags([-np.ones(199), 2 * np.ones(200), -np.ones(199)], [-1, 0, 1])
K = sp.csr_matrix(sp.kronsum(line, line))
model = bp.Model.from_matrices(K, np.ones(40000), sp.eye(40000, format='csr')[:, :20])
def ask(seed):
    rng = np.random.default_rng(seed)
    for _ in range(12):
        time.sleep(0.3 * rng.random())
        model.critical_step(10.0 ** rng.uniform(0, 3), 2.0, tolerance=1e-10)
threads = [threading.Thread(target=ask, args=(seed,)) for seed in range(3)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
"""
    environment = {**os.environ, "RAYON_NUM_THREADS": "4"}
    subprocess.run([sys.executable, "-c", script], env=environment, timeout=120, check=True)


def test_a_short_call_does_not_wait_for_a_long_one():
    script = f"""{SETUP}
short = bp.Model.from_matrices(K, np.ones(8100), Z[:, :1])
stop = threading.Event()
def long():
    try:
        bp.Model.from_scene('hunek', elements=2000).impact(
            1e3, 1.0, duration=1e2, every=10**6, progress=lambda done, total: 1 / (not stop.is_set()))
    except ZeroDivisionError:
        print("stopped")
thread = threading.Thread(target=long)
thread.start()
time.sleep(0.5)
short.critical_step(1.0, tolerance=1e-3)
print(thread.is_alive())
stop.set()
thread.join()
"""
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    command = [sys.executable, "-c", script]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=True)
    assert run.stdout.split() == ["True", "stopped"]


def test_other_threads_run():
    """A thread that counts goes on counting while a map is made."""
    counted, stop = [], threading.Event()

    def count():
        while not stop.is_set():
            counted.append(time.perf_counter())
            time.sleep(1e-3)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.perf_counter()
    bp.Model.from_scene("hunek", mass="consistent").stability_map(BETA_S, RATIO, limit="park")
    end = time.perf_counter()
    stop.set()
    thread.join()
    # Held through the call, the lock lets the counter in at its ends only.
    assert sum(start < at < end for at in counted) > 0.02 * (end - start) / 1e-3


def test_calls_from_threads():
    model = bp.Model.from_scene("signorini", elements=100)
    want = [model.stability_map(BETA_S, [r]).lower.tobytes() for r in (0.5, 2.0, 9.0, np.inf)]
    found = [None] * 4

    def ask(i, r):
        found[i] = model.stability_map(BETA_S, [r]).lower.tobytes()

    threads = [threading.Thread(target=ask, args=pair) for pair in enumerate((0.5, 2.0, 9.0, np.inf))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == want


def test_threads_change_nothing():
    script = f"""{SETUP}
import hashlib
maps = [bp.Model.from_scene('symmetric').stability_map(np.logspace(-3, 12, 50), [0.5, 3.0], limit=limit)
        for limit in ('spectrum', 'predictor-corrector', 'park')]
maps.append(bp.Model.from_matrices(K, M, Z).stability_map(np.logspace(-3, 9, 7), [0.5, 3.0], tolerance=1e-3))
print(hashlib.sha256(b''.join(m.lower.tobytes() + m.upper.tobytes() for m in maps)).hexdigest())
"""
    threads = ("1", "2", "3")
    runs = [
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "RAYON_NUM_THREADS": n},
            capture_output=True,
            text=True,
            check=True,
        )
        for n in threads
    ]
    assert len({run.stdout for run in runs}) == 1
    assert len(runs[0].stdout) == 65


def test_progress(capfd):
    seen = []
    model = bp.Model.from_scene("hunek", mass="consistent")
    model.stability_map(BETA_S, RATIO, limit="park", progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (90_000, 90_000)
    assert seen == sorted(seen)
    assert len(seen) > 2, "a call that takes a second is told of more than its end"
    model.stability_map(BETA_S, [1.0], progress=True)
    assert capfd.readouterr().err.endswith("100 % of 300\n")


def test_progress_may_raise():
    def stop(done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        bp.Model.from_scene("hunek").stability_map(BETA_S, RATIO, limit="park", progress=stop)


def in_child(queue):
    queue.put(bp.Model.from_scene("signorini").stability_map(BETA_S, RATIO).lower.tobytes())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forked_children_compute_too():
    """A child that is forked has none of the threads of its parent."""
    here = bp.Model.from_scene("signorini").stability_map(BETA_S, RATIO).lower.tobytes()
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=in_child, args=(queue,))
    child.start()
    assert queue.get(timeout=300) == here
    child.join(10)
    assert child.exitcode == 0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_child_that_is_forked_in_the_middle_of_a_call_says_so():
    """Nobody would ever give back what a thread of the parent held: the child is refused, and not kept waiting."""
    script = f"""{SETUP}
import multiprocessing
model = bp.Model.from_matrices(K, M, Z)
before = model.critical_step(10.0, 2.0)
stop = threading.Event()
def long():
    try:
        model.stability_map(np.logspace(-3, 12, 400), np.logspace(-1, 3, 400), tolerance=1e-12,
                            progress=lambda done, total: 1 / (not stop.is_set()))
    except ZeroDivisionError:
        pass
def child(queue):
    try:
        queue.put(model.critical_step(10.0, 2.0))
    except ValueError as error:
        queue.put(str(error))
    queue.put(bp.Model.from_matrices(K, M, Z).critical_step(10.0, 2.0))
def answers():
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    process = context.Process(target=child, args=(queue,))
    process.start()
    found = [queue.get(timeout=300) for _ in range(2)]
    process.join()
    return found
thread = threading.Thread(target=long)
thread.start()
time.sleep(0.5)
refusal, new = answers()
stop.set()
thread.join()
print("forked while" in refusal and "spawn" in refusal, new == before)
"""
    run = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", script], capture_output=True, text=True, timeout=180, check=True
    )
    assert run.stdout.split() == ["True", "True"]


def test_the_same_question_costs_the_same():
    """What is known closely enough is not sampled again: no question makes later ones slower, or changes their bits."""
    model = bp.Model.from_matrices([[1.0, -1.0], [-1.0, 1.0]], [1.0, 1.0], [0.0, 1.0])
    first = model.critical_step(10.0, 2.0)
    start = time.perf_counter()
    for _ in range(2000):
        again = model.critical_step(10.0, 2.0)
    assert again == first
    # Some 20 us each; 120 ms each when every question added 200 lines.
    assert time.perf_counter() - start < 10.0
