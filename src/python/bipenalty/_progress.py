"""How far a long call is."""

from __future__ import annotations

import sys
from collections.abc import Callable

Progress = bool | Callable[[int, int], object]
"""True for a line on standard error, or a function that is told the parts done and all parts."""


def callback(progress: Progress) -> Callable[[int, int], object] | None:
    """Return what is called with the parts done and all parts."""
    if progress is False:
        return None
    return _line if progress is True else progress


def _line(done: int, total: int) -> None:
    end = "\n" if done == total else ""
    print(f"\r{100 * done // max(total, 1):3d} % of {total}", end=end, file=sys.stderr, flush=True)
