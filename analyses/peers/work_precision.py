"""The problems of `work-precision` with numpy and scipy: error against run time, one CSV row a measurement.

    python3 -m venv peers && peers/bin/pip install scipy
    peers/bin/python work_precision.py < ../../tests/data/work_precision.csv        (--quick for a part of it)

`work-precision --peers peers/bin/python` runs it and joins the rows. The matrices and the time stepping are written anew
here, from the textbook; only the exact eigenvalues are shared, on standard input. Error and time are those of
`work-precision`: the relative error of the critical step (> 0: too large, unsafe) or the rms distance from the exact
impact, and the smallest time of repeated runs on one thread, the matrices ready.
"""

import argparse
import os
import signal
import sys
import time
import warnings

for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
from scipy.linalg import eig_banded, eigh
from scipy.sparse import diags
from scipy.sparse.linalg import eigsh

warnings.simplefilter("ignore")


# ---- time --------------------------------------------------------------------------------------------------------


def smallest(run, budget):
    """The smallest time of at least 3 runs and of more for `budget` s, after one that does not count."""
    times, begun = [], time.perf_counter()
    while len(times) < 3 or (time.perf_counter() - begun < budget and len(times) < 1000):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def row(family, problem, method, size, error, seconds, evaluations="", status="done"):
    print(f"{family},{problem},{method},{size},{error},{seconds},{evaluations},{status}", flush=True)


# ---- largest eigenvalue ------------------------------------------------------------------------------------------


class Pencil:
    """Diagonals and off-diagonals of K and M with the contact summed in."""

    def __init__(self, elements, contact, fixed=False):
        """`elements`: bars, each an array of (k, a, b); `contact`: (nodes, s, m)."""
        nodes = sum(len(bar) + 1 for bar in elements)
        self.kd, self.ko = np.zeros(nodes), np.zeros(nodes - 1)
        self.md, self.mo = np.zeros(nodes), np.zeros(nodes - 1)
        first = 0
        for k, a, b in (bar.T for bar in elements):
            left, right = slice(first, first + len(k)), slice(first + 1, first + len(k) + 1)
            for d, x in ((self.kd, k), (self.md, a)):
                d[left] += x
                d[right] += x
            self.ko[left], self.mo[left] = -k, b
            first += len(k) + 1
        at, s, m = contact
        self.kd[at] += s
        self.md[at] += m
        if len(at) == 2:
            self.ko[at[0]] -= s
            self.mo[at[0]] -= m
        if fixed:
            self.kd, self.ko, self.md, self.mo = self.kd[:-1], self.ko[:-1], self.md[:-1], self.mo[:-1]

    def full(self):
        return [np.diag(d) + np.diag(o, 1) + np.diag(o, -1) for d, o in ((self.kd, self.ko), (self.md, self.mo))]

    def sparse(self):
        return [diags([o, d, o], [-1, 0, 1], format="csc") for d, o in ((self.kd, self.ko), (self.md, self.mo))]


def uniform(n, gamma, modulus=1.0, area=1.0):
    return np.tile([modulus * area, (2 + gamma) * area / 6, (1 - gamma) * area / 6], (n, 1))


def pencil(problem, n):
    if problem == "wall-consistent":
        return Pencil([uniform(n, 0.0)], ([n], 10.0, 10.0 / 24.0))
    if problem == "stiff-lumped":
        return Pencil([uniform(n, 1.0)], ([n], 1e8, 0.0))
    if problem == "unequal-lumped":
        bars = [uniform(n // 2, 1.0), uniform(n // 2, 1.0, 2.0, 3.0)]
        return Pencil(bars, ([n // 2, n // 2 + 1], 1e4, 1e4 / 8.0), fixed=True)
    state, drawn = 189, []
    for _ in range(2 * n):
        state = (6364136223846793005 * state + 1442695040888963407) % 2**64
        drawn.append((64 + (state >> 58)) / 64)
    k, d = np.array(drawn[::2]), np.array(drawn[1::2])
    return Pencil([np.stack([k, 2 * d, d], axis=1)], ([n], 16.0, 16.0))


def with_eigh(p):
    k, m = p.full()
    top = len(p.kd) - 1
    return lambda: eigh(k, m, eigvals_only=True, subset_by_index=[top, top])[0]


def with_eig_banded(p):
    if np.any(p.mo):
        raise ValueError("no mass matrix")
    scale = 1 / np.sqrt(p.md)
    band = np.zeros((2, len(p.kd)))
    band[0] = p.kd * scale**2
    band[1, :-1] = p.ko * scale[1:] * scale[:-1]
    top = len(p.kd) - 1
    return lambda: eig_banded(band, lower=True, eigvals_only=True, select="i", select_range=(top, top))[0]


def with_eigsh(p):
    k, m = p.sparse()
    start = np.random.default_rng(189).standard_normal(len(p.kd))
    return lambda: eigsh(k, 1, m, which="LA", return_eigenvectors=False, v0=start)[0]


# With the order in which the cost grows.
EIGENSOLVERS = [
    ("scipy eigh", with_eigh, 3),
    ("scipy eig_banded", with_eig_banded, 2),
    ("scipy eigsh", with_eigsh, 1),
]


def stop(*_):
    raise TimeoutError


def eigenvalues(exact, limit, budget):
    # ARPACK comes back to Python in every iteration, where the signal arrives.
    signal.signal(signal.SIGALRM, stop)
    last = {}
    for problem, n, nearest, rest in exact:
        p = pencil(problem, n)
        for method, prepare, order in EIGENSOLVERS:
            before, seconds = last.get((problem, method), (n, 0.0))
            expected = seconds * (n / before) ** order
            if expected > limit:
                status = f"timed out: about {expected:.0e} s; more than {limit:g} s"
                row("eigenvalue", problem, method, n, "", "", "", status)
                continue
            try:
                solve = prepare(p)
                # The first run may take far longer than a smaller size lets expect, where the iterations grow too.
                signal.setitimer(signal.ITIMER_REAL, limit)
                l = float(solve())
                signal.setitimer(signal.ITIMER_REAL, 0)
                seconds = smallest(solve, budget)
            except TimeoutError:
                last[problem, method] = (n, 2 * limit)
                row("eigenvalue", problem, method, n, "", "", "", f"timed out: more than {limit:g} s")
                continue
            except Exception as failure:  # whatever a solver raises is what its user would see
                signal.setitimer(signal.ITIMER_REAL, 0)
                text = " ".join(str(failure).replace(",", ";").split())[:120]
                row("eigenvalue", problem, method, n, "", "", "", f"failed: {text}")
                continue
            last[problem, method] = (n, seconds)
            e = ((l - nearest) - rest) / nearest
            root = (1 + e) ** 0.5
            row("eigenvalue", problem, method, n, -e / (root * (1 + root)), seconds)


# ---- the Signorini impact ----------------------------------------------------------------------------------------

LENGTH, MODULUS, DENSITY, VELOCITY, DURATION = 10.0, 100.0, 0.01, 0.1, 0.3
SPEED = (MODULUS / DENSITY) ** 0.5
FORCE = DENSITY * SPEED * VELOCITY
LEAVES = 2 * LENGTH / SPEED
BETA_S = 1e4
NEAR = 1e-12


class Bar:
    """n lumped elements, r = 1, at C times the critical step h/c."""

    def __init__(self, n, courant):
        self.h = LENGTH / n
        self.k = MODULUS / self.h
        self.mass = np.full(n + 1, DENSITY * self.h)
        self.mass[[0, -1]] /= 2
        self.s = BETA_S * self.k
        self.m = self.s / (4 * (SPEED / self.h) ** 2)
        self.dt = courant * self.h / SPEED
        self.steps = int(np.ceil(DURATION / self.dt * (1 - 8 * np.finfo(float).eps)))
        self.u, self.v = np.zeros(n + 1), np.full(n + 1, VELOCITY)

    def internal(self):
        tension = self.k * np.diff(self.u)
        f = np.zeros_like(self.u)
        f[:-1] += tension
        f[1:] -= tension
        return f

    def central_difference(self):
        """Yields the contact force at every step; u and v are advanced in place."""

        def acceleration():
            f, gap = self.internal(), self.u[-1]
            a = f / self.mass
            if gap <= 0:
                return a, 0.0
            ratio = self.m / self.mass[-1]
            force = (self.s * gap + ratio * f[-1]) / (1 + ratio)
            a[-1] -= force / self.mass[-1]
            return a, force

        a, force = acceleration()
        self.v -= self.dt / 2 * a
        yield force
        for _ in range(self.steps):
            self.v += self.dt * a
            self.u += self.dt * self.v
            a, force = acceleration()
            yield force

    def predictor_corrector(self):
        ratio = self.m / self.mass[-1]
        yield 0.0
        for _ in range(self.steps):
            a = self.internal() / self.mass
            gap = self.u[-1] + self.dt * (self.v[-1] + self.dt * a[-1])
            force = self.s * max(gap, 0.0) / (1 + ratio)
            a[-1] -= force / self.mass[-1]
            self.v += self.dt * a
            self.u += self.dt * self.v
            yield force


def exact_stress(x, t):
    front = LENGTH - SPEED * t
    loaded = x >= front - NEAR if t <= LENGTH / SPEED else x > -front + NEAR
    return np.where(loaded & (t < LEAVES), -FORCE, 0.0)


def impact_errors(n, courant, scheme, late):
    """rms errors of force, stress and gap in the units of work-precision; `late`: the force belongs to the step that begins."""
    bar = Bar(n, courant)
    x = (np.arange(n) + 0.5) * bar.h
    wanted = [round(DURATION * k / 10 / bar.dt) for k in range(1, 11)]
    force_errors, gap_errors, stress_errors = [], [], []
    for step, force in enumerate(getattr(bar, scheme)()):
        t = step * bar.dt
        loaded = t < LEAVES - NEAR if late else NEAR < t <= LEAVES + NEAR
        force_errors.append(force - (FORCE if loaded else 0.0))
        gap_errors.append(bar.u[-1] + VELOCITY * max(t - LEAVES, 0.0))
        if step in wanted:
            stress = MODULUS * np.diff(bar.u) / bar.h
            stress_errors.append(stress - exact_stress(x, t))

    def rms(values, scale):
        return float(np.sqrt(np.mean(np.square(values)))) / scale

    return {
        "force": rms(force_errors, FORCE),
        "stress": rms(np.concatenate(stress_errors), FORCE),
        "gap": rms(gap_errors, FORCE * LENGTH / MODULUS),
    }


def impacts(sizes, courants, limit, budget):
    for n in sizes:
        for courant in courants:
            for scheme, late in (("central_difference", True), ("predictor_corrector", False)):
                method = f"numpy {scheme.replace('_', '-')} C={courant:g}"

                def run():
                    for _ in getattr(Bar(n, courant), scheme)():
                        pass

                errors = impact_errors(n, courant, scheme, late)
                stable = max(errors.values()) < 1e3
                seconds = smallest(run, budget) if stable else ""
                for quantity, error in errors.items():
                    outcome = (error, seconds, Bar(n, courant).steps) if stable else ("", "", "", "failed: blew up")
                    row("stepping", f"signorini-lumped-{quantity}", method, n, *outcome)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    lines = [line.split(",") for line in sys.stdin.read().splitlines()[1:]]
    exact = [(p, int(n), float(nearest), float(rest)) for p, n, nearest, rest in lines if not quick or int(n) <= 1000]
    limit, budget = (0.1, 0.01) if quick else (3.0, 0.06)
    print("family,problem,method,size,error,seconds,evaluations,status")
    eigenvalues(exact, limit, budget)
    impacts([25, 50, 100] if quick else [25, 50, 100, 200, 400], [0.5] if quick else [0.25, 0.5, 0.9], limit, budget)


main()
