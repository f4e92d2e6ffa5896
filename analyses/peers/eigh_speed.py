"""Largest eigenvalue of the penalised bar with numpy and scipy: seconds a point, one line a method.

Signorini bar of n unit elements, consistent mass, wall on the right (node n), beta_s = 10, r = 2. Only the solver is
timed, one thread; the matrices are ready. Prints `method|seconds|l_max`.
"""
import statistics
import sys
import time

import numpy as np
from scipy.linalg import eig_banded, eigh
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh

n, beta_s, ratio = int(sys.argv[1]), 10.0, 2.0

k = np.diag(np.full(n + 1, 2.0)) - np.eye(n + 1, k=1) - np.eye(n + 1, k=-1)
m = (4.0 * np.eye(n + 1) + np.eye(n + 1, k=1) + np.eye(n + 1, k=-1)) / 6.0
for end in (0, n):
    k[end, end], m[end, end] = 1.0, 1.0 / 3.0
k[n, n] += beta_s
m[n, n] += beta_s / (12.0 * ratio)

# eig_banded knows no mass matrix: M^-1/2 would be full, so it gets the lumped bar, an easier problem.
lumped = np.ones(n + 1)
lumped[[0, n]] = 0.5, 0.5 + beta_s / (4.0 * ratio)
scale = 1.0 / np.sqrt(lumped)
band = np.zeros((2, n + 1))
band[0] = np.diag(k) * scale**2
band[1, :-1] = np.diag(k, -1) * scale[1:] * scale[:-1]

sparse_k, sparse_m = csc_matrix(k), csc_matrix(m)
methods = {
    "scipy eigh, largest only": lambda: eigh(k, m, eigvals_only=True, subset_by_index=[n, n])[-1],
    "scipy eigh, all": lambda: eigh(k, m, eigvals_only=True)[-1],
    "scipy eig_banded, largest only, lumped": lambda: eig_banded(
        band, lower=True, eigvals_only=True, select="i", select_range=(n, n)
    )[-1],
    "scipy eigsh, largest": lambda: eigsh(sparse_k, 1, sparse_m, which="LA", return_eigenvectors=False)[0],
}
for name, solve in methods.items():
    value, times, begun = solve(), [], time.perf_counter()
    while len(times) < 5 or (time.perf_counter() - begun < 0.7 and len(times) < 500):
        start = time.perf_counter()
        solve()
        times.append(time.perf_counter() - start)
    print(f"{name}|{statistics.median(times)}|{float(value)!r}")
