"""One look for every picture: colours that survive colour blindness and grey print, sizes, units, saving."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

#: Okabe & Ito (2008), distinguishable with every common colour blindness; the yellow is left out: too pale on white.
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
DPI = 110
FONT = 9.0


def figure(width: float, height: float) -> Figure:
    """An empty figure of a size in inches. Parts are placed with `add_axes`: automatic layout costs half the time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(made)
    return made


def add_axes(drawn: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Axes at a place given in inches."""
    w, h = drawn.get_size_inches()
    return drawn.add_axes((left / w, bottom / h, width / w, height / h))


def png(drawn: Figure) -> bytes:
    """The figure as a PNG file's bytes."""
    return picture(drawn, ".png")


def picture(drawn: Figure, suffix: str) -> bytes:
    """The figure as the bytes of a file with an ending of `tyrefem.results_file.PICTURES`; the same at every time."""
    from matplotlib import rc_context

    stream, form = io.BytesIO(), suffix.lower().lstrip(".")
    options: dict[str, dict[str, Any]] = {
        "png": {"metadata": {"Software": "tyrefem"}, "pil_kwargs": {"compress_level": 4}},
        "pdf": {"metadata": {"Creator": "tyrefem", "CreationDate": None}},
        "svg": {"metadata": {"Creator": "tyrefem", "Date": None}},
    }
    with rc_context({"svg.hashsalt": "tyrefem"}):
        drawn.savefig(stream, format=form, dpi=DPI, facecolor="white", **options[form])
    return stream.getvalue()


def plain(text: object) -> str:
    """Text as it stands: a dollar sign would start a formula.

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
    """Text for a label, cut to a length that fits.

    >>> short("a thermocouple with a very long name", 12)
    'a thermocou…'
    """
    words = str(text)
    return plain(words if len(words) <= length else words[: length - 1] + "…")


def line_style(number: int) -> dict[str, Any]:
    """Colour and dashes of the n-th line: the dashes change when the colours come round again."""
    return {"color": PALETTE[number % len(PALETTE)], "ls": DASHES[number // len(PALETTE) % len(DASHES)]}


def time_unit(last: float) -> tuple[float, str]:
    """Divisor and unit in which times up to ``last`` seconds read well.

    >>> time_unit(600.0), time_unit(3600.0), time_unit(1e5)
    ((1.0, 's'), (60.0, 'min'), (3600.0, 'h'))
    """
    return (1.0, "s") if last <= 900 else (60.0, "min") if last <= 4 * 3600 else (3600.0, "h")


def si(largest: float, unit: str) -> tuple[float, str]:
    """Divisor and unit with the prefix that brings ``largest`` between 1 and 1000.

    >>> si(539335.0, "J"), si(0.0, "W")
    ((1000.0, 'kJ'), (1.0, 'W'))
    """
    size = abs(largest)
    for factor, prefix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if size >= factor:
            return factor, prefix + unit
    return 1.0, unit


def digits(largest: float, significant: int = 3) -> str:
    """Format of fixed decimals that gives ``largest`` so many significant digits, and never "-0.0".

    >>> format(312.05, digits(312.05)), format(-0.001, digits(45.5)), format(0.836, digits(1.01))
    ('312', '0.0', '0.84')
    """
    whole = int(np.floor(np.log10(abs(largest)))) + 1 if largest and np.isfinite(largest) else 1
    return f"z.{max(significant - whole, 0)}f"


def tidy(axes: Axes, *, grid: bool = True) -> None:
    """Readable ticks, no box where no data are."""
    axes.tick_params(labelsize=FONT, colors=INK)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if grid:
        axes.grid(alpha=0.3, lw=0.5)
        axes.set_axisbelow(True)


#: Height that `title` takes at the top of a figure, inches.
TITLE = 0.62


def title(drawn: Figure, first: str, second: str = "") -> None:
    """Bold first line, and a second line for the numbers; each smaller, and at last cut, where the figure is narrow."""
    width, height = (float(size) for size in drawn.get_size_inches())
    for text, drop, size, weight in ((first, 0.12, FONT + 1.5, "bold"), (second, 0.36, FONT + 0.5, "normal")):
        letter = 0.0086 * (1.06 if weight == "bold" else 0.98)
        size = max(min(size, (width - 0.3) / (letter * max(len(text), 1))), 0.72 * size)
        fits = int((width - 0.3) / (size * letter))
        drawn.text(
            0.15 / width, 1 - drop / height, short(text, fits), fontsize=size, fontweight=weight, color=INK, va="top"
        )


def millimetres(points: ArrayLike) -> tuple[Array, Array]:
    """(r, z) in m, shape (..., 2), as (horizontal, vertical) = (z, r) in mm."""
    array = np.asarray(points, dtype=float)
    return array[..., 1] * 1e3, array[..., 0] * 1e3


def section_axes(axes: Axes) -> None:
    """Equal scales, crown up, in mm."""
    axes.set_aspect("equal")
    axes.set_xlabel("axial position z [mm]", fontsize=FONT)
    axes.set_ylabel("radius r [mm]", fontsize=FONT)
    tidy(axes, grid=False)
