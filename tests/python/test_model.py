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
        (lambda m: m.critical_step(1.0, limit="central_difference"), ["did you mean central-difference?"]),
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
        (lambda m: bp.Model.from_scene("hunek").impact(1.0, 1.0, every=-1), ["every", "-1"]),
        (lambda m: bp.Model.from_scene("hunek").impact(1.0, 1.0, velocity=1.0), ["velocity", "[[bar]]"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0), ["velocity", "block", "[impact]"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0, velocity=1.0), ["duration", "[impact]"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0, load=[1.0], duration=1.0), ["load", "(1,)", "[56]"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0, velocity=np.inf, duration=1.0), ["velocity", "finite"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0, velocity=1.0, duration=1.0, gaps="0"), ["gaps", "real"]),
        (lambda m: bp.Model.from_scene(BLOCK).impact(1.0, 1.0, velocity=1.0, duration=1e300), ["duration", "steps"]),
        (lambda m: m.critical_step(1.0, parameter=1.0), ["parameter", "spectrum", "noh-bathe"]),
        (lambda m: m.critical_step(1.0, limit="noh-bathe", parameter=0.8), ["noh-bathe, p", "0.8", "0.5 to 0.75"]),
        (lambda m: m.critical_step(1.0, damping=(0, -1, 0)), ["damping, stiffness", "-1", "at least 0"]),
        (lambda m: m.critical_step(1.0, damping=1e-3), ["damping", "0.001", "three numbers"]),
        (lambda m: m.critical_step(1.0, damping=bp.Damping(1.0), limit="park"), ["damping", "park"]),
        (lambda m: m.critical_step(1.0, damping=bp.Damping(1.0), limit="chung-lee"), ["damping", "chung-lee"]),
        (lambda m: m.optimal_ratio(1.0, damping=bp.Damping(1.0)), ["damped", "no damping"]),
        (lambda m: m.critical_step(1.0, patch=4), ["patch", "4", "bars"]),
        (lambda m: bp.Model.from_scene(BLOCK).critical_step(1.0, patch=0), ["patch", "0", "at least 1"]),
        (lambda m: bp.Model.from_scene(BLOCK).critical_step(1.0, patch=-1), ["patch", "-1", "at least 1"]),
        (lambda m: line().critical_step(1.0, patch=2), ["patch", "2", "[[body]]"]),
        (lambda m: m.verify(1.0, 1.0, scheme="park", damping=bp.Damping(1.0)), ["damping", "park"]),
        (lambda m: m.verify(1.0, 1.0, scheme="noh-bathe"), ["scheme", "noh-bathe", "central-difference"]),
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
    asks = [lambda: model.critical_step("10"), lambda: model.critical_step([1.0, 2.0]), lambda: bp.Model()]
    wrong = [{"limit": 5}, {"limit": "park", "theta": "0.5"}, {"patch": 1.5}, {"tolerance": "a"}, {"engine": None}]
    asks += [lambda keywords=keywords: model.critical_step(1.0, **keywords) for keywords in wrong]
    for ask in asks:
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
    most = model.largest_penalty(4e-7, 2.0)
    assert most.lower < most < most.upper < np.inf
    for result in (model.critical_step(1.0, 2.0), model.optimal_ratio(1.0), most):
        for again in (copy.copy(result), pickle.loads(pickle.dumps(result))):
            assert again == result
            assert repr(again) == repr(result)
            assert (again.lower, again.upper) == (result.lower, result.upper)


def line():
    K = 2.0 * np.eye(6) - np.eye(6, k=1) - np.eye(6, k=-1)
    return bp.Model.from_matrices(K, np.ones(6), np.eye(6)[:, [5, 2]], scales=[2.0, 1.0], reference=3.0)


def made(tmp_path):
    path = tmp_path / "bar.toml"
    path.write_text(BAR)
    other = bp.Model.from_scene("hunek", mass=0.3, elements=40, penalty_mass="diagonalised")
    return [bp.Model.from_scene(path), bp.Model.from_scene(BLOCK, mass="consistent"), other, line()]


def test_models_and_maps_are_pickled(tmp_path):
    for model in made(tmp_path):
        again = pickle.loads(pickle.dumps(model))
        assert repr(again) == repr(model)
        assert again.reference == model.reference
        asked = ([1.0, 100.0], [0.5, np.inf])
        found = model.stability_map(*asked)
        assert (again.stability_map(*asked).lower == found.lower).all()
        for kept in (pickle.loads(pickle.dumps(found)), copy.deepcopy(found), copy.copy(found)):
            assert repr(kept) == repr(found)
            assert list(kept._rows()) == list(found._rows())
            assert kept.seconds == found.seconds
        run = pickle.loads(pickle.dumps(bp.Model.from_scene("hunek").impact(1.0, 1.0)))
        assert run.contact_force.shape == (len(run.time), 1)


def test_a_relative_path_is_found_from_elsewhere(tmp_path, monkeypatch):
    made(tmp_path)
    monkeypatch.chdir(tmp_path)
    saved = pickle.dumps(bp.Model.from_scene("bar.toml"))
    monkeypatch.chdir(tmp_path.parent)
    assert pickle.loads(saved).name == "on-a-wall"


def test_models_stay_as_they_are():
    model = bp.Model.from_scene(BAR)
    assert copy.copy(model) is copy.deepcopy(model) is model
    for change in (
        lambda: setattr(model, "contacts", 7),
        lambda: delattr(model, "name"),
        lambda: setattr(model, "x", 1),
    ):
        with pytest.raises(AttributeError):
            change()


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


THROWN = BLOCK.replace("density = 1.0", "density = 1.0\nvelocity = [0.0, -0.01]") + "[impact]\nduration = 5.0\n"


def test_impact_of_a_mesh():
    model = bp.Model.from_scene(THROWN)
    run = model.impact(1e3, 0.25, scheme="buffered")
    assert run.contact_force.shape == run.gap.shape == (len(run.time), 7)
    assert (run.relative_gap, run.exact_force, run.force_error) == (None, None, None)
    assert run.time_step <= 0.5 * model.critical_step(0.0).value
    assert run.resultant.max() > 0.0
    # The buffer of closed contacts has taken its share from 0.5 * 2 * 0.01^2 J.
    assert 0.8e-4 < run.kinetic_energy[0] < 1e-4
    balance = run.energy + run.loss - run.body_work
    assert balance == pytest.approx(balance[0], rel=1e-12)
    assert run.energy_ratio == pytest.approx(run.energy[-1] / run.energy[0])


def test_impact_of_matrices_is_that_of_their_mesh():
    mesh = bp.Model.from_scene(THROWN)
    K, M, Z, w = mesh.matrices()
    model = bp.Model.from_matrices(K, M, Z, scales=w, reference=mesh.reference)
    velocity = np.zeros(model.unknowns)
    velocity[1::2] = -0.01
    for scheme in ("central-difference", "predictor-corrector", "park", "lagrange"):
        want = mesh.impact(1e3, 0.25, scheme=scheme)
        run = model.impact(1e3, 0.25, scheme=scheme, velocity=velocity, duration=5.0)
        assert run.time_step == pytest.approx(want.time_step, rel=1e-9)
        assert run.contact_force == pytest.approx(want.contact_force, rel=1e-6, abs=1e-9)
        assert run.energy_ratio == pytest.approx(want.energy_ratio, rel=1e-6)


def test_impact_by_a_load_across_a_gap():
    """Two masses free to move, one pushed by 3 N: it closes 0.5 m to a wall after sqrt(2 m g0/f)."""
    model = bp.Model.from_matrices(np.diag([1e-9, 1e-9]), [6.0, 6.0], [[1.0], [0.0]], scales=1e3)
    run = model.impact(1.0, np.inf, load=[3.0, 0.0], gaps=-0.5, duration=2.0, relative_courant=1e-8)
    closes = run.time[np.argmax(run.contact_force[:, 0] > 0.0)]
    assert closes == pytest.approx(np.sqrt(2.0), rel=1e-2)
    assert run.energy_ratio is None


def test_damping_and_other_schemes():
    model = bp.Model.from_scene(BAR)
    free = model.critical_step(0.0).value
    omega, xi = 2.0 / free, 0.1
    slow = model.critical_step(0.0, damping=bp.Damping(stiffness=2 * xi / omega))
    assert slow.value == pytest.approx(free * (np.sqrt(1 + xi**2) - xi), rel=1e-12)
    assert slow.limit == "damped-central-difference"
    assert model.critical_step(5.0, 2.0, damping=bp.Damping()) == model.critical_step(5.0, 2.0)
    for scheme, (longer, parameter) in {"chung-lee": (1.0, 1.0), "noh-bathe": (1.8725, None)}.items():
        found = model.critical_step(0.0, limit=scheme, parameter=parameter)
        assert found.value == pytest.approx(longer * free, rel=1e-4)
        most = model.largest_penalty(0.7 * found.value, 3.0, limit=scheme, parameter=parameter)
        assert most == pytest.approx(model.largest_penalty(0.7 * free, 3.0), rel=1e-4)
    most = model.largest_penalty(0.7 * slow.value, 3.0, damping=(0.0, 2 * xi / omega, 0.0))
    assert model.critical_step(most.lower, 3.0, damping=(0.0, 2 * xi / omega, 0.0)).upper >= 0.7 * slow.value
    seen = model.verify(10.0, 2.0, damping=bp.Damping(stiffness=2 * xi / omega))
    assert seen.agrees
    with pytest.raises(ValueError, match=r"^time_step: .* limit without contact"):
        model.largest_penalty(free, damping=(0, 1e-3, 0))


def test_patches_give_another_proof():
    model = bp.Model.from_scene(BLOCK)
    whole = model.critical_step(10.0, 2.0)
    patched = model.critical_step(10.0, 2.0, patch=2, tolerance=1.0)
    assert patched.engine == "convex-patches"
    assert patched.lower <= whole.upper
    assert whole.lower <= patched.upper


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
