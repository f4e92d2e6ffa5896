"""A mesh on one and on two processes, against one machine."""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
import sys
from pathlib import Path

import bipenalty as bp
import numpy as np
import pytest

pytest.importorskip("mpi4py")
pytestmark = pytest.mark.skipif(shutil.which("mpirun") is None, reason="needs mpirun")

BLOCKS = """
name = "blocks"
dimension = 2
plane = "strain"
[[body]]
name = "lower"
box = [3.0, 1.5]
cells = [24, 12]
element = "quad4"
youngs_modulus = 210e9
poissons_ratio = 0.3
density = 7850.0
[[body]]
name = "upper"
box = [3.0, 1.5]
cells = [{cells}, 12]
origin = [0.0, 1.5]
element = "quad4"
youngs_modulus = 70e9
poissons_ratio = 0.3
density = 2700.0
[[contact]]
surfaces = ["upper.bottom", "lower.top"]
[[hold]]
surface = "lower.bottom"
directions = ["x", "y"]
"""

ASKED = ("--beta-s", "0,0.1,1,10,1e3,1e6", "--ratio", "0.3,1,3,inf")


def _scene(folder: Path, cells: int = 24) -> str:
    path = folder / "blocks.toml"
    path.write_text(BLOCKS.format(cells=cells))
    return str(path)


def _environment() -> dict[str, str]:
    # Open MPI refuses root, as whom containers run, unless told twice.
    return {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1"}


def _command(processes: int, *arguments: str) -> list[str]:
    mpi = ["mpirun", "--oversubscribe", "-n", str(processes), sys.executable, "-m"]
    return [*mpi, "bipenalty.distributed", *arguments]


def _run(processes: int, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        _command(processes, *arguments), env=_environment(), capture_output=True, text=True, timeout=600, check=False
    )


def _table(run: subprocess.CompletedProcess[str]) -> list[dict[str, str]]:
    assert run.returncode == 0, run.stderr
    return list(csv.DictReader(run.stdout.splitlines()))


@pytest.mark.parametrize(("cells", "mass"), [(24, "lumped"), (20, "consistent")])
def test_one_and_two_processes_enclose_what_one_machine_does(tmp_path: Path, cells: int, mass: str) -> None:
    scene, tolerance = _scene(tmp_path, cells), 5e-3
    more = ("--mass", mass, "--tolerance", str(tolerance), "--stdout", "csv")
    runs = [_run(n, scene, *ASKED, *more) for n in (1, 2)]
    # Where the meshes do not match, patches that a contact crosses share its elements, and may be too high.
    assert all(run.returncode == 0 or (cells != 24 and run.returncode == 1) for run in runs), runs
    one, two = (list(csv.DictReader(run.stdout.splitlines())) for run in runs)
    model = bp.Model.from_scene(scene, mass=mass)
    ratios, penalties = [0.3, 1.0, 3.0, np.inf], [0.0, 0.1, 1.0, 10.0, 1e3, 1e6]
    alone = model.stability_map(penalties, ratios, tolerance=1e-6)
    assert len(one) == len(two) == 24
    for first, second, lower, upper in zip(one, two, alone.lower.ravel(), alone.upper.ravel(), strict=True):
        if cells == 24:
            assert first["engine"] == "convex-parts"
            assert first["evidence"] == "proven"
        steps = [[float(row[key]) for key in ("step_lower", "step_upper")] for row in (first, second)]
        for low, high in steps:
            # The reference of r is a computed number, right to the square of 1e-6.
            assert low <= upper * (1 + 1e-9)
            assert lower <= high * (1 + 1e-9)
            assert high / low - 1 <= (tolerance if first["evidence"] else 1.0)
        assert steps[0] == pytest.approx(steps[1], rel=tolerance)
        assert first["stiffness_penalty"] == second["stiffness_penalty"]
        assert first["ratio"] == second["ratio"]


def test_parts_from_files_give_the_same_map(tmp_path: Path) -> None:
    scene, parts = _scene(tmp_path), str(tmp_path / "parts")
    more = ("--tolerance", "0.02", "--stdout", "csv", "--quiet")
    direct = _table(_run(2, scene, *ASKED, *more))
    assert _run(1, scene, "--split", "2", "--tolerance", "0.02", "--out", parts, "--quiet").returncode == 0
    stored = _table(_run(2, parts, *ASKED, *more))
    assert stored == direct
    wrong = _run(1, parts, *ASKED, *more)
    assert wrong.returncode == 2
    assert "2 parts for 1 processes" in wrong.stderr
    (tmp_path / "parts" / "part-00001.npz").write_bytes(b"cut off")
    broken = _run(2, parts, *ASKED, *more)
    assert broken.returncode == 2
    assert "part-00001.npz" in broken.stderr
    assert "Traceback" not in broken.stderr


def test_only_the_first_process_writes(tmp_path: Path) -> None:
    run = _run(2, _scene(tmp_path), *ASKED, "--tolerance", "0.02", "--out", str(tmp_path / "out"))
    assert run.returncode == 0, run.stderr
    assert run.stdout == ""
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["stability-map.csv"]
    assert run.stderr.count("24 points") == 1


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (("--ratio", "0"), "--ratio"),
        (("--beta-s", "lin:0:1"), "start:stop:count"),
        (("--mass", "heavy"), "mass"),
        (("--tolerance", "2"), "--tolerance"),
        (("--patch", "0"), "--patch"),
        (("--colour", "red"), "--colour"),
    ],
)
def test_what_is_not_allowed_is_refused_before_anything_is_computed(
    tmp_path: Path, changed: tuple[str, ...], said: str
) -> None:
    run = _run(2, _scene(tmp_path), *ASKED, "--out", str(tmp_path / "out"), *changed)
    assert run.returncode == 2
    assert said in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "out").exists()


def test_scenes_of_bars_and_more_processes_than_patches_are_refused(tmp_path: Path) -> None:
    (tmp_path / "bar.toml").write_text('name = "bar"\n[[bar]]\nlength = 1.0\n')
    run = _run(1, str(tmp_path / "bar.toml"), *ASKED)
    assert run.returncode == 2
    assert "stability-map" in run.stderr
    run = _run(2, _scene(tmp_path), *ASKED, "--patch", "100")
    assert run.returncode == 2
    assert "1 to 1" in run.stderr
    run = _run(2, str(tmp_path / "nowhere.toml"), *ASKED)
    assert run.returncode == 2
    assert "nowhere.toml" in run.stderr


def _where_the_second_process(tmp_path: Path, does: str) -> subprocess.CompletedProcess[str]:
    """A job of two processes, the second of which does this instead of its first proof."""
    driver = tmp_path / "driver.py"
    driver.write_text(
        "import os, signal, sys\n"
        "from bipenalty import _slepc, distributed\n"
        "prove = _slepc.Pencil.prove\n"
        "def failing(self, *asked):\n"
        "    if self.comm.rank == 1:\n"
        f"        {does}\n"
        "    return prove(self, *asked)\n"
        "_slepc.Pencil.prove = failing\n"
        "sys.exit(distributed.main())\n"
    )
    command = ["mpirun", "--oversubscribe", "-n", "2", sys.executable, str(driver), _scene(tmp_path), *ASKED]
    return subprocess.run(command, env=_environment(), capture_output=True, text=True, timeout=120, check=False)


def test_a_process_that_raises_ends_the_job_with_a_message(tmp_path: Path) -> None:
    run = _where_the_second_process(tmp_path, "raise MemoryError('no more')")
    assert run.returncode not in (0, 2)
    assert "process 1 of 2 ended: MemoryError('no more')" in run.stderr


def test_a_process_that_is_killed_ends_the_job(tmp_path: Path) -> None:
    run = _where_the_second_process(tmp_path, "os.kill(os.getpid(), signal.SIGKILL)")
    assert run.returncode not in (0, 2)
    assert "signal 9" in run.stderr
