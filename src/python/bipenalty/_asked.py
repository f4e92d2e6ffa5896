"""What is asked of a model: the keywords that its methods share."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any, NamedTuple, TypeAlias

Asked: TypeAlias = "tuple[str, float | None, float | None, tuple[float, float, float], str, float | None, int | None]"
"""Limit, theta, parameter, damping, engine, tolerance, patch."""
SchemeAsked: TypeAlias = "tuple[str, float | None, tuple[float, float, float]]"
"""Scheme, theta, damping."""

# What fits into a size.
_MOST = 2**63 - 1


class Damping(NamedTuple):
    """Damping C = A M + B K + c K_p with velocities half a step behind, as explicit codes have it.

    A and B are Rayleigh's and act on the bodies, not on the penalties; c damps closed contacts.
    """

    mass: float = 0.0
    """A, 1/s."""
    stiffness: float = 0.0
    """B, s."""
    contact: float = 0.0
    """c, s: N s/m of a closed contact for each N/m of its penalty."""


def asked(
    limit: str,
    theta: float | None,
    parameter: float | None,
    damping: Iterable[float] | None,
    engine: str = "auto",
    tolerance: float | None = None,
    patch: int | None = None,
) -> Asked:
    """Return what is asked as the library takes it."""
    return (
        _text(limit, "limit"),
        _number(theta, "theta"),
        _number(parameter, "parameter"),
        _damping(damping),
        _text(engine, "engine"),
        _number(tolerance, "tolerance"),
        count(patch, "patch"),
    )


def scheme_asked(scheme: str, theta: float | None, damping: Iterable[float] | None) -> SchemeAsked:
    """Return the scheme that is asked for as the library takes it."""
    return _text(scheme, "scheme"), _number(theta, "theta"), _damping(damping)


def count(value: int | None, name: str) -> int | None:
    """Return a whole number that is not negative."""
    if value is None:
        return None
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not 0 <= number <= _MOST:
        raise ValueError(f"{name}: {value} is not allowed; allowed: at least 1")
    return number


def _text(value: str, name: str) -> str:
    if isinstance(value, str):
        return value
    raise TypeError(f"{name} must be a name, not {value!r}")


def _number(value: float | None, name: str) -> float | None:
    if value is None or type(value) is float:
        return value
    try:
        if isinstance(value, str):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {value!r}") from None


def _damping(value: Any) -> tuple[float, float, float]:
    if value is None:
        return 0.0, 0.0, 0.0
    try:
        mass, stiffness, contact = map(float, value)
    except (TypeError, ValueError):
        allowed = "bipenalty.Damping(mass, stiffness, contact), or three numbers"
        raise ValueError(f"damping: {value!r} is not allowed; allowed: {allowed}") from None
    return mass, stiffness, contact
