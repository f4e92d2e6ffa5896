"""Figures with matplotlib, in the look of the figures of the command line tools."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

_Result = TypeVar("_Result")

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from ._results import Impact, StabilityMap

# Qualitative colours of Okabe and Ito, and dashes in mm that keep the curves apart in grey print.
SERIES = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#e69f00", "#56b4e9", "#787878", "#8c8c8c"]
DASHES: list[tuple[float, ...]] = [
    (),
    (2.2, 0.9),
    (0.5, 0.7),
    (2.4, 0.7, 0.5, 0.7),
    (1.1, 0.6),
    (2.4, 0.6, 0.5, 0.6, 0.5, 0.6),
    (4.0, 0.7, 1.3, 0.7),
    (0.4, 1.3),
    (),
]
SHADE, GREY, MISSING = "#dfeaf2", "#5a5a5a", "#bebebe"
# Of curves and thin lines, pt.
CURVE, THIN, CASING = 1.0, 0.6, 1.5
# The ratios of the paper keep their style in every chart.
PAPER = {1.0: 0, 2.0: 1, 3.0: 2, 0.5: 3, np.inf: 4, 0.25: 5}
STYLES = 8
# More ratios are drawn as a map.
MOST_CURVES = 12
# Levels worth a contour line.
ROUND = [m * 10.0**e for e in range(-6, 1) for m in (1, 2, 5)]
# So close to the limit without contact that a penalty costs nothing.
FREE = 0.999
MOST_LINES = 5

# Any: matplotlib lists every name.
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8,
    "axes.linewidth": 0.5,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.minor.width": 0.5,
    "ytick.minor.width": 0.5,
    "xtick.minor.visible": True,
    "ytick.minor.visible": True,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "mathtext.default": "regular",
    "figure.dpi": 150,
}


def _in_style(draw: Callable[[_Result, Axes | None], Axes]) -> Callable[[_Result, Axes | None], Axes]:
    def drawn(result: _Result, ax: Axes | None) -> Axes:
        try:
            from matplotlib import rc_context
        except ImportError:
            raise ImportError("plots need matplotlib: pip install bipenalty[plot]") from None
        with rc_context(STYLE):
            return draw(result, ax)

    return drawn


def _axes(ax: Axes | None, width: float = 90.0, height: float = 62.0) -> Axes:
    """Return the axes to draw on, in our look; sizes in mm."""
    if ax is not None:
        # Axes keep the style that they were made in.
        ax.tick_params(labelsize=STYLE["xtick.labelsize"], width=STYLE["xtick.major.width"], which="both")
        for spine in ax.spines.values():
            spine.set_linewidth(STYLE["axes.linewidth"])
        for text in (ax.xaxis.label, ax.yaxis.label):
            text.set_fontsize(STYLE["axes.labelsize"])
        ax.title.set_fontsize(STYLE["axes.titlesize"])
        ax.minorticks_on()
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots(figsize=(width / 25.4, height / 25.4), layout="constrained")[1]


def _styles(ratios: NDArray[np.float64]) -> dict[float, int]:
    known = {r: PAPER[r] for r in ratios.tolist() if r in PAPER}
    free = [style for style in range(STYLES) if style not in known.values()]
    free += [style for style in range(STYLES) if style in known.values()]
    others = [r for r in dict.fromkeys(ratios.tolist()) if r not in known]
    return known | {r: free[i % STYLES] for i, r in enumerate(others)}


def _line(style: int, width: float) -> dict[str, Any]:
    # matplotlib counts in widths of the line.
    dashes = [length * 72 / 25.4 / width for length in DASHES[style]]
    return {"color": SERIES[style], "linewidth": width, "linestyle": (0, tuple(dashes)) if dashes else "-"}


def _is_logarithmic(values: NDArray[np.float64]) -> bool:
    """Whether values are spread more evenly over a logarithmic axis than over a linear one."""
    values = np.sort(values)
    if len(values) < 2 or values[0] <= 0 or not np.isfinite(values).all():
        return False
    logs = np.log(values)
    return bool(np.diff(logs).max() / (logs[-1] - logs[0]) < np.diff(values).max() / (values[-1] - values[0]))


def _number(value: float) -> str:
    return "∞" if np.isinf(value) else f"{value:g}".replace("-", "−")


def _title(found: StabilityMap) -> str:
    model = found.model
    size = (
        f"{model.elements} element{'' if model.elements == 1 else 's'}"
        if model.elements
        else f"{model.unknowns} unknowns"
    )
    whose = [] if found.limit == "spectrum" else [found.limit]
    return ", ".join([model.name, size, *([model.mass] if model.mass else []), *whose])


@_in_style
def stability_map(found: StabilityMap, ax: Axes | None) -> Axes:
    """Draw curves for few ratios, a map for many."""
    ax = _axes(ax)
    if len(found.ratio) <= MOST_CURVES:
        _curves(found, ax)
    else:
        _map(found, ax)
    ax.set_xlabel("stiffness penalty $\\it{β}_{\\mathrm{s}}$")
    ax.set_title(_title(found))
    return ax


def _curves(found: StabilityMap, ax: Axes) -> None:
    order = np.argsort(found.beta_s)
    beta_s, courant = found.beta_s[order], found.courant[:, order]
    if _is_logarithmic(beta_s[beta_s > 0]) and (beta_s > 0).sum() > 1:
        ax.set_xscale("log")
        beta_s, courant = beta_s[beta_s > 0], courant[:, beta_s > 0]
    styles = _styles(found.ratio)
    lowest = np.min(courant, axis=0)
    low, high = np.nanmin(courant), np.nanmax(courant)
    air = 0.05 * (high - low) or 0.05 * high
    # No Courant number is below 0.
    bottom = max(low - air, 0.0)
    ax.fill_between(beta_s, lowest, bottom, color=SHADE, linewidth=0)
    for r, row in zip(found.ratio.tolist(), courant, strict=True):
        ax.plot(beta_s, row, label=f"$\\it{{r}}$ = {_number(r)}", **_line(styles[r], CURVE))
    ax.set_xlim(beta_s[0], beta_s[-1])
    ax.set_ylim(bottom, high + air)
    ax.set_ylabel("critical Courant number $\\it{C}_{\\mathrm{r}}$")
    _name_curves(ax)


def _name_curves(ax: Axes) -> None:
    """Write the name of every curve beside the frame, level with its end, as far as there is room."""
    low, high = ax.get_ylim()
    ends = [((float(np.asarray(line.get_ydata())[-1]) - low) / (high - low), line) for line in ax.get_lines()]
    ends = sorted((end for end in ends if np.isfinite(end[0])), key=lambda end: end[0])
    # A line of text takes 0.07 of the height.
    places: list[float] = []
    for share, _ in ends:
        places.append(max(share, places[-1] + 0.07) if places else share)
    places = [min(place, 1.0 - 0.07 * (len(places) - 1 - i)) for i, place in enumerate(places)]
    for (share, line), place in zip(ends, places, strict=True):
        ax.annotate(
            str(line.get_label()),
            xy=(1.0, share),
            xytext=(1.06, place),
            xycoords="axes fraction",
            va="center",
            color=line.get_color(),
            arrowprops={"arrowstyle": "-", "color": line.get_color(), "linewidth": THIN, "shrinkA": 0, "shrinkB": 0},
        )


def _map(found: StabilityMap, ax: Axes) -> None:
    from matplotlib import patheffects
    from matplotlib.colors import LogNorm

    columns, rows = np.argsort(found.beta_s), np.argsort(found.ratio)
    beta_s, ratio = found.beta_s[columns], found.ratio[rows]
    courant = found.courant[np.ix_(rows, columns)]
    # A logarithmic axis has no place for 0 and infinity.
    keep_x, keep_y = beta_s > 0, np.isfinite(ratio)
    beta_s, ratio, courant = beta_s[keep_x], ratio[keep_y], courant[np.ix_(keep_y, keep_x)]
    ax.set_facecolor(MISSING)
    ax.set_xscale("log")
    ax.set_yscale("log")
    cells = ax.pcolormesh(beta_s, ratio, courant, norm=LogNorm(), cmap="viridis", shading="nearest", rasterized=True)
    low, high = np.nanmin(courant), np.nanmax(courant)
    x, y = (float(beta_s[0]), float(beta_s[-1])), (float(ratio[0]), float(ratio[-1]))
    casing = [patheffects.withStroke(linewidth=CASING, foreground="white")]
    levels = [(level, _number(level)) for level in ROUND if 1.1 * low < level < 0.97 * high][-MOST_LINES:]
    for level, name in [*levels, *_free(found)]:
        line = found.model._core.contour(level, x, y, found._asked)
        if len(line):
            ax.plot(*line.T, color="black", linewidth=THIN, path_effects=casing)
            at = line[len(line) // 2]
            ax.annotate(name, at, ha="center", va="center", path_effects=casing)
        else:
            # No line is known for several contacts of a scheme: the grid tells where it runs.
            drawn = ax.contour(beta_s, ratio, courant, [level], colors="black", linewidths=THIN)
            ax.clabel(drawn, fmt=lambda _, name=name: name)
    if y[0] <= 1.0 <= y[1]:
        ax.axhline(1.0, color=GREY, linewidth=THIN, linestyle=":")
    ax.set_xlim(*x)
    ax.set_ylim(*y)
    ax.set_ylabel("penalty ratio $\\it{r}$")
    # Where only a strip of colours is met, there may be no other number.
    ticks = [level for level in ROUND if low <= level <= high] or [low, high]
    bar = ax.figure.colorbar(cells, ax=ax, label="$\\it{C}_{\\mathrm{r}}$")
    bar.ax.tick_params(labelsize=STYLE["ytick.labelsize"])
    bar.ax.minorticks_off()
    ticks = ticks[:: 1 + len(ticks) // 8]
    bar.set_ticks(ticks, labels=[f"{tick:.3g}" for tick in ticks])


def _free(found: StabilityMap) -> list[tuple[float, str]]:
    """Return the level that is hardly below the limit without contact, and its name."""
    free = float(found.model._core.map(np.zeros(1), np.full(1, np.inf), found._asked, None).array("courant")[0, 0])
    return [(FREE * free, f"{FREE} $\\it{{C}}_0$")] if np.isfinite(free) else []


@_in_style
def impact(run: Impact, ax: Axes | None) -> Axes:
    """Draw the forces of a few contacts over time, or the sum of many; the exact one beside them."""
    ax = _axes(ax)
    if run.exact_force is not None:
        ax.plot(run.time, run.exact_force, color="black", linewidth=THIN, label="exact")
    contacts = run.contact_force.shape[1]
    forces, name = (run.contact_force.T, "contact {}") if contacts <= STYLES else ([run.resultant], "all {} contacts")
    for contact, force in enumerate(forces):
        label = run.scheme if contacts == 1 else name.format(contact + 1 if contacts <= STYLES else contacts)
        ax.plot(run.time, force, label=label, **_line(contact % STYLES, CURVE))
    ax.set_xlabel("time, s")
    ax.set_ylabel("contact force, N")
    ax.set_title(
        f"{run.scheme}, $\\it{{β}}_{{\\mathrm{{s}}}}$ = {_number(run.beta_s)}, $\\it{{r}}$ = {_number(run.ratio)}"
    )
    ax.legend()
    return ax
