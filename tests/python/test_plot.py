"""Figures: in the look of the command line tools, with contour lines that are exact."""

import re

import bipenalty as bp
import matplotlib as mpl
import numpy as np
import pytest
from conftest import ROOT

mpl.use("agg")

from bipenalty import _plot
from matplotlib import pyplot as plt


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_colours_and_dashes_are_those_of_the_tools():
    theme = (ROOT / "analyses" / "figure" / "src" / "theme.rs").read_text()
    series = theme.split("const SERIES")[1].split("];")[0]
    colours = ["#{:02x}{:02x}{:02x}".format(*map(int, rgb)) for rgb in re.findall(r"\((\d+), (\d+), (\d+)\)", series)]
    assert colours == _plot.SERIES
    dashes = re.findall(r"&\[([^\]\[]*)\]", theme.split("const DASHES")[1].split("= [", 1)[1].split("];")[0])
    assert [tuple(float(x) for x in d.split(",") if x.strip()) for d in dashes] == _plot.DASHES
    for name, value in {"SHADE": _plot.SHADE, "GREY": _plot.GREY, "MISSING": _plot.MISSING}.items():
        rgb = re.search(rf"const {name}: Colour = \((\d+), (\d+), (\d+)\)", theme).groups()
        assert "#{:02x}{:02x}{:02x}".format(*map(int, rgb)) == value
    for name, value in {"CURVE_STROKE": _plot.CURVE, "THIN_STROKE": _plot.THIN, "CASING_STROKE": _plot.CASING}.items():
        assert float(re.search(rf"const {name}: f64 = ([\d.]+)", theme).group(1)) == value


def test_curves():
    ratio = [0.5, 1.0, 2.0, np.inf]
    found = bp.Model.from_scene("signorini").stability_map(np.linspace(0, 10, 41), ratio)
    ax = found.plot()
    lines = ax.get_lines()
    assert [line.get_label() for line in lines] == [f"$\\it{{r}}$ = {r}" for r in ("0.5", "1", "2", "∞")]
    for line, row in zip(lines, found.courant, strict=True):
        assert (line.get_ydata() == row).all()
    assert lines[1].get_color() == "#0072b2"
    assert "signorini" in ax.get_title()


def test_curves_on_given_axes_in_any_order():
    _, ax = plt.subplots()
    found = bp.Model.from_scene("signorini").stability_map([1e6, 0.0, 1e-2, 1.0, 1e3], [7.0])
    assert found.plot(ax) is ax
    assert ax.get_xscale() == "log"
    (line,) = ax.get_lines()
    assert line.get_xdata().tolist() == [1e-2, 1.0, 1e3, 1e6]


@pytest.mark.parametrize("limit", ["spectrum", "predictor-corrector", "park"])
@pytest.mark.parametrize("scene", ["signorini", "bouncing-bar"])
def test_contour_lines_are_exact(scene, limit):
    model = bp.Model.from_scene(scene)
    for level in (0.1, 0.4):
        line = model.contour(level, (1e-2, 1e8), (0.5, 500.0), limit=limit)
        assert len(line) > 50
        for beta_s, r in line[::40]:
            assert model.critical_step(beta_s, r, limit=limit).courant == pytest.approx(level, rel=1e-9)


def test_map():
    found = bp.Model.from_scene("hunek").stability_map(np.logspace(-2, 8, 31), np.logspace(-1, 3, 21))
    ax = found.plot()
    labels = {text.get_text() for text in ax.texts}
    assert {"0.05", "0.1", "0.2", "0.5", "0.999 $\\it{C}_0$"} <= labels
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")


def test_map_with_interpolated_lines():
    """Of several contacts no line of the Park scheme is known."""
    model = bp.Model.from_scene("symmetric")
    assert model.contacts == 1
    text = """
name = "two-walls"
[ends]
left = "wall"
right = "wall"
[[bar]]
length = 1.0
elements = 10
youngs_modulus = 1.0
density = 1.0
area = 1.0
"""
    model = bp.Model.from_scene(text)
    assert len(model.contour(0.4, (1e-2, 1e8), (0.5, 500.0), limit="park")) == 0
    ax = model.stability_map(np.logspace(-2, 8, 31), np.logspace(-1, 3, 21), limit="park").plot()
    assert len(ax.collections) > 1


def test_impact():
    ax = bp.Model.from_scene("signorini").impact(1e3, 1.0, scheme="park").plot()
    assert [line.get_label() for line in ax.get_lines()] == ["exact", "park"]
