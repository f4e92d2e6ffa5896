"""Parts of a mesh: cut from a scene, or read from files that any code may write.

A folder of parts holds ``mesh.json`` (name, mass, gamma, elements, parts) and ``part-00000.npz``, one for each process.
Arrays of a part, numbers in it local and from 0:

=====================  =========  ===================================================================================
``unknowns``           int64 [n]  their numbers in the whole mesh, ascending
``shape_size``         int64 [s]  unknowns of each distinct element
``shape_stiffness``    float64    K_e by rows, one after the other, N/m
``shape_mass``         float64    M_e by rows, kg
``element_shape``      int64 [e]  the shape of each element
``element_unknowns``   int64      the unknowns of each element; -1 is held
``element_patch``      int64 [e]  the patch of each element: some hundred to some thousand unknowns each
``gap_size``           int64 [k]  entries of each gap
``gap_unknowns``       int64      unknowns of each gap: all of one gap must be of this part
``gap_entries``        float64    z
``gap_scale``          float64    w, N/m; of a contact that several parts carry, the share of this one
``gap_patch``          int64 [k]  the patch that carries each gap; optional: by default shared out among the part's
=====================  =========  ===================================================================================

So K is the sum of the elements of all parts, and P = sum_j w_j z_j z_j' the sum over their gaps.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._bipenalty import split
from ._toml import tomllib

if TYPE_CHECKING:
    import argparse

    from numpy.typing import NDArray

    Lists = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Facts:
    """What records say of a mesh."""

    name: str
    mass: str
    gamma: float
    elements: int
    parts: int


def patch_edge(tolerance: float, dimension: int) -> int:
    """Elements along an edge of a patch.

    With contact, and ratios from 0.3 on, patches of 8 squares along an edge leave a step too small by 5.5e-3, of cubes
    by 1.8e-3 (two lumped blocks of unlike stiffness, nodes on nodes), which falls as m^-2.6.
    """
    edge: float = 8.0 * ((5.5e-3 if dimension == 2 else 1.8e-3) / tolerance) ** (1 / 2.6)
    return max(4, math.ceil(edge))


def cut(options: argparse.Namespace, parts: int) -> tuple[Facts, list[Lists]]:
    """Cut the scene of a file into parts, out of patches of the size asked for."""
    text = Path(options.scene).read_text(encoding="utf-8")
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        tables = {}  # The library names the line.
    for table, instead in (("bar", "stability-map, which has them in closed form"), ("matrices", "a folder of parts")):
        if table in tables:
            raise ValueError(f"scene {tables.get('name')}: [{table}] is not allowed; allowed: [[body]], or {instead}")
    edge = options.patch or patch_edge(options.tolerance, 2 if tables.get("dimension") == 2 else 3)
    lists, elements = split(text, options.scene, options.gamma, parts, edge)
    return Facts(str(tables.get("name")), options.mass, options.gamma, elements, parts), lists


def write(folder: Path, facts: Facts, lists: list[Lists]) -> None:
    """Write the parts into a folder; ``mesh.json`` comes last, so that a folder without it is not complete."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "mesh.json").unlink(missing_ok=True)
    for number, part in enumerate(lists):
        np.savez(_file(folder, number), **part)  # type: ignore[arg-type]
    unfinished = folder / "mesh.json.part"
    unfinished.write_text(json.dumps(asdict(facts), indent=1) + "\n", encoding="utf-8")
    unfinished.replace(folder / "mesh.json")


def facts_of(folder: Path) -> Facts:
    """Read what ``mesh.json`` says."""
    try:
        return Facts(**json.loads((folder / "mesh.json").read_text(encoding="utf-8")))
    except (OSError, TypeError, json.JSONDecodeError) as error:
        raise ValueError(f"{folder / 'mesh.json'}: {error}; allowed: a folder that --split has written") from error


def read(folder: Path, number: int) -> Lists:
    """Read one part."""
    try:
        with np.load(_file(folder, number), allow_pickle=False) as part:
            return dict(part)
    except (OSError, ValueError, EOFError) as error:
        raise ValueError(f"{_file(folder, number)}: {error}; allowed: the arrays of a part") from error


def _file(folder: Path, number: int) -> Path:
    return folder / f"part-{number:05d}.npz"
