"""Which time step is stable in explicit contact dynamics, and what the contact penalty does to it.

Contact by a stiffness penalty ``s z z'`` may lower the critical time step of explicit dynamics without warning; a mass
penalty ``m z z'`` beside it gives the step back. This package encloses the limit between two numbers, finds the ratio
of the two penalties that costs nothing, and the largest penalty that a given step allows:

>>> import bipenalty as bp
>>> model = bp.Model.from_scene("signorini", mass="lumped", elements=200)
>>> model.critical_step(beta_s=10.0, ratio=2.0).courant
0.7891948863055671

What is refused raises ``ValueError`` with the place, the value and what is allowed; `Uncertified` is raised where no
enclosure is as narrow as was asked for. Long calls let other threads run and end on Ctrl-C. They use all cores, or as
many as the environment variable ``RAYON_NUM_THREADS`` says when the first of them is made; no result depends on it.
"""

from ._asked import Damping
from ._bipenalty import Uncertified, __version__
from ._model import Model
from ._results import ContactShare, CriticalStep, Governing, Impact, Largest, OptimalRatio, StabilityMap, SteppedLimit

__all__ = [
    "ContactShare",
    "CriticalStep",
    "Damping",
    "Governing",
    "Impact",
    "Largest",
    "Model",
    "OptimalRatio",
    "StabilityMap",
    "SteppedLimit",
    "Uncertified",
    "__version__",
]
