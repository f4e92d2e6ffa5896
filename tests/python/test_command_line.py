"""Maps and impacts have the same numbers, to the bit, as those of the command line: 50 points of every kind."""

import csv
import subprocess

import bipenalty as bp
import numpy as np
import pytest
from conftest import BETA_S, RATIO, ROOT, same, spec
from scipy.io import mmread, mmwrite

COLUMNS = {
    "critical_step": "critical_step",
    "step_lower": "lower",
    "step_upper": "upper",
    "critical_courant": "courant",
    "lower": "courant_lower",
    "upper": "courant_upper",
}


def options(scene, mass, limit, **keywords):
    found = [scene, "--mass", mass, "--limit", limit, "--beta-s", spec(BETA_S), "--ratio", spec(RATIO)]
    for name, value in keywords.items():
        found += [f"--{name.replace('_', '-')}", value]
    return found


def assert_map(rows, found):
    assert len(rows) == 50
    for column, name in COLUMNS.items():
        values = getattr(found, name).ravel()
        for row, value in zip(rows, values, strict=True):
            if row["evidence"] == "lower bound" and column in ("critical_step", "critical_courant"):
                assert row[column] == ""
            else:
                assert same(row[column], value), (column, row, value)
    assert [row["evidence"] for row in rows] == found._map.evidence()
    if found.limit == "spectrum":
        assert all(same(row["omega_max"], w) for row, w in zip(rows, found.omega_max.ravel(), strict=True))


SPECTRUM = [
    ("signorini", "lumped", "auto"),
    ("symmetric", "averaged", "auto"),
    ("hunek", "consistent", "auto"),
    ("hunek", "0.3", "closed-form"),
    ("symmetric", "consistent", "secular"),
    ("hunek", "lumped", "sturm"),
    ("bouncing-bar", "consistent", "dense"),
]


@pytest.mark.parametrize(("scene", "mass", "engine"), SPECTRUM)
def test_spectrum(tools, scene, mass, engine):
    rows = tools("stability-map", *options(scene, mass, "spectrum", engine=engine))
    gamma = float(mass) if mass[0].isdigit() else mass
    model = bp.Model.from_scene(scene, mass=gamma)
    assert_map(rows, model.stability_map(BETA_S, RATIO, engine=engine))


@pytest.mark.parametrize("scene", ["signorini", "hunek"])
@pytest.mark.parametrize("limit", ["central-difference", "predictor-corrector", "park"])
def test_schemes(tools, scene, limit):
    rows = tools("stability-map", *options(scene, "averaged", limit))
    model = bp.Model.from_scene(scene, mass="averaged")
    assert_map(rows, model.stability_map(BETA_S, RATIO, limit=limit))


def test_theta(tools):
    rows = tools("stability-map", *options("signorini", "lumped", "park", theta="0.8"))
    model = bp.Model.from_scene("signorini", mass="lumped")
    assert_map(rows, model.stability_map(BETA_S, RATIO, limit="park", theta=0.8))


def test_diagonalised(tools):
    rows = tools("stability-map", *options("symmetric", "lumped", "spectrum", penalty_mass="diagonalised"))
    model = bp.Model.from_scene("symmetric", penalty_mass="diagonalised")
    assert_map(rows, model.stability_map(BETA_S, RATIO))


DAMPING = bp.Damping(3.0, 1e-5, 2e-5)
DAMPED = {"damping-mass": "3", "damping-stiffness": "1e-5", "damping-contact": "2e-5"}
EXPLICIT = [
    ("noh-bathe", None),
    ("noh-bathe", 0.6),
    ("chung-lee", 1.01),
    ("tchamwa-wielgosz", 1.05),
    ("generalised-alpha", 0.5),
]


@pytest.mark.parametrize("scene", ["signorini", "hunek"])
@pytest.mark.parametrize("limit", ["spectrum", "central-difference", "predictor-corrector"])
def test_damping(tools, scene, limit):
    rows = tools("stability-map", *options(scene, "consistent", limit, **DAMPED))
    found = bp.Model.from_scene(scene, mass="consistent").stability_map(BETA_S, RATIO, limit=limit, damping=DAMPING)
    assert_map(rows, found)
    assert {row["limit"] for row in rows} == {found.limit}


@pytest.mark.parametrize(("limit", "parameter"), EXPLICIT)
def test_explicit_schemes(tools, limit, parameter):
    keywords = {} if parameter is None else {"parameter": parameter}
    rows = tools("stability-map", *options("symmetric", "averaged", limit, **keywords))
    model = bp.Model.from_scene("symmetric", mass="averaged")
    assert_map(rows, model.stability_map(BETA_S, RATIO, limit=limit, **keywords))


@pytest.mark.parametrize("scheme", ["central-difference", "predictor-corrector", "park"])
def test_impact(tmp_path, scheme):
    tool = ROOT / "target" / "release" / "contact-impact"
    command = [tool, "hunek", "--mass", "lumped", "--scheme", scheme, "--beta-s", "100", "--ratio", "1"]
    subprocess.run([*command, "--format", "csv", "--out", tmp_path, "--quiet"], check=True)
    (file,) = [path for path in tmp_path.glob("*.csv") if "stress" not in path.name and "summary" not in path.name]
    rows = list(csv.DictReader(file.open()))
    run = bp.Model.from_scene("hunek", mass="lumped").impact(100.0, 1.0, scheme=scheme)
    assert len(rows) == len(run.time) > 50
    force, gap = run.contact_force[:, 0], run.relative_gap[:, 0]
    for name, values in {"contact_force": force, "relative_gap": gap}.items():
        assert [float(row[name]) for row in rows] == values.tolist()
    for name in ("time", "kinetic_energy", "strain_energy", "contact_work", "penalty_energy", "body_work", "loss"):
        assert [float(row[name]) for row in rows] == getattr(run, name).tolist(), name


ENERGIES = ("kinetic_energy", "strain_energy", "contact_work", "penalty_energy", "body_work", "loss")


def assert_same_impact(folder, scene, run, *typed):
    """Every row, every contact and the summary of the tool are those of the package, to the bit."""
    tool = ROOT / "target" / "release" / "contact-impact"
    typed = ["--scheme", run.scheme, "--beta-s", repr(run.beta_s), "--ratio", repr(run.ratio), *typed]
    subprocess.run([tool, scene, *typed, "--format", "csv", "--out", folder, "--quiet"], check=False)
    (summary,) = csv.DictReader((folder / "summary.csv").open())
    (contacts,) = folder.glob("*-contacts.csv")
    rows = list(csv.DictReader((folder / contacts.name.replace("-contacts", "")).open()))
    contacts = list(csv.DictReader(contacts.open()))
    for name, values in {"contact_force": run.contact_force, "gap": run.gap}.items():
        assert [float(row[name]) for row in contacts] == values.ravel().tolist(), name
    assert [int(row["contact"]) for row in contacts[: run.gap.shape[1]]] == list(range(1, run.gap.shape[1] + 1))
    for name in ("time", *ENERGIES):
        assert [float(row[name]) for row in rows] == getattr(run, name).tolist(), name
    assert [float(row["largest_gap"]) for row in rows] == run.gap.max(axis=1).tolist()
    exact = [row["exact_force"] for row in rows]
    assert exact == [""] * len(rows) if run.exact_force is None else list(map(float, exact)) == run.exact_force.tolist()
    for name in ("time_step", "force_error", "energy_ratio", "switches"):
        value = getattr(run, name)
        assert summary[name] == "" if value is None else float(summary[name]) == value, name
    return rows, summary


IMPACT = """
[impact]
duration = 4e-3
gaps = [1e-4]
gravity = [0.0, -3e4]
"""
MATRIX_IMPACT = """
[impact]
duration = 4e-3
velocity = "v.mtx"
load = "f.mtx"
gaps = "g.mtx"
"""
SCHEMES = ["central-difference", "predictor-corrector", "park", "buffered", "lagrange"]


@pytest.fixture
def thrown_file(scene_file):
    """Return the scene with bodies on their way to each other; vectors that matrices need lie beside it."""
    text = scene_file.read_text()
    if "[[body]]" in text:
        text = text.replace("density = 2700.0", "density = 2700.0\nvelocity = [0.3, -2.0]") + IMPACT
        text = text.replace("density = 7850.0", "density = 7850.0\nvelocity = [0.0, 0.1]")
    else:
        text += MATRIX_IMPACT
        model, rng = bp.Model.from_scene(scene_file), np.random.default_rng(3)
        n, k = model.unknowns, model.contacts
        vectors = {"v": rng.uniform(-2, 2, n), "f": rng.uniform(-1e5, 1e5, n), "g": rng.uniform(-2e-4, 1e-5, k)}
        for name, vector in vectors.items():
            mmwrite(scene_file.parent / f"{name}.mtx", vector[:, np.newaxis], precision=17)
    scene_file.write_text(text)
    return scene_file


@pytest.mark.parametrize("scheme", SCHEMES)
def test_impacts_of_meshes_and_matrices(thrown_file, tmp_path, scheme):
    run = bp.Model.from_scene(thrown_file).impact(30.0, 0.25, scheme=scheme, relative_courant=0.7, every=3)
    typed = ["--relative-courant", "0.7", "--every", "3"]
    rows, summary = assert_same_impact(tmp_path / "out", thrown_file, run, *typed)
    assert len(rows) > 20
    assert run.switches > 0
    assert run.contact_force.max() > 0.0
    assert np.ptp(run.body_work) > 0.0
    # A step more than was asked for, or none, would be another run.
    assert run.steps == round(float(rows[-1]["time"]) / run.time_step)
    assert (summary["energy_ratio"] == "") == (run.energy_ratio is None)


@pytest.mark.parametrize("scene_file", ["matrices"], indirect=True)
def test_impact_of_matrices_in_memory(thrown_file, tmp_path):
    """What is given by keyword is what files of the scene give."""
    K, M, Z, w = bp.Model.from_scene(thrown_file).matrices()
    vectors = {name: mmread(thrown_file.parent / f"{name[0]}.mtx").ravel() for name in ("velocity", "gaps")} | {
        "load": mmread(thrown_file.parent / "f.mtx").ravel()
    }
    run = bp.Model.from_matrices(K, M, Z, scales=w).impact(30.0, np.inf, duration=4e-3, **vectors)
    rows, _ = assert_same_impact(tmp_path / "out", thrown_file, run)
    assert len(rows) > 50
    # Each of the three replaces what the scene says.
    scene = bp.Model.from_scene(thrown_file)
    for name, vector in vectors.items():
        other = scene.impact(30.0, np.inf, **{name: 0.5 * vector})
        assert (other.energy != run.energy).any(), name
        again = scene.impact(30.0, np.inf, **{name: vector})
        assert (again.energy == run.energy).all(), name


def test_impact_of_a_box_that_moves_as_a_bar(tmp_path):
    """A mesh with an exact solution is compared with it, as the tool does."""
    scene = ROOT / "analyses" / "scenes" / "plane-impact.toml"
    model = bp.Model.from_scene(scene)
    run = model.impact(1e3, 1.0)
    assert_same_impact(tmp_path / "out", scene, run)
    assert run.exact_force.max() > 0.0
    assert 0.0 < run.force_error < 1.0
    # It is that of the scene only.
    assert model.impact(1e3, 1.0, velocity=-0.1).exact_force is None


def test_csv(tools, tmp_path):
    """What to_csv writes reads back as the records of the tool."""
    rows = tools("stability-map", *options("hunek", "lumped", "predictor-corrector"))
    bp.Model.from_scene("hunek").stability_map(BETA_S, RATIO, limit="predictor-corrector").to_csv(tmp_path / "map.csv")
    written = list(csv.DictReader((tmp_path / "map.csv").open()))
    assert_same_rows(written, rows)


def assert_same_rows(written, rows):
    assert list(written[0]) == list(rows[0])
    numbers = [name for name in rows[0] if name not in ("scene", "mass", "limit", "engine", "evidence")]
    for mine, theirs in zip(written, rows, strict=True):
        assert all(mine[name] == theirs[name] for name in mine if name not in numbers)
        for name in numbers:
            assert (mine[name] == "") == (theirs[name] == "")
            assert mine[name] == "" or float(mine[name]) == float(theirs[name])


@pytest.mark.parametrize("limit", ["spectrum", "predictor-corrector"])
def test_meshes(tools, scene_file, tmp_path, limit):
    """The first question to a model: what it knows already would narrow the answer."""
    asked = [scene_file, "--limit", limit, "--beta-s", spec(BETA_S), "--ratio", spec(RATIO)]
    rows = tools("stability-map", *asked)
    found = bp.Model.from_scene(scene_file).stability_map(BETA_S, RATIO, limit=limit)
    assert_map(rows, found)
    found.to_csv(tmp_path / "map.csv")
    assert_same_rows(list(csv.DictReader((tmp_path / "map.csv").open())), rows)


ASKED = {
    "damped": (["--damping-mass", "30", "--damping-stiffness", "1e-6"], {"damping": (30.0, 1e-6, 0.0)}),
    "noh-bathe": (["--limit", "noh-bathe", "--parameter", "0.6"], {"limit": "noh-bathe", "parameter": 0.6}),
    "tolerance": (["--tolerance", "1e-5"], {"tolerance": 1e-5}),
}


@pytest.mark.parametrize("name", ASKED)
def test_meshes_with_more_keywords(tools, scene_file, name):
    typed, keywords = ASKED[name]
    rows = tools("stability-map", scene_file, "--beta-s", spec(BETA_S), "--ratio", spec(RATIO), *typed)
    assert_map(rows, bp.Model.from_scene(scene_file).stability_map(BETA_S, RATIO, **keywords))


@pytest.mark.parametrize("scene_file", ["mesh"], indirect=True)
def test_patches(tools, scene_file):
    asked = [scene_file, "--beta-s", spec(BETA_S), "--ratio", spec(RATIO), "--patch", "3", "--tolerance", "1"]
    rows = tools("stability-map", *asked)
    found = bp.Model.from_scene(scene_file).stability_map(BETA_S, RATIO, patch=3, tolerance=1.0)
    assert_map(rows, found)
    assert set(found._map.engines()) == {"convex-patches"}


@pytest.mark.parametrize("scene_file", ["matrices"], indirect=True)
def test_matrices_in_memory(tools, scene_file):
    rows = tools("stability-map", scene_file, "--beta-s", spec(BETA_S), "--ratio", spec(RATIO))
    K, M, Z, w = bp.Model.from_scene(scene_file).matrices()
    assert_map(rows, bp.Model.from_matrices(K, M, Z, scales=w).stability_map(BETA_S, RATIO))
