"""What the methods of `bipenalty.Model` answer: numbers with their enclosures, arrays with their units."""

from __future__ import annotations

import csv
import html
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from ._asked import Asked
    from ._bipenalty import Map
    from ._model import Model


def _digits(value: float) -> str:
    """Seven digits: enough to see what is asked, few enough to read."""
    return f"{value:.7g}"


def _penalty(beta_s: float, ratio: float) -> str:
    pure = " (pure penalty)" if ratio == np.inf else ""
    return f"beta_s = {beta_s:g}, r = {ratio:g}{pure}"


def _whose(limit: str) -> str:
    return "linear limit of closed contact" if limit == "spectrum" else f"limit of {limit} with closed contact"


def _table(rows: list[tuple[str, str]]) -> str:
    cells = (f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>" for name, value in rows)
    return f"<table>{''.join(cells)}</table>"


@dataclass(frozen=True)
class CriticalStep:
    """The critical time step at one point (beta_s, r), with its enclosure.

    Where `evidence` is ``"lower bound"`` the step is stable up to `lower` and the limit may lie anywhere above: `value`
    is `lower` then, and `upper` infinite unless a bound is known.
    """

    value: float
    """dt_cr, s."""
    lower: float
    """No larger than the exact limit of the matrices as stored, s."""
    upper: float
    """No smaller than it, s."""
    courant: float
    """Critical Courant number C_r = c0 dt_cr/h of the reference element; of matrices and meshes omega_ref dt_cr/2."""
    courant_lower: float
    """No larger than the exact one."""
    courant_upper: float
    """No smaller than it."""
    omega_max: float
    """rad/s: the highest frequency of spectrum and explicit schemes; of other limits 2/dt_cr."""
    evidence: str
    """``"proven"`` or ``"lower bound"``."""
    engine: str
    """What found it."""
    beta_s: float
    """Stiffness penalty, dimensionless."""
    ratio: float
    """Penalty ratio r; infinite without a mass penalty."""
    limit: str
    """``"spectrum"``, or the scheme whose limit it is."""

    def __float__(self) -> float:
        """dt_cr, s."""
        return self.value

    def __repr__(self) -> str:
        """Answer in a sentence."""
        known = "at least" if self.evidence == "lower bound" else "="
        width = (self.upper - self.lower) / self.value
        enclosed = "" if self.evidence == "lower bound" else f", enclosed to {width:.1e}"
        return (
            f"dt_cr {known} {_digits(self.value)} s ({_whose(self.limit)}{enclosed}; "
            f"C_r = {_digits(self.courant)}) for {_penalty(self.beta_s, self.ratio)}"
        )

    def _repr_html_(self) -> str:
        return _table(
            [
                (f"dt_cr, s ({_whose(self.limit)})", _digits(self.value)),
                ("enclosed", f"{self.lower!r} to {self.upper!r}"),
                ("C_r", _digits(self.courant)),
                ("penalty", _penalty(self.beta_s, self.ratio)),
                ("evidence", f"{self.evidence}, by {self.engine}"),
            ]
        )


@dataclass(frozen=True)
class OptimalRatio:
    """The largest ratio r that costs no time step against the model without contact.

    Where no ratio provably costs a step, all three numbers are infinite.
    """

    value: float
    """The ratio as found."""
    lower: float
    """Proven to cost nothing."""
    upper: float
    """Proven to cost a step; infinite where the limit is known from below only."""
    beta_s: float
    """Stiffness penalty, dimensionless."""
    limit: str
    """``"spectrum"``, or the scheme whose limit it is."""

    def __float__(self) -> float:
        """Return the ratio as found."""
        return self.value

    def __repr__(self) -> str:
        """Answer in a sentence."""
        if self.lower == np.inf:
            return f"no ratio costs a step at beta_s = {self.beta_s:g} ({_whose(self.limit)})"
        return (
            f"r = {_digits(self.value)} is the largest ratio that costs no step at beta_s = {self.beta_s:g} "
            f"({_whose(self.limit)}; proven between {_digits(self.lower)} and {_digits(self.upper)})"
        )


class Largest(float):
    """The largest penalty or ratio that a time step stands: a number, with its enclosure."""

    __slots__ = ("lower", "upper")

    lower: float
    """The step is proven to be within the limit up to here."""
    upper: float
    """The step is proven to be beyond the limit from here on; infinite where that is not known."""

    def __new__(cls, value: float, lower: float, upper: float) -> Largest:
        """Make the number."""
        largest = super().__new__(cls, value)
        largest.lower, largest.upper = lower, upper
        return largest

    def __reduce__(self) -> tuple[type[Largest], tuple[float, float, float]]:
        """Say what to copy and pickle."""
        return Largest, (float(self), self.lower, self.upper)

    def __repr__(self) -> str:
        """Answer in a sentence."""
        if self.lower == np.inf:
            return "inf (any will do)"
        return f"{_digits(self)} (proven: enough up to {_digits(self.lower)}, too much from {_digits(self.upper)})"


@dataclass(frozen=True)
class ContactShare:
    """A contact and its part in the critical mode."""

    contact: int
    """Its number, from 0: the column of Z."""
    share: float
    """Its part of what all contacts hold, 0 to 1."""
    place: str | None
    """Where it is, where there is a mesh."""

    def __repr__(self) -> str:
        """Answer in a line."""
        return f"contact {self.contact}{f' {self.place}' if self.place else ''}: {100 * self.share:.1f} %"


@dataclass(frozen=True, eq=False)
class Governing:
    """What governs a step: where the critical mode has its energy."""

    contact_energy: float
    """Part of the elastic energy that is in the contacts, 0 to 1."""
    contacts: list[ContactShare]
    """All contacts, the largest part first; empty where the mode moves no gap."""
    bodies: dict[str, float]
    """The part of each body in the kinetic energy; empty for matrices and bars."""
    elements: dict[int, float]
    """The ten elements with the largest parts of the strain energy; empty for matrices and bars."""
    mode: NDArray[np.float64]
    """[n], the critical mode x, with x'Mx = 1."""
    beta_s: float
    """Stiffness penalty, dimensionless."""
    ratio: float
    """Penalty ratio r."""

    def __repr__(self) -> str:
        """Answer in a few lines."""
        shown = "".join(f"\n  {contact!r}" for contact in self.contacts[:5])
        more = f"\n  and {len(self.contacts) - 5} more" if len(self.contacts) > 5 else ""
        held = f"{100 * self.contact_energy:.1f} % of the elastic energy is in the contacts"
        return f"{held}, for {_penalty(self.beta_s, self.ratio)}{shown}{more}"


@dataclass(frozen=True)
class SteppedLimit:
    """A limit that was found by stepping in time alone, beside the predicted one."""

    stable_at: float
    """dt at which no motion grew, s; 0 if every step was unstable."""
    unstable_at: float
    """The next step that was tried, at which one did, s."""
    predicted: float
    """The predicted limit, s; it only said where to look first. NaN where none is derived."""
    agrees: bool | None
    """Whether the prediction lies within the tolerance of the two; None where growth is too slow to be seen."""
    growth: float
    """At `unstable_at`, ln of the factor a step."""
    steps: int
    """Steps of a stable trial."""
    scheme: str
    """The scheme that stepped."""
    beta_s: float
    """Stiffness penalty, dimensionless."""
    ratio: float
    """Penalty ratio r."""

    def __repr__(self) -> str:
        """Answer in a sentence."""
        said = {True: "as predicted", False: "NOT as predicted", None: "growth too slow to judge the prediction"}
        judged = f"{said[self.agrees]} ({_digits(self.predicted)} s)"
        steps = f"stable at dt = {_digits(self.stable_at)} s, unstable at {_digits(self.unstable_at)} s"
        beside = "no prediction" if np.isnan(self.predicted) else judged
        return f"{self.scheme}: {steps}, {beside}, for {_penalty(self.beta_s, self.ratio)}"


@dataclass(frozen=True)
class _Kept:
    """What a map is made of once it was pickled."""

    arrays: dict[str, NDArray[np.float64]]
    engine: list[str]
    known: list[str]
    seconds: float

    def array(self, quantity: str) -> NDArray[np.float64]:
        return self.arrays[quantity]

    def engines(self) -> list[str]:
        return self.engine

    def evidence(self) -> list[str]:
        return self.known


@dataclass(frozen=True, eq=False)
class StabilityMap:
    """The critical step over stiffness penalties and ratios.

    Arrays have the shape [len(ratio), len(beta_s)]; NaN stands where nothing could be certified. They are made when
    they are first asked for.
    """

    model: Model
    """The model."""
    beta_s: NDArray[np.float64]
    """Stiffness penalties, dimensionless."""
    ratio: NDArray[np.float64]
    """Penalty ratios r; inf is the pure penalty method."""
    limit: str
    """``"spectrum"``, or the scheme whose limit it is."""
    _asked: Asked = field(repr=False)
    _map: Map | _Kept = field(repr=False)

    @cached_property
    def critical_step(self) -> NDArray[np.float64]:
        """dt_cr, s."""
        return self._map.array("critical_step")

    @cached_property
    def lower(self) -> NDArray[np.float64]:
        """No larger than the exact critical step, s."""
        return self._map.array("lower")

    @cached_property
    def upper(self) -> NDArray[np.float64]:
        """No smaller than the exact critical step, s; infinite where no bound is known."""
        return self._map.array("upper")

    @cached_property
    def courant(self) -> NDArray[np.float64]:
        """Critical Courant number C_r."""
        return self._map.array("courant")

    @cached_property
    def courant_lower(self) -> NDArray[np.float64]:
        """No larger than the exact C_r."""
        return self._map.array("courant_lower")

    @cached_property
    def courant_upper(self) -> NDArray[np.float64]:
        """No smaller than the exact C_r."""
        return self._map.array("courant_upper")

    @cached_property
    def omega_max(self) -> NDArray[np.float64]:
        """rad/s: the highest frequency of spectrum and explicit schemes; of other limits 2/dt_cr."""
        return self._map.array("omega_max")

    def __getstate__(self) -> dict[str, object]:
        """Say what to copy and pickle."""
        found = self._map
        arrays = {name: found.array(name) for name in _QUANTITIES}
        kept = _Kept(arrays, found.engines(), found.evidence(), found.seconds)
        own = {field.name: getattr(self, field.name) for field in fields(self)}
        return {**own, "_map": kept}

    @property
    def seconds(self) -> float:
        """Time that the computation took, s."""
        return self._map.seconds

    @cached_property
    def certified(self) -> NDArray[np.bool_]:
        """Where the limit is enclosed or bounded from below."""
        return ~np.isnan(self.lower)

    def __repr__(self) -> str:
        """Answer in a sentence."""
        known = self.critical_step[self.certified]
        found = f"dt_cr from {_digits(known.min())} to {_digits(known.max())} s" if known.size else "nothing certified"
        missing = self.certified.size - known.size
        gaps = f", {missing} not certified" if missing and known.size else ""
        points = f"{len(self.ratio)} ratios x {len(self.beta_s)} beta_s"
        return f"{self.model.name}: {found} at {points}{gaps} ({_whose(self.limit)})"

    def _repr_html_(self) -> str:
        def ends(row: NDArray[np.float64]) -> str:
            known = row[~np.isnan(row)]
            return f"{_digits(known.min())} to {_digits(known.max())}" if known.size else "not certified"

        shown = range(len(self.ratio)) if len(self.ratio) <= 12 else []
        rows = [(f"r = {self.ratio[i]:g}", ends(self.critical_step[i])) for i in shown]
        return f"<p>{html.escape(repr(self))}</p>" + (_table([("ratio", "dt_cr, s"), *rows]) if rows else "")

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw C_r: curves over beta_s for up to 12 ratios, colours with contour lines for more.

        Needs matplotlib. Contour lines are exact where the library has them in closed form or by bisection,
        and interpolated otherwise.
        """
        from . import _plot

        return _plot.stability_map(self, ax)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write one row a point, with the columns of the command line tool ``stability-map --stdout csv``."""
        with Path(path).open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(_COLUMNS)
            writer.writerows(self._rows())

    def _rows(self) -> Iterator[tuple[object, ...]]:
        model, spectrum = self.model, self.limit == "spectrum"
        # What a code that is given s and m needs, of the softest contact.
        scale, reference = model._core.smallest_scale(), model.reference
        head = (model.name, model.mass or "given", model.gamma, model.elements, self.limit)
        quantities = [self.omega_max, self.courant, self.courant_lower, self.courant_upper]
        quantities += [self.critical_step, self.lower, self.upper]
        columns = zip(*(array.ravel().tolist() for array in quantities), strict=True)
        penalties = ((beta_s, r) for r in self.ratio.tolist() for beta_s in self.beta_s.tolist())
        points = zip(penalties, columns, self._map.engines(), self._map.evidence(), strict=True)
        for (beta_s, r), (omega, c, c_low, c_high, dt, low, high), engine, evidence in points:
            known, found = evidence != "", evidence == "proven"
            yield (
                *head,
                beta_s,
                r,
                omega if known and spectrum else None,
                c if found else None,
                c_low if known else None,
                c_high if known else None,
                engine if known else f"{engine}, not certified",
                dt if found else None,
                low if known else None,
                high if known else None,
                evidence,
                None if scale is None else beta_s * scale,
                None if scale is None else beta_s * scale / (r * reference),
            )


_QUANTITIES = ("critical_step", "lower", "upper", "courant", "courant_lower", "courant_upper", "omega_max")
_COLUMNS = (
    "scene,mass,gamma,elements,limit,stiffness_penalty,ratio,omega_max,critical_courant,lower,upper,engine,"
    "critical_step,step_lower,step_upper,evidence,penalty_stiffness,penalty_mass"
).split(",")


@dataclass(frozen=True, eq=False, repr=False)
class Impact:
    """The history of an impact: n rows, k contacts."""

    time: NDArray[np.float64]
    """[n], s."""
    contact_force: NDArray[np.float64]
    """[n, k], N, positive in compression."""
    gap: NDArray[np.float64]
    """[n, k], m, positive in penetration."""
    relative_gap: NDArray[np.float64] | None
    """[n, k], the gap over the length of the reference element, of bars."""
    kinetic_energy: NDArray[np.float64]
    """[n], J."""
    strain_energy: NDArray[np.float64]
    """[n], J."""
    penalty_energy: NDArray[np.float64]
    """[n], J, held by the penalties of the closed contacts."""
    contact_work: NDArray[np.float64]
    """[n], J, that the bodies have done on the contacts."""
    body_work: NDArray[np.float64]
    """[n], J, of body forces and loads since the start."""
    loss: NDArray[np.float64]
    """[n], J, lost by the scheme; negative is a gain."""
    exact_force: NDArray[np.float64] | None
    """[n], N, of the exact solution of one contact of bars, where there is one."""
    time_step: float
    """dt, s."""
    steps: int
    """Steps done."""
    switches: int
    """How often a contact has opened or closed."""
    force_error: float | None
    """rms of force minus exact force over all steps, over the peak exact force; None without an exact force."""
    energy_ratio: float | None
    """Energy at the end over that at the start; None where there is none at the start."""
    more_energy: bool
    """Whether that is above 1 by more than rounding."""
    blew_up_at: float | None
    """When a velocity left all bounds, s."""
    scheme: str
    """The scheme."""
    beta_s: float
    """Stiffness penalty, dimensionless."""
    ratio: float
    """Penalty ratio r."""

    @property
    def resultant(self) -> NDArray[np.float64]:
        """[n], N: the sum of the forces of all contacts, as on a wall where all have one direction."""
        total: NDArray[np.float64] = self.contact_force.sum(axis=1)
        return total

    @property
    def energy(self) -> NDArray[np.float64]:
        """[n], J: kinetic, strain and penalty energy together."""
        return self.kinetic_energy + self.strain_energy + self.penalty_energy

    def __repr__(self) -> str:
        """Answer in a sentence."""
        if self.blew_up_at is not None:
            ending = f"BLEW UP by t = {_digits(self.blew_up_at)} s"
        elif self.energy_ratio is None:
            ending = f"{self.steps} steps to t = {_digits(float(self.time[-1]))} s"
        else:
            ending = f"{self.steps} steps, ends with {self.energy_ratio:.4g} times its energy"
            ending += " (MORE THAN IT WAS GIVEN)" if self.more_energy else ""
        step = f"dt = {_digits(self.time_step)} s, {_penalty(self.beta_s, self.ratio)}"
        return f"{self.scheme}: {ending}, {self.switches} switches, {step}"

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the contact forces over time, beside the exact one where there is one. Needs matplotlib."""
        from . import _plot

        return _plot.impact(self, ax)
