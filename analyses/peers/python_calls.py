"""What Python adds to the Rust call: seconds a point, and a map of 1e6 points beside the time that Rust took for it.

Bar of 200 elements (scene signorini), median and best of nine. Needs the package and numpy: `pip install .`
"""

import statistics
import time

import bipenalty as bp
import numpy as np

model = bp.Model.from_scene("signorini", elements=200)
model.critical_step(10.0, 2.0)
points = []
for _ in range(9):
    start = time.perf_counter()
    for _ in range(1000):
        model.critical_step(10.0, 2.0)
    points.append((time.perf_counter() - start) / 1000)
print(f"a point, all included      median {1e6 * statistics.median(points):6.1f} us, best {1e6 * min(points):.1f} us")

beta_s, ratio = np.logspace(-3, 12, 1000), np.logspace(-1, 3, 1000)
whole, added, arrays = [], [], []
for _ in range(9):
    start = time.perf_counter()
    found = model.stability_map(beta_s, ratio)
    end = time.perf_counter()
    found.lower, found.upper  # noqa: B018, reading makes the arrays
    arrays.append(time.perf_counter() - end)
    whole.append(end - start)
    added.append((end - start) / found.seconds - 1.0)
print(f"a map of 1e6 points        median {1e3 * statistics.median(whole):6.1f} ms, best {1e3 * min(whole):.1f} ms")
print(f"above the Rust call        median {1e2 * statistics.median(added):6.1f} %,  best {1e2 * min(added):.1f} %")
print(f"both its arrays, read once median {1e3 * statistics.median(arrays):6.1f} ms, best {1e3 * min(arrays):.1f} ms")
