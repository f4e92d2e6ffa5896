"""Plain numpy loop for analyses/step_speed.rs: central differences of a lumped uniform bar with free ends.

Usage: step_speed.py NODES STEPS REPEATS; prints the median node-steps per second.
"""
import statistics
import sys
import time

import numpy

n, steps, repeats = map(int, sys.argv[1:])
dt = 0.5
u = numpy.zeros(n)
v = 0.1 * ((numpy.arange(n) * 37) % 11 - 5.0)
rates = []
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
