"""Single answers have the numbers of the command line, to the bit: 50 of every kind, of bars, a mesh and matrices."""

import bipenalty as bp
import numpy as np
import pytest
from conftest import BETA_S, RATIO, same, write_scenes

POINTS = [(beta_s, ratio) for beta_s in BETA_S for ratio in RATIO]


@pytest.fixture(params=["bars", "mesh", "matrices"])
def asked(request, tmp_path):
    """Return what a tool is given, and what makes the same model anew: what it knows already narrows an answer."""
    if request.param == "bars":
        typed = ["hunek", "--mass", "consistent", "--elements", "7"]
        return typed, lambda: bp.Model.from_scene("hunek", mass="consistent", elements=7)
    # As many steps as stepping takes for each of 50 points are bearable for a few elements only.
    path = write_scenes(tmp_path, cells=("[2, 2]", "[1, 1]"))[request.param]
    return [path], lambda: bp.Model.from_scene(path)


def test_critical_step(tools, asked):
    typed, make = asked
    for beta_s, ratio in POINTS:
        (row,) = tools("stability-map", *typed, "--beta-s", beta_s, "--ratio", ratio)
        if row["evidence"] == "":
            with pytest.raises(bp.Uncertified):
                make().critical_step(beta_s, ratio)
            continue
        found = make().critical_step(beta_s, ratio)
        assert (float(row["critical_step"]), float(row["critical_courant"])) == (found.value, found.courant)
        assert (float(row["step_lower"]), float(row["step_upper"])) == (found.lower, found.upper)
        assert (float(row["lower"]), float(row["upper"])) == (found.courant_lower, found.courant_upper)
        assert (row["engine"], row["evidence"]) == (found.engine, found.evidence)
        assert float(row["omega_max"]) == found.omega_max


@pytest.mark.parametrize("elements", [1, 200])
def test_a_point_is_that_of_a_map(elements):
    """A point of bars is the same as on a map: of a curve of one point, which begins nowhere."""
    model = bp.Model.from_scene("signorini", mass="consistent", elements=elements)
    for beta_s, ratio in POINTS:
        point, found = model.critical_step(beta_s, ratio), model.stability_map(beta_s, ratio)
        assert found.critical_step[0, 0] == point.value
        for name in ("lower", "upper", "courant", "courant_lower", "courant_upper", "omega_max"):
            assert getattr(found, name)[0, 0] == getattr(point, name)


@pytest.mark.parametrize("limit", ["spectrum", "predictor-corrector", "park"])
def test_optimal_ratio(tools, asked, limit):
    typed, make = asked
    for beta_s in np.logspace(-3, 12, 50).tolist():
        (row,) = tools("optimal-ratio", *typed, "--limit", limit, "--beta-s", beta_s)
        found = make().optimal_ratio(beta_s, limit=limit)
        if row["lower"]:
            assert (float(row["lower"]), float(row["upper"])) == (found.lower, found.upper)
            assert found.upper == np.inf or float(row["optimal_ratio"]) == found.value
        else:
            assert found.lower == np.inf


LARGEST = {
    "spectrum": ([], {}),
    "predictor-corrector": (["--limit", "predictor-corrector"], {"limit": "predictor-corrector"}),
    "damped": (["--damping-stiffness", "1e-8"], {"damping": bp.Damping(stiffness=1e-8)}),
}


@pytest.mark.parametrize("name", LARGEST)
def test_largest_of_a_step(tools, asked, name):
    """Of pairs of a step and a ratio, and of a step and a beta_s, asked after what the tool asks for its rows."""
    typed, make = asked
    keywords = LARGEST[name][1]
    free = make().critical_step(0.0).value
    finite = 0
    for share in (0.2, 0.5, 0.7, 0.8, 0.97):
        for ratio, beta_s in zip([0.9, *np.logspace(0.5, 3, 11), np.inf], np.logspace(0, 9, 13), strict=True):
            step = ["--time-step", share * free, "--beta-s", beta_s, "--ratio", ratio]
            (row,) = tools("stability-map", *typed, *LARGEST[name][0], *step)
            model = make()
            model.stability_map(beta_s, ratio, **keywords)
            model.stability_map(beta_s, 1.0, **keywords)
            model.critical_step(0.0, **keywords)
            other = model.largest_ratio(share * free, beta_s, **keywords)
            most = model.largest_penalty(share * free, ratio, **keywords)
            for column, found in (("largest_stiffness_penalty", most), ("largest_ratio", other)):
                value, lower, upper = (row[column + end] for end in ("", "_lower", "_upper"))
                assert same(value, found)
                assert same(lower, found.lower)
                assert same(upper, found.upper)
            finite += np.isfinite(found.lower)
    assert finite > 50


SCHEMES = ["central-difference", "predictor-corrector", "park"]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_verify(tools, asked, scheme):
    typed, make = asked
    for beta_s, ratio in POINTS:
        point = ["--beta-s", beta_s, "--ratio", ratio, "--tolerance", "1e-2"]
        (row,) = tools("verify-limits", *typed, "--scheme", scheme, *point)
        seen = make().verify(beta_s, ratio, scheme=scheme, tolerance=1e-2)
        assert (float(row["stable_step"]), float(row["unstable_step"])) == (seen.stable_at, seen.unstable_at)
        assert (float(row["growth"]), int(row["steps"])) == (seen.growth, seen.steps)
        assert {True: "true", False: "false", None: ""}[seen.agrees] == row["agrees"]
        assert float(row["predicted_step"]) == seen.predicted
