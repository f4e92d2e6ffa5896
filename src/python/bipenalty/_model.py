"""The model: everything a stability limit depends on but the penalties."""

from __future__ import annotations

import html
import os
from typing import TYPE_CHECKING

import numpy as np

from ._bipenalty import Core
from ._progress import Progress, callback
from ._results import CriticalStep, Impact, OptimalRatio, StabilityMap, SteppedLimit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_GAMMAS = {"lumped": 1.0, "averaged": 0.5, "consistent": 0.0}


def _gamma(mass: str | float) -> float:
    if not isinstance(mass, str):
        return float(mass)
    if mass in _GAMMAS:
        return _GAMMAS[mass]
    raise ValueError(f"mass: {mass!r} is not allowed; allowed: lumped, averaged, consistent or a number gamma in [0, 1]")


def _axis(values: ArrayLike, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if array.ndim != 1:
        raise ValueError(f"{name}: an array of {array.ndim} dimensions is not allowed; allowed: a number or one dimension")
    return np.ascontiguousarray(array)


class Model:
    """A scene with its mass matrix, made by `from_scene`.

    Penalties are dimensionless: a contact of scale w (N/m) has the stiffness ``s = beta_s w`` and the mass
    ``m = s/(ratio omega_ref^2)``.
    """

    __slots__ = ("_core", "contacts", "elements", "gamma", "mass", "name", "reference", "unknowns")

    name: str
    """Name of the scene."""
    mass: str
    """``lumped``, ``averaged``, ``consistent``, or the number gamma."""
    gamma: float
    """gamma of the mass matrix, 0 consistent to 1 lumped."""
    elements: int
    """Elements of all bars."""
    unknowns: int
    """Unknowns n."""
    contacts: int
    """Contacts k."""
    reference: float
    """omega_ref^2, rad^2/s^2, in which the ratio is measured."""

    def __init__(self) -> None:
        raise TypeError("a model is made by Model.from_scene")

    @classmethod
    def _of(cls, core: Core, gamma: float) -> Model:
        model = object.__new__(cls)
        model._core, model.gamma = core, gamma
        model.name, model.mass, model.elements, model.unknowns, model.contacts, model.reference = core.facts()
        return model

    @classmethod
    def from_scene(
        cls,
        scene: str | os.PathLike[str],
        *,
        mass: str | float = "lumped",
        elements: int | None = None,
        penalty_mass: str = "consistent",
    ) -> Model:
        """Read a scene.

        Parameters
        ----------
        scene
            A built-in name (``"signorini"``, ``"symmetric"``, ``"hunek"``, ``"bouncing-bar"``), the path of a TOML
            file, or the text of one.
        mass
            ``"lumped"``, ``"averaged"``, ``"consistent"``, or gamma in [0, 1].
        elements
            Elements of the first bar; the other bars keep their proportion.
        penalty_mass
            ``"consistent"``, or ``"diagonalised"``: the row sums of the mass penalty.
        """
        if penalty_mass not in ("consistent", "diagonalised"):
            raise ValueError(f"penalty_mass: {penalty_mass!r} is not allowed; allowed: consistent, diagonalised")
        gamma = _gamma(mass)
        core = Core.from_scene(os.fspath(scene), gamma, elements, penalty_mass == "diagonalised")
        return cls._of(core, gamma)

    def critical_step(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        engine: str = "auto",
    ) -> CriticalStep:
        """Enclose the critical time step at one point, with every contact closed.

        Parameters
        ----------
        beta_s
            Stiffness penalty, at least 0.
        ratio
            Penalty ratio r > 0; infinite (the default) is the pure penalty method.
        limit
            ``"spectrum"`` (2/omega_max, the limit of central differences), ``"central-difference"``,
            ``"predictor-corrector"`` or ``"park"``.
        theta
            Averaging of the Park scheme, 0.5 by default.
        engine
            What finds the eigenvalue: ``"auto"``, ``"closed-form"``, ``"secular"``, ``"sturm"`` or ``"dense"``.

        Raises
        ------
        ValueError
            What is not allowed, with what is.
        Uncertified
            The limit could not be enclosed closely enough.
        """
        step, courant, omega, evidence, by = self._core.critical_step(beta_s, ratio, limit, theta, engine)
        return CriticalStep(*step, *courant, omega, evidence, by, beta_s, ratio, limit)

    def stability_map(
        self,
        beta_s: ArrayLike,
        ratio: ArrayLike = np.inf,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        engine: str = "auto",
        progress: Progress = False,
    ) -> StabilityMap:
        """Enclose the critical time step over stiffness penalties and ratios.

        Parameters
        ----------
        beta_s
            [b] stiffness penalties, in any order.
        ratio
            [r] penalty ratios, in any order.
        limit, theta, engine
            As in `critical_step`.
        progress
            True for a line on standard error, or a function that is told the points done and all points.

        Returns
        -------
        StabilityMap
            Arrays of the shape [r, b].
        """
        stiffness, ratios = _axis(beta_s, "beta_s"), _axis(ratio, "ratio")
        found = self._core.map(stiffness, ratios, limit, theta, engine, callback(progress))
        return StabilityMap(self, stiffness, ratios, limit, theta, found)

    def optimal_ratio(self, beta_s: float, *, limit: str = "spectrum", theta: float | None = None) -> OptimalRatio:
        """Find the largest ratio that costs no time step against the model without contact, at one beta_s."""
        found = self._core.optimal_ratio(beta_s, limit, theta) or [np.inf] * 3
        return OptimalRatio(*found, beta_s, limit)

    def verify(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        scheme: str = "central-difference",
        theta: float | None = None,
        tolerance: float = 1e-3,
    ) -> SteppedLimit:
        """Find the limit of a scheme by stepping alone, contacts held closed.

        `tolerance` is the relative distance of the stable from the unstable step, in [1e-12, 0.1]; the number of steps
        grows with its inverse, or the root of it for central differences.
        """
        seconds, _, steps, growth, agrees = self._core.verify(beta_s, ratio, scheme, theta, tolerance)
        predicted, stable, unstable = seconds
        return SteppedLimit(stable, unstable, predicted, agrees, growth, steps, scheme, beta_s, ratio)

    def impact(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        scheme: str = "predictor-corrector",
        relative_courant: float = 0.5,
        duration: float | None = None,
        theta: float | None = None,
        every: int = 1,
        progress: Progress = False,
    ) -> Impact:
        """Step the scene through its impact: contacts open and close.

        Parameters
        ----------
        beta_s, ratio
            The penalties.
        scheme
            ``"central-difference"``, ``"predictor-corrector"`` or ``"park"``.
        relative_courant
            dt over the critical step of the scene without contact.
        duration
            s; that of the scene by default.
        theta
            Averaging of the Park scheme, 0.5 by default.
        every
            A row of the history every so many steps.
        progress
            As in `stability_map`, in steps.
        """
        told = callback(progress)
        found = self._core.impact(scheme, theta, beta_s, ratio, relative_courant, duration, every, told)
        return Impact(**found, scheme=scheme, beta_s=beta_s, ratio=ratio)

    def _contour(
        self,
        courant: float,
        beta_s: tuple[float, float],
        ratio: tuple[float, float],
        limit: str,
        theta: float | None,
    ) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """Points (beta_s, r), [n, 2], where C_r takes a value."""
        return self._core.contour(courant, beta_s, ratio, limit, theta)

    def _facts(self) -> list[tuple[str, str]]:
        return [
            ("mass", self.mass),
            ("elements", str(self.elements)),
            ("unknowns", str(self.unknowns)),
            ("contacts", str(self.contacts)),
            ("omega_ref, rad/s", f"{self.reference**0.5:.7g}"),
        ]

    def __repr__(self) -> str:
        """Say what it is."""
        return f"<bipenalty.Model {self.name}: {', '.join(f'{value} {name}' if name in ('elements', 'unknowns', 'contacts') else f'{name} {value}' for name, value in self._facts())}>"

    def _repr_html_(self) -> str:
        cells = (f"<tr><th>{html.escape(n)}</th><td>{html.escape(v)}</td></tr>" for n, v in self._facts())
        return f"<table><caption>{html.escape(self.name)}</caption>{''.join(cells)}</table>"
