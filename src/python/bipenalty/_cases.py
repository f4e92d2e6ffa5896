"""The cases of a study: every scene with every combination of its parameters."""

from __future__ import annotations

import copy
import hashlib
import itertools
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ._bipenalty import axis
from ._model import Model
from ._results import _COLUMNS
from ._toml import tomllib

MODEL = {"mass", "elements", "penalty_mass"}
"""Parameters of the model; every other one is a key of the scene."""
ASKED = {"limit", "theta", "parameter", "damping", "engine", "patch"}
"""What may be asked in several ways."""
_PATHS = {"stiffness", "mass", "gaps", "scales", "mesh"}
"""Keys of scenes that name files, relative to the scene."""


@dataclass(frozen=True)
class Case:
    """One scene with one value of each parameter: a map over all penalties."""

    scene: str
    """A built-in name, a path, or the text of a scene whose keys were changed."""
    title: str
    """The scene as the study names it."""
    parameters: dict[str, Any]
    beta_s: list[float]
    ratio: list[float]
    tolerance: float | None
    files: str
    """What tells the contents of the scene and of the files that it names from others."""

    @property
    def key(self) -> str:
        """The same for the same question, and for no other."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:24]

    def run(self) -> dict[str, Any]:
        """Compute it: the rows, or what went wrong; nothing else is ever raised but by a signal."""
        try:
            made = {name: value for name, value in self.parameters.items() if name in MODEL}
            asked = {name: value for name, value in self.parameters.items() if name in ASKED}
            if self.tolerance is not None:
                asked["tolerance"] = self.tolerance
            model = Model.from_scene(self.scene, **made)
            found = model.stability_map(np.array(self.beta_s), np.array(self.ratio), **asked)
            # Through JSON and back a number keeps its bits.
            return {"key": self.key, "rows": [list(row) for row in found._rows()]}
        except BaseException as error:
            # Whatever it is, a panic of the library among it, the other cases go on.
            if isinstance(error, (KeyboardInterrupt, SystemExit)):
                raise
            return {"key": self.key, "error": f"{type(error).__name__}: {error}"}


def read(path: Path) -> tuple[str, list[Case], list[str]]:
    """Read a study: its name, its cases in order, and the names of its parameters."""
    try:
        study = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; allowed: a study that can be read") from error
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{path}: {error}") from error
    known = {"name", "scenes", "parameters", "penalties"}
    for table, keys in (("", known), ("penalties", {"beta_s", "ratio", "tolerance"})):
        for key in (study.get(table, {}) if table else study).keys() - keys:
            raise ValueError(f"{path}: {table and table + '.'}{key} is not allowed; allowed: {', '.join(sorted(keys))}")
    name, scenes = study.get("name", path.stem), study.get("scenes", [])
    if not isinstance(name, str) or not name or not all(c.isalnum() or c == "-" for c in name):
        raise ValueError(f"{path}: name = {name!r} is not allowed; allowed: letters, digits and '-'")
    if not (isinstance(scenes, list) and scenes and all(isinstance(scene, str) for scene in scenes)):
        raise ValueError(f"{path}: scenes = {scenes!r} is not allowed; allowed: a list of names and paths")
    penalties = study.get("penalties", {})
    beta_s, ratio = (_numbers(path, key, penalties.get(key)) for key in ("beta_s", "ratio"))
    parameters = study.get("parameters", {})
    for key, values in parameters.items():
        if not (isinstance(values, list) and values):
            raise ValueError(f"{path}: parameters.{key} = {values!r} is not allowed; allowed: a list of values")
    cases = []
    for scene in scenes:
        for values in itertools.product(*parameters.values()):
            chosen = dict(zip(parameters, values, strict=True))
            changed = {key: value for key, value in chosen.items() if key not in MODEL | ASKED}
            text, files = _scene(path.parent, scene, changed)
            cases.append(Case(text, scene, chosen, beta_s, ratio, penalties.get("tolerance"), files))
    return name, cases, list(parameters)


def header(parameters: list[str]) -> list[str]:
    """Name the columns of the records: those of stability-map between parameters and failures."""
    own = [f"parameter:{name}" if name in _COLUMNS else name for name in parameters]
    return ["case", *own, *_COLUMNS, "error"]


def rows(number: int, case: Case, result: dict[str, Any]) -> list[list[Any]]:
    """List the rows of a case; one row says what went wrong."""
    head = [number, *case.parameters.values()]
    if "error" in result:
        return [[*head, case.title, *[None] * (len(_COLUMNS) - 1), result["error"]]]
    return [[*head, *row, None] for row in result["rows"]]


def _numbers(path: Path, key: str, value: Any) -> list[float]:
    try:
        if isinstance(value, str):
            return axis(value)
        values = value if isinstance(value, list) else [value]
        return [float(v) for v in values]
    except (TypeError, ValueError) as error:
        allowed = "allowed: numbers, or text as 0,0.5,10, lin:0:10:401 or log:1e-3:1e12:301"
        raise ValueError(f"{path}: penalties.{key} = {value!r} is not allowed; {allowed}") from error


def _scene(folder: Path, scene: str, changed: dict[str, Any]) -> tuple[str, str]:
    """Give a scene as `Model.from_scene` takes it, with changed keys; and what tells its files from others."""
    path = folder / scene
    if not path.is_file():
        if changed:
            keys = ", ".join(changed)
            known = ", ".join(sorted(MODEL | ASKED))
            raise ValueError(f"scene {scene}: {keys} is not allowed; allowed: keys of a scene in a file, or {known}")
        return scene, ""
    text = path.read_text(encoding="utf-8")
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return str(path), text  # The library names the line, in a row of the case.
    named = list(_named(tables, path.parent))
    stamps = [(str(file), file.stat().st_size, file.stat().st_mtime_ns) for file in named if file.is_file()]
    files = hashlib.sha256(json.dumps([text, stamps]).encode()).hexdigest()
    if not changed:
        return str(path), files
    tables = _absolute(tables, path.parent)
    for key, value in changed.items():
        _set(tables, scene, key, value)
    return "\n".join(_toml(tables)) + "\n", files


def _tables_of_files(tables: dict[str, Any]) -> list[dict[str, Any]]:
    return [tables[name] for name in ("matrices",) if name in tables] + list(tables.get("body", []))


def _named(tables: dict[str, Any], folder: Path) -> list[Path]:
    found = [table[key] for table in _tables_of_files(tables) for key in _PATHS & table.keys()]
    return sorted(folder / name for name in found if isinstance(name, str))


def _absolute(tables: dict[str, Any], folder: Path) -> dict[str, Any]:
    tables = copy.deepcopy(tables)
    for table in _tables_of_files(tables):
        for key in _PATHS & table.keys():
            if isinstance(table[key], str):
                table[key] = str((folder / table[key]).resolve())
    return tables


def _set(tables: dict[str, Any], scene: str, key: str, value: Any) -> None:
    """Set a key such as ``bar.0.youngs_modulus``, which must be there, or be new in a table that is."""
    at: Any = tables
    *way, last = key.split(".")
    try:
        for step in way:
            at = at[int(step)] if isinstance(at, list) else at[step]
        if isinstance(at, list):
            at[int(last)] = value
        else:
            at[last] = value
    except (KeyError, IndexError, ValueError, TypeError) as error:
        raise ValueError(
            f"scene {scene}: {key} is not allowed; allowed: a key of the scene, as bar.0.length"
        ) from error


def _toml(tables: dict[str, Any], name: str = "") -> list[str]:
    """Write a scene as TOML: values first, then tables and lists of tables."""

    def is_table(value: Any) -> bool:
        return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))

    out = [f"{key} = {_value(value)}" for key, value in tables.items() if not is_table(value)]
    for key, value in tables.items():
        full = f"{name}{key}"
        if isinstance(value, dict):
            out += [f"[{full}]", *_toml(value, f"{full}.")]
        elif is_table(value):
            for item in value:
                out += [f"[[{full}]]", *_toml(item, f"{full}.")]
    return out


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    # JSON's strings are TOML's; repr gives numbers that read back the same.
    return json.dumps(value) if isinstance(value, str) else repr(value)
