"""Files of a campaign: a table and a folder per case, written as cases finish, and one page with two pictures."""

from __future__ import annotations

import base64
from collections.abc import Callable
from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.origin import StudyOrigin
from tyrefem.interruption import interruption_delayed
from tyrefem.output import atomic_path, versions, write_json
from tyrefem.reports.figures.style import FONT, TITLE, add_axes, figure, line_style, plain, png, short, tidy, title
from tyrefem.reports.run_files import run_files, write_tables
from tyrefem.reports.template import rendered
from tyrefem.reports.vtk import file_names
from tyrefem.sweep.campaign import CampaignData, row

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


#: Largest number of cases whose names are drawn: more names would be too small to read.
MOST_NAMES = 60
#: Tyres that the legend has room for.
MOST_TYRES = 8


def campaign_files(campaign: CampaignData, folder: Path) -> list[str]:
    """The files that `run_campaign` and its report may write, relative to their folder."""
    cases = [
        f"cases/{escape(case.name)}/{name}"
        for case in campaign.cases
        for name in run_files(campaign.study, folder / "cases" / case.name)
    ]
    vtk = [f"cases/{escape(case.name)}/vtk/{name}" for case in campaign.cases for name in file_names(case.name)]
    whole = ["campaign.csv", "report.html"]
    return [*whole, *(name for name in cases if "/vtk/" not in name), *vtk,
            *(f"cases/{escape(case.name)}/summary.json" for case in campaign.cases)]  # fmt: skip


def run_campaign(
    campaign: CampaignData,
    folder: Path,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[Any, Path], None] | None = None,
    *,
    parquet: bool = False,
) -> pd.DataFrame:
    """Run a campaign into a folder: a folder per case, ``campaign.csv``, ``study.toml`` and ``summary.json``.

    The table is written again after every case, so that an interrupted campaign keeps its finished cases.
    ``each`` may write more files of a case (pictures, VTK) into its folder. ``parquet``: its tables as Parquet, too.
    """
    rows: list[dict[str, Any]] = []
    StudyOrigin(campaign.study).write(folder)
    # Written at the start: an older campaign's table in this folder must not be taken for this one's.
    table = _write_table(campaign, rows, folder)
    for case, outcome in campaign.runs(progress):
        try:
            if not isinstance(outcome, str):
                with interruption_delayed():
                    write_tables(outcome, folder / "cases" / case.name, parquet=parquet)
                if each is not None:
                    each(outcome, folder / "cases" / case.name)
        finally:
            # A case is finished even if its pictures were interrupted.
            with interruption_delayed():
                rows.append(row(case, outcome))
                table = _write_table(campaign, rows, folder)
    return table


def _write_table(campaign: CampaignData, rows: list[dict[str, Any]], folder: Path) -> pd.DataFrame:
    import pandas as pd

    names = dict.fromkeys(name for entry in rows for name in entry if name != "failure")
    table = pd.DataFrame(rows, columns=[*(names or ("case", "note")), "failure"])
    with atomic_path(folder / "campaign.csv") as temporary:
        table.to_csv(temporary, index=False, float_format="%.6g")
    stopped = len(rows) < len(campaign.cases) or rows[-1]["failure"].startswith("interrupted")
    write_json(_summary(campaign, table, not stopped), folder / "summary.json")
    return table


def _summary(campaign: CampaignData, table: pd.DataFrame, complete: bool) -> dict[str, Any]:
    made_by = StudyOrigin(campaign.study, simulated=True).using([dict(case.changes) for case in campaign.cases])
    return made_by.summary() | {
        "complete": complete,
        "cases": table.to_dict("records"),
        "failed": [entry["case"] for entry in table.to_dict("records") if entry.get("failure")],
    }


def write_campaign_report(campaign: CampaignData, table: pd.DataFrame, path: str | Path) -> Path:
    """Write one self-contained page: a table of all cases, two pictures, failed cases with their reasons.

    ``table`` is the return value of `run_campaign`.

    Raises
    ------
    InputError : the file cannot be written.
    """
    path, done = Path(path), finished(table)
    failed = table[table["failure"] != ""]
    page = rendered(
        "campaign.html",
        campaign=campaign,
        summary=_one_line(campaign, done),
        rows=done.to_dict("records"),
        failed=failed.to_dict("records"),
        pictures=[(words, base64.b64encode(drawn).decode("ascii")) for words, drawn in _pictures(done)],
        links={name for name in done["case"] if (path.parent / "cases" / name / "report.html").is_file()},
        versions=versions(),
    )
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def finished(table: pd.DataFrame) -> pd.DataFrame:
    """The cases with a result, sorted by tyre, pressure and load."""
    done = table[table["failure"] == ""]
    return done.sort_values(["section", "pressure_Pa", "load_N"], kind="stable") if len(done) else done


def _one_line(campaign: CampaignData, done: pd.DataFrame) -> str:
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
    if not len(done):
        return []
    return [
        ("Highest temperature of each case, by tyre and pressure", png(bars(done, "hottest_degC"))),
        (
            "Rolling resistance coefficient of each case at the end of its rolling phase with most heat, by tyre and "
            "pressure",
            png(bars(done, "rolling_resistance_coefficient")),
        ),
    ]


_AXES = {
    "hottest_degC": ("hottest point", "highest temperature [°C]", "{:.1f}"),
    "rolling_resistance_coefficient": ("rolling resistance", "rolling resistance coefficient [-]", "{:.4f}"),
}


def bars(done: pd.DataFrame, column: str) -> Figure:
    """Draw one dot per case on a separate line, grouped by inflation pressure; tyres have colours if they are few.

    Dots, not bars: the axis does not begin at 0, so the lengths of bars would show a wrong ratio.
    """
    name, label, form = _AXES[column]
    named = len(done) <= MOST_NAMES
    line = 0.21 if named else 8.0 / len(done)
    left, below, high = (3.4 if named else 1.0), 0.55, line * len(done) + 0.15
    drawn = figure(9.0, below + high + TITLE + 0.25)
    axes = add_axes(drawn, left, below, 8.75 - left, high)
    places, values = list(range(len(done))), done[column].to_list()
    low, spread = min(values), max(max(values) - min(values), 1e-3 * abs(max(values))) or 1.0
    axes.set_xlim(low - 0.08 * spread, max(values) + 0.16 * spread)
    axes.set_ylim(len(done) - 0.4, -0.6)
    sections = list(dict.fromkeys(done["section"]))
    told_apart = len(sections) <= MOST_TYRES
    for number, section in enumerate(sections):
        chosen = [i for i, of_case in enumerate(done["section"]) if of_case == section]
        number = number if told_apart else 0
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
    if told_apart:
        axes.legend(
            loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False, fontsize=FONT - 0.5, borderaxespad=0.1
        )
    title(drawn, f"{name.capitalize()} by case", "sorted by tyre, inflation pressure and load")
    return drawn
