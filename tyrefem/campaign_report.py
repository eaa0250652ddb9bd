"""A campaign as one self-contained HTML page: every case in a table, hottest point and rolling resistance drawn."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.output import atomic_path
from tyrefem.summary import versions

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from tyrefem.campaign import Campaign

#: With more cases than this their names are left out of the pictures: they would be too small to read.
MOST_NAMES = 60


def write(campaign: Campaign, table: pd.DataFrame, path: Path) -> Path:
    """Write the page. ``table`` is what `tyrefem.campaign.run_campaign` returns.

    Raises
    ------
    InputError : the file cannot be written.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    done = finished(table)
    failed = table[table["failure"] != ""]
    page = environment.get_template("campaign_report.html").render(
        campaign=campaign,
        summary=_one_line(campaign, done),
        rows=done.to_dict("records"),
        failed=failed.to_dict("records"),
        pictures=[(words, base64.b64encode(png).decode("ascii")) for words, png in _pictures(done)],
        links={name for name in done["case"] if (path.parent / "cases" / name / "report.html").is_file()},
        versions=versions(),
    )
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def finished(table: pd.DataFrame) -> pd.DataFrame:
    """The cases that have a result, by tyre, pressure and load."""
    done = table[table["failure"] == ""]
    return done.sort_values(["section", "pressure_Pa", "load_N"], kind="stable") if len(done) else done


def _one_line(campaign: Campaign, done: pd.DataFrame) -> str:
    counted = f"{len(done)} of {len(campaign.cases)} cases finished."
    if not len(done):
        return counted
    hot = done.iloc[int(done["hottest_degC"].to_numpy().argmax())]
    coefficient = done["rolling_resistance_coefficient"]
    return (
        f"{counted} Hottest: {hot['hottest_degC']:.1f} °C in the {hot['hottest_region']} of case {hot['case']}, "
        f"{hot['hottest_s_m'] * 1e3:.0f} mm along the meridian, {hot['hottest_depth_m'] * 1e3:.1f} mm deep, after "
        f"{hot['hottest_time_s']:.0f} s. Rolling resistance coefficients {coefficient.min():.4f} to "
        f"{coefficient.max():.4f}."
    )


def _pictures(done: pd.DataFrame) -> list[tuple[str, bytes]]:
    from tyrefem.plotting.style import png

    if not len(done):
        return []
    return [
        ("Highest temperature of each case, by tyre and pressure", png(bars(done, "hottest_degC"))),
        (
            "Rolling resistance coefficient of each case at the end of its drive, by tyre and pressure",
            png(bars(done, "rolling_resistance_coefficient")),
        ),
    ]


_AXES = {
    "hottest_degC": ("hottest point", "highest temperature [°C]", "{:.1f}"),
    "rolling_resistance_coefficient": ("rolling resistance", "rolling resistance coefficient [-]", "{:.4f}"),
}


def bars(done: pd.DataFrame, column: str) -> Figure:
    """One dot per case on its own line, coloured by tyre, in groups of one inflation pressure.

    The lines reach from side to side: the axis does not begin at 0, and a bar's length would tell a wrong ratio.
    """
    from tyrefem.plotting.style import FONT, TITLE, add_axes, figure, line_style, plain, short, tidy, title

    name, label, form = _AXES[column]
    named = len(done) <= MOST_NAMES
    line = 0.21 if named else 8.0 / len(done)
    left, below, high = (3.4 if named else 1.0), 0.55, line * len(done) + 0.15
    drawn = figure(9.0, below + high + TITLE + 0.25)
    axes = add_axes(drawn, left, below, 8.75 - left, high)
    places, values = list(range(len(done))), done[column].to_list()
    low, spread = min(values), max(max(values) - min(values), 1e-3 * abs(max(values)))
    axes.set_xlim(low - 0.08 * spread, max(values) + 0.16 * spread)
    axes.set_ylim(len(done) - 0.4, -0.6)
    for number, section in enumerate(dict.fromkeys(done["section"])):
        chosen = [i for i, own in enumerate(done["section"]) if own == section]
        color: Any = line_style(number)["color"]
        axes.hlines(chosen, *axes.get_xlim(), color=color, lw=0.8, alpha=0.25)
        marker = "os^Dv"[number % 5]
        size = 5.5 if named else 3.5
        axes.plot([values[i] for i in chosen], chosen, marker, color=color, ms=size, label=short(section, 40))
    pressures = done["pressure_Pa"].to_list()
    for i in places[1:]:
        if abs(pressures[i] - pressures[i - 1]) > 500.0:
            axes.axhline(i - 0.5, color="#c8c8c8", lw=0.6)
    if named:
        labels = [
            f"{short(case, 34)}  {pressure / 1e3:.0f} kPa"
            for case, pressure in zip(done["case"], pressures, strict=True)
        ]
        axes.set_yticks(places, labels, fontsize=FONT - 1)
        for i in places:
            axes.annotate(
                form.format(values[i]), (values[i], i), xytext=(6, 0), textcoords="offset points", fontsize=FONT - 1.5,
                va="center",
            )  # fmt: skip
    else:
        axes.set_yticks([])
        axes.set_ylabel(plain(f"{len(done)} cases, by tyre, pressure and load"), fontsize=FONT)
    axes.set_xlabel(label, fontsize=FONT)
    tidy(axes)
    axes.grid(visible=False, axis="y")
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False, fontsize=FONT - 0.5, borderaxespad=0.1
    )
    title(drawn, f"{name.capitalize()} by case", "in the order of tyre, inflation pressure and load")
    return drawn
