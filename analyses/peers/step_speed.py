"""Loops with numpy and scipy for analyses/step_speed.rs: central differences with a lumped mass.

Usage: step_speed.py bar NODES STEPS REPEATS   a uniform bar with free ends; prints the median node-steps per second
       step_speed.py square NODES              a square of NODES x NODES nodes; prints the seconds of a step for each line
                                               of its input

The matrix of the square has entries where squares of four nodes have them, two directions each; their values are others.
"""
import statistics
import sys
import time

import numpy

dt = 0.5


def bar(n, steps, repeats):
    rates = []
    u = numpy.zeros(n)
    v = 0.1 * ((numpy.arange(n) * 37) % 11 - 5.0)
    for _ in range(repeats):
        start = time.perf_counter()
        for _ in range(steps):
            strain = u[1:] - u[:-1]
            v[0] += 2 * dt * strain[0]
            v[1:-1] += dt * (strain[1:] - strain[:-1])
            v[-1] -= 2 * dt * strain[-1]
            u += dt * v
        rates.append(n * steps / (time.perf_counter() - start))
    print(f"{statistics.median(rates):.6e}")


def square(n):
    from scipy.sparse import diags, kron

    row = diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n), format="csr")
    near = diags([1.0, 4.0, 1.0], [-1, 0, 1], shape=(n, n), format="csr")
    stiffness = kron(kron(row, near), [[2.0, 1.0], [1.0, 2.0]], format="csr")
    size = stiffness.shape[0]
    factor = numpy.full(size, 1e-2)
    u = numpy.zeros(size)
    v = 0.1 * ((numpy.arange(size) * 37) % 11 - 5.0)
    for _ in sys.stdin:
        start = time.perf_counter()
        v -= factor * (stiffness @ u)
        u += dt * v
        print(f"{time.perf_counter() - start:.6e}", flush=True)


{"bar": bar, "square": square}[sys.argv[1]](*map(int, sys.argv[2:]))
