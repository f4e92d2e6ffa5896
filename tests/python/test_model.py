"""Models, what they answer, and what they refuse."""

import copy
import pickle

import bipenalty as bp
import numpy as np
import pytest

BAR = """
name = "on-a-wall"
[ends]
right = "wall"
[[bar]]
length = 0.2
elements = 80
youngs_modulus = 210e9
density = 7850.0
area = 4e-4
"""
BLOCK = """
name = "block"
dimension = 2
plane = "strain"
[[body]]
name = "block"
box = [2.0, 1.0]
cells = [6, 3]
element = "quad4"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
[[contact]]
surfaces = ["block.bottom", "wall"]
"""


def test_scene_from_name_path_and_text(tmp_path):
    path = tmp_path / "bar.toml"
    path.write_text(BAR)
    models = [bp.Model.from_scene(scene) for scene in (BAR, path, str(path))]
    assert len({model.critical_step(3.0, 2.0).value for model in models}) == 1
    assert bp.Model.from_scene("signorini").critical_step(0.0).value == pytest.approx(1e-3)
    model = models[0]
    assert (model.name, model.mass, model.gamma) == ("on-a-wall", "lumped", 1.0)
    assert (model.elements, model.unknowns, model.contacts) == (80, 81, 1)
    assert model.reference == pytest.approx(4 * 210e9 / 7850 / (0.2 / 80) ** 2)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda m: bp.Model.from_scene("nowhere"), ["SCENE", "nowhere", "signorini"]),
        (lambda m: bp.Model.from_scene(BAR.replace("area", "surface")), ["line 10", "surface"]),
        (lambda m: bp.Model.from_scene(BAR.replace("80", "-8")), ["bar 1, elements", "-8"]),
        (lambda m: bp.Model.from_scene("hunek", mass="heavy"), ["mass", "heavy", "lumped"]),
        (lambda m: bp.Model.from_scene("hunek", mass=1.5), ["gamma", "1.5", "[0, 1]"]),
        (lambda m: bp.Model.from_scene("hunek", elements=0), ["elements", "0"]),
        (lambda m: bp.Model.from_scene("hunek", elements=10**9), ["elements", "100000000"]),
        (lambda m: bp.Model.from_scene("hunek", penalty_mass="none"), ["penalty_mass", "diagonalised"]),
        (lambda m: bp.Model.from_scene(BLOCK, elements=4), ["elements", "cells"]),
        (lambda m: m.critical_step(-1.0), ["beta_s", "-1", "at least 0"]),
        (lambda m: m.critical_step(np.nan), ["beta_s", "NaN"]),
        (lambda m: m.critical_step(1.0, 0.0), ["r: 0", "positive"]),
        (lambda m: m.critical_step(1e300, 1.0), ["beta_s"]),
        (lambda m: m.critical_step(1.0, limit="newmark"), ["limit", "newmark", "park"]),
        (lambda m: m.critical_step(1.0, engine="arpack"), ["engine", "arpack", "sturm"]),
        (lambda m: m.critical_step(1.0, engine="dense", limit="park"), ["engine", "dense", "auto"]),
        (lambda m: m.critical_step(1.0, theta=0.5), ["theta", "0.5"]),
        (lambda m: m.critical_step(1.0, limit="park", theta=2.0), ["theta", "2"]),
        (lambda m: m.stability_map([], [1.0]), ["grid", "0 x 1"]),
        (lambda m: m.stability_map([[1.0]], [1.0]), ["beta_s", "2 dimensions"]),
        (lambda m: m.stability_map(["1"], [1.0]), ["beta_s", "real numbers"]),
        (lambda m: m.stability_map([1.0, -1.0], [1.0]), ["beta_s", "-1"]),
        (lambda m: m.largest_penalty(-1.0), ["time step", "-1"]),
        (lambda m: m.largest_penalty(1.0), ["time_step", "limit without contact"]),
        (lambda m: m.verify(1.0, 1.0, tolerance=1.0), ["tolerance", "0.1"]),
        (lambda m: m.verify(1.0, 1.0, scheme="newmark"), ["scheme", "newmark"]),
        (lambda m: m.impact(1.0, 1.0), ["impact", "duration"]),
        (lambda m: bp.Model.from_scene("hunek").impact(1.0, 1.0, every=0), ["steps between records", "at least 1"]),
        (lambda m: bp.Model.from_scene("hunek").impact(1.0, 1.0, relative_courant=-1.0), ["Courant", "-1"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0), ["impact", "[[bar]]"]),
    ],
)
def test_refusals(ask, words):
    """A refusal names place, value and what is allowed."""
    with pytest.raises(ValueError, match=r".") as refusal:
        ask(bp.Model.from_scene(BAR))
    text = str(refusal.value)
    assert all(word in text for word in words), text


def test_wrong_types_are_type_errors():
    model = bp.Model.from_scene(BAR)
    for ask in (lambda: model.critical_step("10"), lambda: model.critical_step([1.0, 2.0]), lambda: bp.Model()):
        with pytest.raises(TypeError):
            ask()


def test_uncertified():
    """No enclosure is as narrow as asked: the stepping of a hopeless tolerance on a mesh says so."""
    model = bp.Model.from_scene(BLOCK)
    with pytest.raises(bp.Uncertified, match="enclosed to"):
        model.critical_step(1e12, np.inf, tolerance=1e-13)
    assert issubclass(bp.Uncertified, ArithmeticError)
    found = model.stability_map([1.0, 1e12], np.inf, tolerance=1e-13)
    assert not found.certified.all()
    assert np.isnan(found.critical_step[~found.certified]).all()


def test_answers_in_words():
    model = bp.Model.from_scene(BAR)
    step = model.critical_step(10.0, 2.0)
    assert repr(step).startswith(f"dt_cr = {step.value:.7g} s (linear limit of closed contact, enclosed to ")
    assert repr(step).endswith(f"; C_r = {step.courant:.7g}) for beta_s = 10, r = 2")
    assert float(step) == step.value
    assert "<table>" in step._repr_html_()
    assert "on-a-wall" in repr(model)
    assert "<caption>on-a-wall</caption>" in model._repr_html_()
    assert "r = 1 is the largest ratio" in repr(model.optimal_ratio(10.0))
    assert "no ratio costs a step" in repr(model.optimal_ratio(0.0))
    assert repr(model.largest_penalty(4e-7, 1.0)) == "inf (any will do)"
    assert "as predicted" in repr(model.verify(10.0, 2.0))
    found = model.stability_map([0.0, 1.0, 10.0], [1.0, np.inf])
    assert "2 ratios x 3 beta_s" in repr(found)
    assert found._repr_html_().count("<tr>") == 3
    assert "MORE THAN IT WAS GIVEN" in repr(bp.Model.from_scene("hunek").impact(1e3, 1.0, scheme="central-difference"))


def test_lower_bound():
    """Of several unlike contacts the predictor-corrector has a lower bound."""
    text = BAR.replace('right = "wall"', 'left = "wall"\nright = "wall"') + BAR.split("[[bar]]")[1].join(
        ["[[bar]]", ""]
    )
    model = bp.Model.from_scene(text.replace("4e-4\n\n", "4e-4\n").replace("4e-4", "1e-4", 1))
    step = model.critical_step(10.0, 1.0, limit="predictor-corrector")
    assert step.evidence == "lower bound"
    assert step.value == pytest.approx(step.lower, rel=1e-14)
    assert step.lower < step.upper
    assert "at least" in repr(step)


def test_results_can_be_copied():
    model = bp.Model.from_scene(BAR)
    for result in (model.critical_step(1.0, 2.0), model.optimal_ratio(1.0), model.largest_penalty(4e-7, 2.0)):
        for again in (copy.copy(result), pickle.loads(pickle.dumps(result))):
            assert again == result
            assert repr(again) == repr(result)


def test_map_in_any_order():
    model = bp.Model.from_scene("symmetric", mass="consistent")
    beta_s, ratio = [1e3, 0.0, 7.0], [np.inf, 0.5]
    found = model.stability_map(beta_s, ratio)
    assert found.critical_step.shape == (2, 3)
    for i, r in enumerate(ratio):
        for j, b in enumerate(beta_s):
            point = model.critical_step(b, r)
            assert found.lower[i, j] <= point.upper
            assert point.lower <= found.upper[i, j]


def test_governs():
    found = bp.Model.from_scene(BLOCK).governs(1e3)
    assert found.contact_energy > 0.99
    assert sum(contact.share for contact in found.contacts) == pytest.approx(1.0)
    assert found.contacts[0].place.startswith("at (")
    assert "more" in repr(found)


def test_largest_penalty_is_the_inverse():
    for scene in (BAR, BLOCK):
        model = bp.Model.from_scene(scene)
        step = 0.7 * model.critical_step(0.0).value
        most = model.largest_penalty(step, 3.0)
        assert model.critical_step(most.lower, 3.0).upper >= step
        assert model.critical_step(most * 1.001, 3.0).upper < step
        ratio = model.largest_ratio(step, 1e3)
        assert model.critical_step(1e3, ratio.lower).upper >= step
        assert model.critical_step(1e3, ratio * 1.001).upper < step


def test_impact():
    run = bp.Model.from_scene("signorini", elements=100).impact(1e4, 0.25, relative_courant=0.9)
    assert run.contact_force.shape == run.gap.shape == (len(run.time), 1)
    third = len(run.time) // 3
    assert run.contact_force[third, 0] == pytest.approx(0.1, rel=0.05)
    assert run.exact_force[third] == pytest.approx(0.1)
    assert run.energy_ratio < 1.0
    assert run.energy[0] == pytest.approx(run.kinetic_energy[0])
    held = run.energy + run.loss - run.body_work
    assert held == pytest.approx(held[0], rel=1e-12)
