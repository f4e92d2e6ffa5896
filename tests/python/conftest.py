"""What the tests share: the command line tools, which `cargo build --release` leaves in target/release, and scenes."""

import csv
import io
import subprocess
from pathlib import Path

import bipenalty as bp
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
# Fifty points.
BETA_S = [0.0, 1e-3, 0.5, 1.0, 3.7, 10.0, 1e3, 1e6, 1e9, 1e12]
RATIO = [0.25, 1.0, 1.7, 30.0, np.inf]


def spec(values):
    """Return numbers as options take them."""
    return ",".join(repr(value) for value in values)


def same(text, value):
    """Whether a cell of a record is this number, to the bit; an empty one is NaN."""
    return np.isnan(value) if text == "" else float(text) == value


class Tools:
    """Runs the tools and reads their records."""

    def __call__(self, *arguments):
        """Return the rows that a tool prints, as dictionaries of text."""
        tool, *options = map(str, arguments)
        path = ROOT / "target" / "release" / tool
        if not path.exists():
            pytest.fail(f"{path} is missing: run cargo build --release first")
        command = [path, *options, "--stdout", "csv", "--quiet"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert run.returncode in (0, 1), run.stderr
        return list(csv.DictReader(io.StringIO(run.stdout)))


@pytest.fixture(scope="session")
def tools():
    return Tools()


SCENES = {
    "mesh": """
name = "two-blocks"
dimension = 2
plane = "strain"
[[body]]
name = "lower"
box = [3.0, 2.0]
cells = [6, 4]
element = "quad4"
youngs_modulus = 210e9
poissons_ratio = 0.3
density = 7850.0
[[body]]
name = "upper"
box = [2.0, 1.0]
cells = [5, 3]
origin = [0.5, 2.0]
element = "quad4"
youngs_modulus = 70e9
poissons_ratio = 0.3
density = 2700.0
[[contact]]
surfaces = ["upper.bottom", "lower.top"]
[[hold]]
surface = "lower.bottom"
directions = ["x", "y"]
""",
    "matrices": """
name = "matrices"
[matrices]
stiffness = "K.mtx"
mass = "M.mtx"
gaps = "Z.mtx"
scales = "w.mtx"
""",
}


def write_scenes(folder, cells=("[6, 4]", "[5, 3]")):
    """Write a scene of a mesh and one of its matrices, and return their paths by name."""
    from scipy.io import mmwrite  # where tests run with the system's packages there is none

    mesh = SCENES["mesh"].replace("[6, 4]", cells[0]).replace("[5, 3]", cells[1])
    *matrices, w = bp.Model.from_scene(mesh).matrices()
    for name, matrix in zip("KMZw", [*matrices, w[:, np.newaxis]], strict=True):
        mmwrite(folder / f"{name}.mtx", matrix, precision=17)
    paths = {name: folder / f"{name}.toml" for name in SCENES}
    paths["mesh"].write_text(mesh)
    paths["matrices"].write_text(SCENES["matrices"])
    return paths


@pytest.fixture(params=SCENES)
def scene_file(request, tmp_path):
    """Return the path of a scene of meshes, or of the matrices of the same one."""
    return write_scenes(tmp_path)[request.param]
