"""The part that is written in Rust; `bipenalty.Model` is what to use."""

from collections.abc import Callable
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Progress = Callable[[int, int], object] | None

__version__: str

class Uncertified(ArithmeticError): ...

@final
class Core:
    @staticmethod
    def from_scene(scene: str, mass: float, elements: int | None, diagonalised: bool) -> Core: ...
    def facts(self) -> tuple[str, str, int, int, int, float]: ...
    def critical_step(
        self, beta_s: float, ratio: float, limit: str, theta: float | None, engine: str
    ) -> tuple[list[float], list[float], float, str, str]: ...
    def map(
        self,
        beta_s: _Floats,
        ratio: _Floats,
        limit: str,
        theta: float | None,
        engine: str,
        progress: _Progress,
    ) -> Map: ...
    def optimal_ratio(self, beta_s: float, limit: str, theta: float | None) -> list[float] | None: ...
    def verify(
        self, beta_s: float, ratio: float, scheme: str, theta: float | None, tolerance: float
    ) -> tuple[list[float], list[float], int, float, bool | None]: ...
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
        self,
        courant: float,
        beta_s: tuple[float, float],
        ratio: tuple[float, float],
        limit: str,
        theta: float | None,
    ) -> _Floats: ...

@final
class Map:
    def array(self, quantity: str) -> _Floats: ...
    def engines(self) -> list[str]: ...
    def evidence(self) -> list[str]: ...
