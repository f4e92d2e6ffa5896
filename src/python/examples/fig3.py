"""Fig. 3 of the paper: the critical Courant number over the stiffness penalty, a bar on a wall and two bars."""

import bipenalty as bp
import matplotlib.pyplot as plt
import numpy as np

figure, axes = plt.subplots(1, 2, figsize=(7.5, 2.5), layout="constrained")
for scene, ax in zip(["signorini", "symmetric"], axes, strict=True):
    model = bp.Model.from_scene(scene, mass="lumped", elements=1)
    found = model.stability_map(np.linspace(0, 10, 401), [0.5, 1, 2, 3, np.inf])
    found.plot(ax)
    print(found)
figure.savefig("fig3.png", dpi=300)
