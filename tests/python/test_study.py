"""Studies: every case once, whatever kills them."""

from __future__ import annotations

import csv
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

BAR = """
name = "bar"
[ends]
right = "wall"
[[bar]]
length = 1.0
elements = 8
youngs_modulus = 1e9
density = 1e3
area = 1e-4
"""

STUDY = """
name = "sweep"
scenes = ["signorini", "bar.toml"]
[parameters]
mass = ["lumped", "consistent"]
elements = [4, 9, 16, 25, 36]
[penalties]
beta_s = [0.0, 1.0, 10.0, 100.0, 1000.0]
ratio = [1.0, inf]
"""


def _folder(path: Path, study: str = STUDY) -> Path:
    path.mkdir(exist_ok=True)
    (path / "bar.toml").write_text(BAR)
    (path / "study.toml").write_text(study)
    return path / "study.toml"


def _command(study: Path, *more: str) -> list[str]:
    return [sys.executable, "-m", "bipenalty.study", str(study), *more]


def _hindered(study: Path, *more: str) -> list[str]:
    return [sys.executable, str(Path(__file__).with_name("hindered_study.py")), str(study), *more]


def _run(study: Path, *more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(_command(study, *more), capture_output=True, text=True, timeout=300, check=False)


def _keys(folder: Path) -> list[str]:
    lines = [line for path in folder.glob("journal*.jsonl") for line in path.read_bytes().split(b"\n")]
    return [json.loads(line)["key"] for line in lines if line]


def _records(folder: Path) -> str:
    return (folder / "sweep" / "sweep.csv").read_text()


def test_one_process_or_several_or_shares_give_the_same_records(tmp_path: Path) -> None:
    alone = _folder(tmp_path / "alone")
    assert _run(alone, "--workers", "1").returncode == 0
    expected = _records(tmp_path / "alone")
    table = list(csv.DictReader(expected.splitlines()))
    assert len(table) == 2 * 2 * 5 * 2 * 5
    assert [row["case"] for row in table] == [str(case) for case in range(20) for _ in range(10)]
    assert {row["error"] for row in table} == {""}
    assert {row["scene"] for row in table} == {"signorini", "bar"}
    several = _folder(tmp_path / "several")
    assert _run(several, "--workers", "3").returncode == 0
    assert _records(tmp_path / "several") == expected
    shares = _folder(tmp_path / "shares")
    for number in (2, 0, 1):
        assert not (tmp_path / "shares" / "sweep" / "sweep.csv").exists()
        assert _run(shares, "--slurm-array", f"{number}/3").returncode == 0
    assert _records(tmp_path / "shares") == expected
    assert len(_keys(tmp_path / "shares" / "sweep")) == 20


def test_killed_twenty_times_nothing_is_lost_or_done_twice(tmp_path: Path) -> None:
    text = STUDY.replace("[4, 9, 16, 25, 36]", str(list(range(2, 22))))
    alone = _folder(tmp_path / "alone", text)
    assert _run(alone, "--workers", "1").returncode == 0
    study, wheel = _folder(tmp_path / "killed", text), random.Random(1)
    out, seen, kills = tmp_path / "killed" / "sweep", 0, 0
    # A case takes a tenth of a second or so, so that the kills fall all over the study.
    environment = {**os.environ, "PAUSE": "0.1"}
    for _ in range(20):
        process = subprocess.Popen(
            _hindered(study, "--workers", "2", "--quiet"), env=environment, start_new_session=True
        )
        journal = out / "journal.jsonl"
        # Until it has written one more line, or was about to.
        goal, deadline = seen + wheel.randint(0, 1), time.monotonic() + 60
        while process.poll() is None and time.monotonic() < deadline:
            if journal.exists() and journal.read_bytes().count(b"\n") > goal:
                break
            time.sleep(0.002)
        time.sleep(wheel.uniform(0.0, 0.02))
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            kills += 1
        process.wait()
        if wheel.random() < 0.5 and journal.exists() and process.returncode != 0:
            # As a kill in the middle of a line leaves it.
            with journal.open("ab") as file:
                file.write(b'{"key":"torn","rows":[[1.0,')
        keys = _keys_whole(journal)
        assert len(keys) >= seen
        assert len(set(keys)) == len(keys)
        seen = len(keys)
    assert kills == 20
    assert _run(study, "--workers", "2").returncode == 0
    keys = _keys(out)
    assert len(keys) == len(set(keys)) == 80
    assert _records(tmp_path / "killed") == _records(tmp_path / "alone")


def _keys_whole(journal: Path) -> list[str]:
    if not journal.exists():
        return []
    return [json.loads(line)["key"] for line in journal.read_bytes().split(b"\n")[:-1]]


def test_failures_are_rows_and_do_not_end_the_study(tmp_path: Path) -> None:
    text = STUDY.replace('["signorini", "bar.toml"]', '["bar.toml", "nowhere"]').replace("[4, 9, 16, 25, 36]", "[4, 0]")
    study = _folder(tmp_path / "failing", text)
    run = _run(study, "--workers", "2")
    assert run.returncode == 1
    assert "8 of 8 cases, 6 failed" in run.stderr
    table = list(csv.DictReader(_records(tmp_path / "failing").splitlines()))
    assert [row["case"] for row in table if row["error"]] == ["1", "3", "4", "5", "6", "7"]
    assert all("ValueError" in row["error"] for row in table if row["error"])
    # Nothing is tried again unless asked to.
    assert len(_keys(tmp_path / "failing" / "sweep")) == 8
    _run(study)
    assert len(_keys(tmp_path / "failing" / "sweep")) == 8
    _run(study, "--retry", "--workers", "1")
    assert len(_keys(tmp_path / "failing" / "sweep")) == 14


def test_keys_of_a_scene_are_parameters(tmp_path: Path) -> None:
    text = STUDY.replace('scenes = ["signorini", "bar.toml"]', 'scenes = ["bar.toml"]')
    text = text.replace("elements = [4, 9, 16, 25, 36]", '"bar.0.density" = [1e3, 4e3]')
    study = _folder(tmp_path / "keys", text)
    assert _run(study, "--workers", "1").returncode == 0
    table = list(csv.DictReader(_records(tmp_path / "keys").splitlines()))
    steps = [float(row["critical_step"]) for row in table]
    for light, heavy in ((0, 10), (20, 30)):
        assert steps[heavy : heavy + 10] == pytest.approx([2 * step for step in steps[light : light + 10]], rel=1e-12)
    # A changed scene is another question.
    (tmp_path / "keys" / "bar.toml").write_text(BAR.replace("1e9", "4e9"))
    assert _run(study, "--workers", "1").returncode == 0
    again = list(csv.DictReader(_records(tmp_path / "keys").splitlines()))
    assert [float(row["critical_step"]) for row in again] == pytest.approx([step / 2 for step in steps], rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("scenes", "scene", "scene is not allowed"),
        ('["signorini", "bar.toml"]', "[]", "a list of names and paths"),
        ('["lumped", "consistent"]', '"lumped"', "a list of values"),
        ("[1.0, inf]", '"one"', "penalties.ratio"),
        ('name = "sweep"', 'name = "../sweep"', "letters, digits"),
        ("elements", '"bar.7.length"', "bar.7.length is not allowed"),
    ],
)
def test_a_study_that_means_nothing_is_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    run = _run(_folder(tmp_path / "wrong", STUDY.replace(old, new, 1)))
    assert run.returncode == 2
    assert said in run.stderr
    assert "Traceback" not in run.stderr
    assert not (tmp_path / "wrong" / "sweep").exists()


def test_two_runs_at_once_are_refused(tmp_path: Path) -> None:
    study = _folder(tmp_path / "twice")
    environment = {**os.environ, "PAUSE": "0.3"}
    first = subprocess.Popen(_hindered(study, "--workers", "2", "--quiet"), env=environment)
    while not (tmp_path / "twice" / "sweep" / "journal.jsonl").exists():
        time.sleep(0.01)
    time.sleep(0.05)
    second = _run(study)
    assert second.returncode == 2
    assert "another run" in second.stderr
    assert first.wait(timeout=120) == 0


def test_a_worker_that_dies_is_a_row(tmp_path: Path) -> None:
    study = _folder(tmp_path / "dying", STUDY.replace('["signorini", "bar.toml"]', '["bar.toml"]'))
    environment = {**os.environ, "DIES_AT": "16"}
    run = subprocess.run(
        _hindered(study, "--workers", "2"), env=environment, capture_output=True, text=True, check=False
    )
    assert run.returncode == 1
    table = list(csv.DictReader(_records(tmp_path / "dying").splitlines()))
    assert [(row["elements"], row["error"][:11]) for row in table if row["error"]] == [("", "the process")] * 2
    assert len(_keys(tmp_path / "dying" / "sweep")) == 10
