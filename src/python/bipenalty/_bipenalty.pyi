"""The part that is written in Rust; `bipenalty.Model` is what to use."""

from collections.abc import Callable
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_Floats: TypeAlias = NDArray[np.float64]
_Progress: TypeAlias = Callable[[int, int], object] | None
# Limit, theta, engine, tolerance.
_Asked: TypeAlias = tuple[str, float | None, str, float | None]
# Shape; where rows start, columns, values.
_Rows: TypeAlias = tuple[tuple[int, int], NDArray[np.int64], NDArray[np.uint32], _Floats]
_OwnRows: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int64], _Floats, tuple[int, int]]

__all__ = ["Core", "Map", "Uncertified", "__version__"]

__version__: str

class Uncertified(ArithmeticError): ...

@final
class Core:
    @staticmethod
    def from_scene(
        scene: str, text: str | None, mass: float | None, elements: int | None, diagonalised: bool
    ) -> Core: ...
    @staticmethod
    def from_matrices(
        stiffness: _Rows, mass: _Rows | _Floats, gaps: _Rows, scales: _Floats | None, reference: float | None
    ) -> Core: ...
    def facts(self) -> tuple[str, tuple[str, float] | None, int | None, int, int]: ...
    def reference(self) -> float: ...
    def matrices(self) -> tuple[_OwnRows, _OwnRows, _OwnRows, _Floats]: ...
    def critical_step(
        self, beta_s: float, ratio: float, asked: _Asked
    ) -> tuple[list[float], list[float], float, str, str]: ...
    def map(self, beta_s: _Floats, ratio: _Floats, asked: _Asked, progress: _Progress) -> Map: ...
    def optimal_ratio(self, beta_s: float, asked: _Asked) -> list[float] | None: ...
    def largest_penalty(self, time_step: float, ratio: float, asked: _Asked) -> list[float] | None: ...
    def largest_ratio(self, time_step: float, beta_s: float, asked: _Asked) -> list[float] | None: ...
    def governs(
        self, beta_s: float, ratio: float, asked: _Asked
    ) -> tuple[
        float, list[tuple[int, float, str | None]], list[tuple[str, float]], list[tuple[int, float]], _Floats
    ]: ...
    def verify(
        self, beta_s: float, ratio: float, scheme: str, theta: float | None, tolerance: float | None
    ) -> tuple[list[float], int, float, bool | None]: ...
    def impact(
        self,
        scheme: str,
        theta: float | None,
        beta_s: float,
        ratio: float,
        relative_courant: float,
        duration: float | None,
        every: int,
        progress: _Progress,
    ) -> dict[str, Any]: ...
    def contour(
        self, courant: float, beta_s: tuple[float, float], ratio: tuple[float, float], asked: _Asked
    ) -> _Floats: ...

@final
class Map:
    @property
    def seconds(self) -> float: ...
    def array(self, quantity: str) -> _Floats: ...
    def engines(self) -> list[str]: ...
    def evidence(self) -> list[str]: ...
