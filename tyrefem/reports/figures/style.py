"""Common style of the pictures: colours for colour blindness and grey print, sizes, units, labels, saving."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.output import command_arguments

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


#: Okabe & Ito (2008), distinguishable with common colour blindness; without yellow, which is too pale on white.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#8C510A")
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))


#: Light fills of regions, by their order in the section.
FILLS = (
    "#f3d9b1", "#bcd4e6", "#cfe3c4", "#e3cfe0", "#e0e0e0", "#f5efb8",
    "#d9a58b", "#8fb3d1", "#9cc59a", "#b9a0c8", "#b5b5b5", "#d8c766",
    "#f2b6b6", "#a8dadc", "#c9d36b", "#d7bfa6", "#8aa29e", "#e6a5cf",
)  # fmt: skip
INK, QUIET = "#1b1b1b", "#6a6a6a"
GENERATED, SLIDING, STORED, LOST = "#D55E00", "#8C510A", "#0072B2", "#009E73"


#: Perceptually uniform; the second for quantities other than temperature.
ENERGY_MAP = "viridis"
#: Smallest range of temperatures that is drawn as a range, K.
EVEN = 0.01
DPI = 110
FONT = 9.0


def figure(width: float, height: float) -> Figure:
    """An empty figure, size in inches. `add_axes` places its parts, because automatic layout doubles the time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    without_latex()
    made = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(made)
    return made


def without_latex() -> None:
    """For a command, switch off that matplotlib's settings of the user ask for LaTeX: names of regions are none."""
    from matplotlib import rcParams

    if command_arguments():
        rcParams["text.usetex"] = False


def add_axes(drawn: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Add axes at a place, inches."""
    w, h = drawn.get_size_inches()
    axes = drawn.add_axes((left / w, bottom / h, width / w, height / h))
    axes.set_title("", y=1.0)  # without a stated place, the ticks of all axes are measured for their titles
    return axes


def panel_title(axes: Axes, text: str, *, size: float = FONT, pad: float = 3.0) -> None:
    """Write a text above the left end of axes."""
    axes.set_title(text, fontsize=size, loc="left", pad=pad, y=1.0)


def legend(drawn: Figure, handles: Sequence[Any]) -> None:
    """One legend for all panels, at the upper right."""
    width, height = drawn.get_size_inches()
    drawn.legend(
        handles=list(handles), loc="upper right", bbox_to_anchor=(1 - 0.05 / width, 1 - 0.28 / height),
        ncols=len(handles), fontsize=FONT, frameon=False, handlelength=1.6, columnspacing=1.2,
    )  # fmt: skip


def png(drawn: Figure) -> bytes:
    """The figure as a PNG file's bytes."""
    return picture(drawn, ".png")


def picture(drawn: Figure, suffix: str) -> bytes:
    """The figure as bytes of a file type of `tyrefem.output.file.PICTURES`; equal figures give equal bytes."""
    from matplotlib import rc_context

    stream, form = io.BytesIO(), suffix.lower().lstrip(".")
    options: dict[str, dict[str, Any]] = {
        "png": {"metadata": {"Software": "tyrefem"}, "pil_kwargs": {"compress_level": 4}},
        "pdf": {"metadata": {"Creator": "tyrefem", "CreationDate": None}},
        "svg": {"metadata": {"Creator": "tyrefem", "Date": None}},
    }
    # Where an axis has no label, its place need not be searched: that measures all ticks again.
    for axis in (axis for axes in drawn.axes for axis in (axes.xaxis, axes.yaxis) if not axis.get_label_text()):
        axis.set_label_coords(0.5, 0.0)
    with rc_context({"svg.hashsalt": "tyrefem"}):
        drawn.savefig(stream, format=form, dpi=DPI, facecolor="white", **options[form])
    return stream.getvalue()


def plain(text: object) -> str:
    """Escape dollar signs in a text, which would start a formula.

    >>> print(plain("cost $3"))
    cost \\$3
    """
    return str(text).replace("$", r"\$")


def temperature_map() -> Any:
    """Colours of temperatures: perceptually uniform "inferno" without its near-black and near-white ends."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("tyre", colormaps["inferno"](np.linspace(0.14, 0.96, 128)))


def short(text: object, length: int = 28) -> str:
    """Cut a text to ``length`` characters.

    >>> short("a thermocouple with a very long name", 12)
    'a thermocou…'
    """
    words = str(text)
    return plain(words if len(words) <= length else words[: length - 1] + "…")


def line_style(number: int) -> dict[str, Any]:
    """Colour and dashes of the n-th line; the dashes change when the colours repeat."""
    return {"color": PALETTE[number % len(PALETTE)], "ls": DASHES[number // len(PALETTE) % len(DASHES)]}


def time_unit(last: float) -> tuple[float, str]:
    """Divisor and unit for times up to ``last`` seconds.

    >>> time_unit(600.0), time_unit(3600.0), time_unit(1e5)
    ((1.0, 's'), (60.0, 'min'), (3600.0, 'h'))
    """
    return (1.0, "s") if last <= 900 else (60.0, "min") if last <= 4 * 3600 else (3600.0, "h")


def si(largest: float, unit: str) -> tuple[float, str]:
    """Divisor, and unit with the prefix that gives ``largest`` a value between 1 and 1000.

    >>> si(539335.0, "J"), si(0.0, "W")
    ((1000.0, 'kJ'), (1.0, 'W'))
    """
    size = abs(largest)
    for factor, prefix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if size >= factor:
            return factor, prefix + unit
    return 1.0, unit


def digits(largest: float, significant: int = 3) -> str:
    """Format with fixed decimals that gives ``largest`` ``significant`` digits, and never "-0.0".

    >>> format(312.05, digits(312.05)), format(-0.001, digits(45.5)), format(0.836, digits(1.01))
    ('312', '0.0', '0.84')
    """
    whole = int(np.floor(np.log10(abs(largest)))) + 1 if largest and np.isfinite(largest) else 1
    return f"z.{max(significant - whole, 0)}f"


def tidy(axes: Axes, *, grid: bool = True) -> None:
    """Set readable ticks, and remove the upper and right borders."""
    axes.tick_params(labelsize=FONT, colors=INK)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if grid:
        axes.grid(alpha=0.3, lw=0.5)
        axes.set_axisbelow(True)


#: Height that `title` takes at the top of a figure, inches.
TITLE = 0.62


def title(drawn: Figure, first: str, second: str = "") -> None:
    """Write a bold first line and a second line; in a narrow figure, the font is reduced and the text is cut."""
    width, height = (float(size) for size in drawn.get_size_inches())
    for text, drop, size, weight in ((first, 0.12, FONT + 1.5, "bold"), (second, 0.36, FONT + 0.5, "normal")):
        letter = 0.0086 * (1.06 if weight == "bold" else 0.98)
        size = max(min(size, (width - 0.3) / (letter * max(len(text), 1))), 0.72 * size)
        fits = int((width - 0.3) / (size * letter))
        drawn.text(
            0.15 / width, 1 - drop / height, short(text, fits), fontsize=size, fontweight=weight, color=INK, va="top"
        )


def millimetres(points: ArrayLike) -> tuple[Array, Array]:
    """Convert (r, z) in m, shape (..., 2), to (horizontal, vertical) = (z, r) in mm."""
    array = np.asarray(points, dtype=float)
    return array[..., 1] * 1e3, array[..., 0] * 1e3


def section_axes(axes: Axes) -> None:
    """Set equal scales and labels in mm, crown up."""
    axes.set_aspect("equal")
    axes.set_xlabel("axial position z [mm]", fontsize=FONT)
    axes.set_ylabel("radius r [mm]", fontsize=FONT)
    tidy(axes, grid=False)


@dataclass(frozen=True)
class Label:
    """A text for a point (x, y) of the picture."""

    text: str
    x: float
    y: float
    bold: bool = False
    color: str = INK


def spread(wanted: ArrayLike, gap: float) -> Array:
    """Places nearest to the wanted ones (least squares), in the same order and at least ``gap`` apart.

    >>> spread([0.0, 0.0, 10.0], 2.0).tolist()
    [-1.0, 1.0, 10.0]
    """
    wanted = np.asarray(wanted, dtype=float)
    order = np.argsort(wanted, kind="stable")
    # Without the gaps, the places must not decrease: pool neighbours that would (isotonic regression).
    blocks: list[list[float]] = []
    for rank, place in enumerate(wanted[order]):
        blocks.append([place - rank * gap, 1.0])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            mean, count = blocks.pop()
            blocks[-1] = [
                (blocks[-1][0] * blocks[-1][1] + mean * count) / (blocks[-1][1] + count),
                blocks[-1][1] + count,
            ]
    values = np.concatenate([np.full(int(count), mean) for mean, count in blocks]) if blocks else np.empty(0)
    spread_values = np.empty(len(wanted))
    spread_values[order] = values + gap * np.arange(len(wanted))
    return spread_values


def column(
    axes: Axes, labels: Sequence[Label], x: float, low: float, high: float, *, gap: float, align: str = "left"
) -> None:
    """Write labels in a column at ``x``, from top to bottom, with leaders to their points.

    Parameters
    ----------
    low, high : the column's ends, in data units. gap : height of a line of text, in data units; where the labels
        do not fit, text and gap shrink together.
    align : "left" or "right": the side of the text that is at ``x``, from which the leaders start.
    """
    if not labels:
        return
    gap_now = min(gap, (high - low) / max(len(labels) - 1, 1))
    size = max(FONT * min(1.0, gap_now / gap), 4.0)
    # The order is given, so the wanted place of each label is not above that of the label before.
    wanted = np.minimum.accumulate([min(max(label.y, low), high) for label in labels])
    places = -spread(-wanted, gap_now)
    # Shift labels up from the lower end, then down from the upper end.
    rising = gap_now * np.arange(len(places))
    places = np.maximum.accumulate((np.maximum(places, low) - rising[::-1])[::-1])[::-1] + rising[::-1]
    places = np.minimum.accumulate(np.minimum(places, high) + rising) - rising
    nearer = 0.25 * gap * (1 if align == "right" else -1)
    for label, y in zip(labels, places, strict=True):
        _write(axes, label, x, float(y), size, align)
    _leaders(axes, [((x + nearer, float(y)), (label.x, label.y)) for label, y in zip(labels, places, strict=True)])


def _write(axes: Axes, label: Label, x: float, y: float, size: float, align: str) -> None:
    text = axes.text(
        x, y, label.text, fontsize=size, ha=align, va="center", color=label.color,
        fontweight="bold" if label.bold else "normal", zorder=6,
    )  # fmt: skip
    text.set_in_layout(False)


def _leaders(axes: Axes, lines: list[Any], colors: Sequence[str] = (INK,)) -> None:
    """Draw thin lines with a pale edge, visible on every colour."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(lines, colors="white", lw=2.0, alpha=0.55, zorder=5), autolim=False)
    axes.add_collection(LineCollection(lines, colors=list(colors), lw=0.7, zorder=5), autolim=False)


def line_ends(axes: Axes, labels: Sequence[Label], *, room: float, size: float = FONT) -> None:
    """Write names of lines to the right of their ends, in the lines' colours, without overlap.

    ``room``: space for the names right of the axes, inches.
    """
    if not labels:
        return
    figure = axes.figure
    box = axes.get_position()
    width, height = (float(v) for v in figure.get_size_inches())  # type: ignore[union-attr]
    low, high = axes.get_ylim()
    per_inch = (high - low) / (box.height * height)
    gap = min(1.35 * size / 72 * per_inch, (high - low) / len(labels))
    ordered = sorted(labels, key=lambda label: label.y)
    places = spread([label.y for label in ordered], gap)
    places += max(low - places.min(), 0.0)
    places -= max(places.max() - high, 0.0)
    inch = (axes.get_xlim()[1] - axes.get_xlim()[0]) / (box.width * width)
    longest = max(len(label.text) for label in labels)
    size = min(size, 72 * gap / per_inch / 1.3, (room - 0.25) / (longest * 0.0084))
    for label, y in zip(ordered, places, strict=True):
        axes.plot(
            [label.x, label.x + 0.2 * inch], [label.y, float(y)], color=label.color, lw=0.7, clip_on=False, zorder=5,
            scalex=False, scaley=False,
        )  # fmt: skip
        _write(axes, label, label.x + 0.24 * inch, float(y), size, "left")
