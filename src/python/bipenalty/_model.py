"""The model: everything a stability limit depends on but the penalties."""

from __future__ import annotations

import html
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _matrices
from ._asked import Damping, asked, count, scheme_asked
from ._bipenalty import Core, limit_name
from ._progress import Progress, callback
from ._results import ContactShare, CriticalStep, Governing, Impact, Largest, OptimalRatio, StabilityMap, SteppedLimit

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike, NDArray

    from ._asked import Asked
    from ._matrices import Sparse

_GAMMAS = {"lumped": 1.0, "averaged": 0.5, "consistent": 0.0}


def _gamma(mass: str | float) -> float:
    if not isinstance(mass, str):
        return float(mass)
    if mass in _GAMMAS:
        return _GAMMAS[mass]
    raise ValueError(
        f"mass: {mass!r} is not allowed; allowed: lumped, averaged, consistent or a number gamma in [0, 1]"
    )


def _axis(values: ArrayLike, name: str) -> NDArray[np.float64]:
    array = np.atleast_1d(_matrices.floats(values, name))
    if array.ndim != 1:
        raise ValueError(f"{name}: {array.ndim} dimensions are not allowed; allowed: a number, or one dimension")
    return array


def _of_scene(scene: str, mass: str | float | None, elements: int | None, penalty_mass: str) -> Model:
    return Model.from_scene(scene, mass=mass, elements=elements, penalty_mass=penalty_mass)


def _of_rows(stiffness: Any, mass: Any, gaps: Any, weights: NDArray[np.float64], reference: float | None) -> Model:
    """Make a model of what `Core.matrices` has given."""
    rows = [_matrices.rows_given(parts) for parts in (stiffness, mass, _matrices.transposed(gaps))]
    return Model._of(Core.from_matrices(rows[0], rows[1], rows[2], weights, reference), reference)


def _named(limit: str, what: Asked) -> str:
    """Return the name of a limit in records, which damping changes."""
    return limit_name(what) if any(what[3]) else limit


class Model:
    """Bars, matrices or a mesh in contact: everything a stability limit depends on but the penalties.

    Made by `from_scene` or `from_matrices`. Penalties are dimensionless: a contact of scale w (N/m) has the stiffness
    ``s = beta_s w`` and the mass ``m = s/(ratio omega_ref^2)``.
    """

    __slots__ = ("_core", "_made", "contacts", "elements", "gamma", "mass", "name", "unknowns")

    name: str
    """Name of the scene; ``matrices`` where there is none."""
    mass: str | None
    """``lumped``, ``averaged``, ``consistent``, or the number gamma; None where matrices bring their own."""
    gamma: float | None
    """gamma of the mass matrix, 0 consistent to 1 lumped."""
    elements: int | None
    """Elements of all bars or bodies, where they are known."""
    unknowns: int
    """Unknowns n."""
    contacts: int
    """Contacts k."""
    _core: Core
    _made: tuple[Any, ...]
    """What a scene was made with, or the reference that was given with matrices."""

    def __init__(self) -> None:
        raise TypeError("a model is made by Model.from_scene or Model.from_matrices")

    @classmethod
    def _of(cls, core: Core, *made: Any) -> Model:
        model = object.__new__(cls)
        name, mass, elements, unknowns, contacts = core.facts()
        kind, gamma = mass or (None, None)
        facts = (core, made, contacts, elements, gamma, kind, name, unknowns)
        for slot, value in zip(cls.__slots__, facts, strict=True):
            object.__setattr__(model, slot, value)
        return model

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name} cannot be set: a model stays as it is")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{name} cannot be deleted: a model stays as it is")

    def __copy__(self) -> Model:
        return self

    def __deepcopy__(self, memo: object) -> Model:
        return self

    def __reduce__(self) -> tuple[Callable[..., Model], tuple[Any, ...]]:
        """Say what to pickle: how the scene was made, which is read again, or the matrices."""
        if len(self._made) > 1:
            return _of_scene, self._made
        stiffness, mass, gaps, weights = self._core.matrices()
        return _of_rows, (stiffness, mass, gaps, weights, *self._made)

    @classmethod
    def from_scene(
        cls,
        scene: str | os.PathLike[str],
        *,
        mass: str | float | None = None,
        elements: int | None = None,
        penalty_mass: str = "consistent",
    ) -> Model:
        """Read a scene of bars, matrices or meshes.

        Parameters
        ----------
        scene
            A built-in name (``"signorini"``, ``"symmetric"``, ``"hunek"``, ``"bouncing-bar"``), the path of a TOML
            file, or the text of one (which has more than one line).
        mass
            ``"lumped"`` (the default of bars and meshes), ``"averaged"``, ``"consistent"``, or gamma in [0, 1].
        elements
            Elements of the first bar; the other bars keep their proportion.
        penalty_mass
            ``"consistent"``, or ``"diagonalised"``: the row sums of the mass penalty (bars only).

        Raises
        ------
        ValueError
            What is not allowed, with its line and what is.
        """
        if penalty_mass not in ("consistent", "diagonalised"):
            raise ValueError(f"penalty_mass: {penalty_mass!r} is not allowed; allowed: consistent, diagonalised")
        path = os.fspath(scene)
        name, text = ("scene", path) if "\n" in path else (path, None)
        gamma = None if mass is None else _gamma(mass)
        number = count(elements, "elements")
        core = Core.from_scene(name, text, gamma, number, penalty_mass == "diagonalised")
        # Another process may be elsewhere.
        there = path if text is not None or not Path(path).is_file() else str(Path(path).resolve())
        return cls._of(core, there, mass, number, penalty_mass)

    @classmethod
    def from_matrices(
        cls,
        K: ArrayLike | Sparse,
        M: ArrayLike | Sparse,
        Z: ArrayLike | Sparse,
        *,
        scales: ArrayLike | None = None,
        reference: float | str = "mesh",
    ) -> Model:
        """Take the matrices of any linear mesh: dense arrays, or scipy.sparse in any format.

        CSR and CSC with float64 values and int32 indices, sorted and without duplicates, are not copied (int64 indices
        are): the model reads the arrays of the caller, who must not change them while it lives. A model whose arrays
        were changed refuses to answer. Matrices that are symmetric to rounding only are made symmetric, in a copy.

        Parameters
        ----------
        K
            Stiffness, n x n, symmetric, N/m.
        M
            Mass, n x n, symmetric and positive definite, kg; or the diagonal of a lumped one, [n].
        Z
            Gaps, n x k, a column a contact: the gap is ``Z' u``, positive in penetration. [n] is one contact.
        scales
            [k], N/m, what beta_s multiplies; by default ``z_b' K z_b/(z_b' z_b)^2``, the smallest over the bodies that
            a gap is on. A number is that of all contacts.
        reference
            omega_ref^2, rad^2/s^2, in which the ratio is measured; ``"mesh"`` is the largest eigenvalue of (K, M).

        Raises
        ------
        ValueError
            What is not allowed, with its place and what is.
        """
        stiffness, mass, gaps = _matrices.symmetric(K, "stiffness"), _matrices.mass(M), _matrices.gaps(Z)
        if isinstance(reference, str):
            if reference != "mesh":
                raise ValueError(f'reference: {reference!r} is not allowed; allowed: "mesh", or a number (rad^2/s^2)')
            omega = None
        else:
            omega = float(reference)
        weights = _matrices.scales(scales, gaps[0][0])
        return cls._of(Core.from_matrices(stiffness, mass, gaps, weights, omega), omega)

    @property
    def reference(self) -> float:
        """omega_ref^2, rad^2/s^2, in which the ratio is measured; of meshes found when it is first asked for."""
        return self._core.reference()

    def matrices(self) -> tuple[Any, Any, Any, NDArray[np.float64]]:
        """Return copies of K (N/m), M (kg), Z as ``scipy.sparse.csr_matrix``, without contact, and w [k] (N/m)."""
        stiffness, mass, gaps, weights = self._core.matrices()
        return _matrices.rows_of(stiffness), _matrices.rows_of(mass), _matrices.rows_of(gaps), weights

    def critical_step(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        parameter: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        engine: str = "auto",
        tolerance: float | None = None,
        patch: int | None = None,
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
            ``"predictor-corrector"`` or ``"park"``; or an explicit scheme with the contact in its internal force, whose
            limit is a multiple of that of the spectrum: ``"noh-bathe"`` (two forces a step), ``"chung-lee"``,
            ``"tchamwa-wielgosz"`` or ``"generalised-alpha"``.
        theta
            Averaging of the Park scheme, 0.5 by default.
        parameter
            p of noh-bathe, beta of chung-lee, phi of tchamwa-wielgosz, rho of generalised-alpha; else as published.
        damping
            ``Damping(mass, stiffness, contact)``: C = A M + B K + c K_p, of the spectrum, central differences and the
            predictor-corrector; A in 1/s, B and c in s. None by default.
        engine
            What finds the eigenvalue of bars: ``"auto"``, ``"closed-form"``, ``"secular"``, ``"sturm"``, ``"dense"``.
        tolerance
            Widest enclosure of the step of matrices and meshes, relative; 1e-9 by default. Bars: 1e-13 always.
        patch
            Elements along an edge of the patches that prove the bound of a mesh; by default the whole matrix is
            factorised where that fits into memory, and patches are chosen where it does not.

        Raises
        ------
        ValueError
            What is not allowed, with what is.
        Uncertified
            The limit could not be enclosed as closely.
        """
        what = asked(limit, theta, parameter, damping, engine, tolerance, patch)
        (dt, low, high), (c, c_low, c_high), omega, evidence, by = self._core.critical_step(beta_s, ratio, what)
        return CriticalStep(dt, low, high, c, c_low, c_high, omega, evidence, by, beta_s, ratio, _named(limit, what))

    def stability_map(
        self,
        beta_s: ArrayLike,
        ratio: ArrayLike = np.inf,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        parameter: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        engine: str = "auto",
        tolerance: float | None = None,
        patch: int | None = None,
        progress: Progress = False,
    ) -> StabilityMap:
        """Enclose the critical time step over stiffness penalties and ratios.

        Parameters
        ----------
        beta_s
            [b] stiffness penalties, in any order.
        ratio
            [r] penalty ratios, in any order.
        limit, theta, parameter, damping, engine, tolerance, patch
            As in `critical_step`; the tolerance is 1e-3 for more than 64 points by default.
        progress
            True for a line on standard error, or a function that is told the points done and all points.

        Returns
        -------
        StabilityMap
            Arrays of the shape [r, b]; NaN where the limit could not be enclosed as closely.
        """
        stiffness, ratios = _axis(beta_s, "beta_s"), _axis(ratio, "ratio")
        what = asked(limit, theta, parameter, damping, engine, tolerance, patch)
        found = self._core.map(stiffness, ratios, what, callback(progress))
        return StabilityMap(self, stiffness, ratios, _named(limit, what), what, found)

    def optimal_ratio(
        self,
        beta_s: float,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        parameter: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        tolerance: float | None = None,
        patch: int | None = None,
    ) -> OptimalRatio:
        """Find the largest ratio that costs no time step against the model without contact, at one beta_s."""
        what = asked(limit, theta, parameter, damping, "auto", tolerance, patch)
        found = self._core.optimal_ratio(beta_s, what)
        value, lower, upper = found or [np.inf] * 3
        return OptimalRatio(value, lower, upper, beta_s, _named(limit, what))

    def largest_penalty(
        self,
        time_step: float,
        ratio: float = np.inf,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        parameter: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        tolerance: float | None = None,
        patch: int | None = None,
    ) -> Largest:
        """Find the largest beta_s whose limit is not below `time_step` (s), with this ratio.

        Returns a number with `lower` and `upper`; infinite where any beta_s will do.

        Raises
        ------
        ValueError
            The step is beyond the limit without contact already.
        """
        what = asked(limit, theta, parameter, damping, "auto", tolerance, patch)
        return self._largest(self._core.largest_penalty, time_step, ratio, what)

    def largest_ratio(
        self,
        time_step: float,
        beta_s: float,
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        parameter: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        tolerance: float | None = None,
        patch: int | None = None,
    ) -> Largest:
        """Find the largest ratio whose limit is not below `time_step` (s), with this beta_s; as `largest_penalty`."""
        what = asked(limit, theta, parameter, damping, "auto", tolerance, patch)
        return self._largest(self._core.largest_ratio, time_step, beta_s, what)

    def _largest(
        self,
        find: Callable[[float, float, Asked], list[float] | None],
        time_step: float,
        other: float,
        what: Asked,
    ) -> Largest:
        found = find(time_step, other, what)
        if found is None:
            free = self._core.critical_step(0.0, np.inf, what)[0][0]
            raise ValueError(
                f"time_step: {time_step!r} is not allowed; allowed: at most {free!r} s, the limit without contact"
            )
        return Largest(*found)

    def governs(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        tolerance: float | None = None,
        patch: int | None = None,
    ) -> Governing:
        """Find who governs the step of the spectrum at one point: contacts, bodies, elements, and the mode."""
        energy, contacts, bodies, elements, mode = self._core.governs(
            beta_s, ratio, asked("spectrum", None, None, None, "auto", tolerance, patch)
        )
        named = [ContactShare(*contact) for contact in contacts]
        return Governing(energy, named, dict(bodies), dict(elements), mode, beta_s, ratio)

    def verify(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        scheme: str = "central-difference",
        theta: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        tolerance: float | None = None,
    ) -> SteppedLimit:
        """Find the limit of a scheme by stepping alone, contacts held closed.

        `tolerance` is the relative distance of the stable from the unstable step, in [1e-12, 0.1]; the number of steps
        grows with its inverse, or the root of that for central differences. By default it is 1e-4, and 1e-6 for
        undamped central differences. `scheme`, `theta` and `damping` as in `impact`.
        """
        stepping, what = scheme_asked(scheme, theta, damping), asked(scheme, theta, None, damping, tolerance=tolerance)
        seconds, steps, growth, agrees = self._core.verify(beta_s, ratio, stepping, what)
        predicted, stable, unstable = seconds
        by = _named(scheme, what)
        return SteppedLimit(stable, unstable, predicted, agrees, growth, steps, by, beta_s, ratio)

    def impact(
        self,
        beta_s: float,
        ratio: float = np.inf,
        *,
        scheme: str = "predictor-corrector",
        relative_courant: float = 0.5,
        duration: float | None = None,
        theta: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        velocity: ArrayLike | None = None,
        load: ArrayLike | None = None,
        gaps: ArrayLike | None = None,
        every: int = 1,
        progress: Progress = False,
    ) -> Impact:
        """Step bars, a mesh or matrices through an impact: contacts open and close.

        Scenes of bars and meshes with ``[impact]`` bring velocities, gravity, gaps and duration; for matrices, and
        for a mesh that should move otherwise, give them here.

        Parameters
        ----------
        beta_s, ratio
            The penalties.
        scheme
            ``"central-difference"``, ``"predictor-corrector"`` or ``"park"``; ``"buffered"``, ``"lagrange"``,
            ``"moreau-jean"``, ``"paoli-schatzman"`` or ``"mass-redistribution"``.
        relative_courant
            dt over the critical step without contact.
        duration
            s; that of the scene by default.
        theta
            Averaging of the Park scheme, 0.5 by default.
        damping
            ``Damping(mass, stiffness, contact)`` of central differences and the predictor-corrector.
        velocity
            [n], m/s, of the unknowns at the start. A number is that of all.
        load
            [n], N, constant forces on the unknowns.
        gaps
            [k], m, of the contacts at the start, negative where open; 0 for matrices by default.
        every
            A row of the history every so many steps.
        progress
            As in `stability_map`, in steps.

        Raises
        ------
        ValueError
            What is not allowed, with what is: velocities of bars, a missing duration.
        """
        told = callback(progress)
        start = (
            _matrices.vector(velocity, "velocity", self.unknowns),
            _matrices.vector(load, "load", self.unknowns),
            _matrices.vector(gaps, "gaps", self.contacts),
        )
        pace = (beta_s, ratio, relative_courant, duration, count(every, "every") or 0)
        found = self._core.impact(scheme_asked(scheme, theta, damping), pace, start, told)
        return Impact(**found, scheme=scheme, beta_s=beta_s, ratio=ratio)

    def contour(
        self,
        courant: float,
        beta_s: tuple[float, float],
        ratio: tuple[float, float],
        *,
        limit: str = "spectrum",
        theta: float | None = None,
        parameter: float | None = None,
        damping: Damping | Iterable[float] | None = None,
        tolerance: float | None = None,
        patch: int | None = None,
    ) -> NDArray[np.float64]:
        """Find the line of one critical Courant number in a rectangle of penalties, without a grid.

        Returns the points (beta_s, r), [n, 2], in the order of beta_s; n = 0 where there is none, or where the line of
        a scheme is not known.
        """
        what = asked(limit, theta, parameter, damping, "auto", tolerance, patch)
        return self._core.contour(courant, beta_s, ratio, what)

    def _facts(self) -> list[tuple[str, str]]:
        facts = [
            ("mass", self.mass),
            ("elements", self.elements),
            ("unknowns", self.unknowns),
            ("contacts", self.contacts),
        ]
        return [(name, str(value)) for name, value in facts if value is not None]

    def __repr__(self) -> str:
        """Say what it is."""
        return f"<bipenalty.Model {self.name}: {', '.join(f'{name} {value}' for name, value in self._facts())}>"

    def _repr_html_(self) -> str:
        cells = (f"<tr><th>{html.escape(n)}</th><td>{html.escape(v)}</td></tr>" for n, v in self._facts())
        return f"<table><caption>{html.escape(self.name)}</caption>{''.join(cells)}</table>"
