"""The part of docs/measured.md on bias aircraft tyres by finite elements, and its figure.

    python tools/measured_aircraft_page.py

It reads the tables measured-aircraft-*.csv of benchmarks/measured_aircraft.py. `section()` is what a test compares
with the page.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
TABLES, PAGE = ROOT / "docs/evidence/tables", ROOT / "docs/measured.md"
PICTURE = ROOT / "docs/pictures/measured-aircraft-fe.png"
BEGIN, END = "<!-- made by tools/measured_aircraft_page.py -->", "<!-- end of aircraft tyres by finite elements -->"
#: Standard uncertainty of mesh, harmonics and tolerance, relative: half the mesh changes 0.7 %.
NUMERICAL = 0.01
#: Goals: the median's distance from 1, the share of rows within 20 %, the rank correlation of the bottoming loads.
MEDIAN, WITHIN, SHARE, ORDER = 0.05, 0.20, 0.90, 0.95
FIRST_SIZE, KILONEWTON = "22x5.5", 1e3
RATIO = "computed over catalogue"


def table(name: str) -> list[dict[str, str]]:
    """Rows of a table of benchmarks/measured_aircraft.py; none if it was not made."""
    path = TABLES / f"measured-aircraft-{name}.csv"
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def rows_of(group: str = "") -> list[dict[str, str]]:
    """Rows at the rated load, of one group or of all."""
    return [row for row in table("fe") if group in ("", row["group"])]


def ratios(rows: Sequence[dict[str, str]]) -> Any:
    """Computed over catalogue deflection of the rows that have one."""
    return np.array([float(row[RATIO]) for row in rows if row[RATIO]])


def input_uncertainty() -> float:
    """Root of the sum of squares over the uncertain numbers, relative: mean square of the tyres."""
    squares: dict[str, float] = {}
    for row in table("sensitivities"):
        squares[row["size"]] = squares.get(row["size"], 0.0) + float(row["deflection"] or 0.0) ** 2
    return math.sqrt(sum(squares.values()) / len(squares)) if squares else math.nan


def u_val(row: dict[str, str]) -> float:
    """Standard uncertainty of a deviation, relative: catalogue, numbers of the computation, inputs."""
    return math.hypot(float(row["u of the catalogue, %"]) / 100, NUMERICAL, input_uncertainty())


def verdict(row: dict[str, str]) -> str:
    """In the manner of V&V 20."""
    error = abs(float(row[RATIO]) - 1)
    if error <= u_val(row):
        return "within u_val"
    return "within 2 u_val" if error <= 2 * u_val(row) else "model error"


def bottoming() -> list[tuple[float, float, bool]]:
    """Catalogue's and computed load at the bottoming radius, N, and whether the balance reached that radius."""
    return [
        (float(row["bottoming load [N]"]), float(row["computed load [N]"]), not row["message"])
        for row in table("bottoming")
        if row["computed load [N]"]
    ]


def at_the_rim() -> int:
    """Rows whose load is that just before the crown meets the rim, which comes before the bottoming radius."""
    rows = [row for row in table("bottoming") if row["computed load [N]"] and not row["message"]]
    depths = [(row["reached deflection [mm]"], row["deflection at the bottoming radius [mm]"]) for row in rows]
    return sum(float(reached) < 0.999 * float(deflection) for reached, deflection in depths)


def order(pairs: Sequence[tuple[float, float, bool]]) -> float:
    """Rank correlation of two loads (Spearman)."""
    from scipy.stats import spearmanr

    return float(spearmanr([pair[0] for pair in pairs], [pair[1] for pair in pairs]).statistic)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(r) + " |" for r in rows), ""]


def _of_rows() -> list[str]:
    columns = []
    for group in ("", "used", "judged"):
        rows, values = rows_of(group), ratios(rows_of(group))
        pairs = [(row["linear deflection [mm]"], row["catalogue deflection [mm]"]) for row in rows]
        linear = [float(computed) / float(catalogue) for computed, catalogue in pairs if computed]
        median, share = float(np.median(values)), float((abs(values - 1) <= WITHIN).sum() / len(rows))
        columns.append(
            [
                str(len(rows)),
                str(len(values)),
                f"{median:.3f}",
                f"{values.min():.3f} to {values.max():.3f}",
                f"{share:.1%}",
                str(sum(verdict(row) == "within u_val" for row in rows if row[RATIO])),
                str(sum(verdict(row) == "model error" for row in rows if row[RATIO])),
                f"{np.median(linear):.3f}",
            ]
        )
    values = ratios(rows_of())
    met = [
        "yes" if abs(np.median(values) - 1) <= MEDIAN else "no",
        "yes" if (abs(values - 1) <= WITHIN).sum() / len(rows_of()) >= SHARE else "no",
    ]
    names = (
        "rows", "computed", "computed over catalogue deflection, median", "the same, range",
        "share of rows within 20 %", "within u_val", "model error", "linear over catalogue deflection, median",
    )  # fmt: skip
    goals = ("", "", f"0.95 to 1.05: {met[0]}", "", f"90 %: {met[1]}", "", "", "")
    return _table(
        ("what", "all", "used", "judged", "goal, met"),
        [(name, *(column[n] for column in columns), goals[n]) for n, name in enumerate(names)],
    )


def _of_bottoming() -> list[str]:
    pairs = bottoming()
    reached = [pair for pair in pairs if pair[2]]
    if len(reached) < 3:
        return []
    share = np.array([load / catalogue for catalogue, load, _ in reached])
    correlation = order(reached)
    rows = [
        ("rows with a bottoming load", str(len(pairs)), ""),
        ("balance reaches the bottoming radius, or the rim", str(len(reached)), ""),
        ("crown meets the rim before the bottoming radius", str(at_the_rim()), ""),
        ("load there over bottoming load, median", f"{np.median(share):.3f}", ""),
        ("the same, range", f"{share.min():.3f} to {share.max():.3f}", ""),
        (
            "rank correlation of the load there and the bottoming load",
            f"{correlation:.3f}",
            f"right order: {'yes' if correlation >= ORDER else 'no'}",
        ),
    ]
    return _table(("bottoming", "value", "goal, met"), rows)


def _of_sizes() -> list[str]:
    head = ("tyre", "group", "kPa", "kN", "catalogue, mm", "computed, mm", "ratio", "u_val, %", "verdict")
    rows = []
    for row in rows_of():
        name = f"{row['size']} {row['ply rating']}PR"
        given = (
            name, row["group"], f"{float(row['pressure [kPa]']):.0f}", f"{float(row['load [N]']) / KILONEWTON:.1f}",
            f"{float(row['catalogue deflection [mm]']):.1f}",
        )  # fmt: skip
        if row[RATIO]:
            computed = (
                f"{float(row['computed deflection [mm]']):.1f}", f"{float(row[RATIO]):.3f}", f"{100 * u_val(row):.1f}",
                verdict(row),
            )  # fmt: skip
        else:
            computed = ("", "", "", "not computed")
        rows.append((*given, *computed))
    return _table(head, rows)


def section() -> str:
    """The tables."""
    messages = [f"- {row['size']} {row['ply rating']}PR: {row['message']}" for row in rows_of() if not row[RATIO]]
    lines = [*_of_rows(), *_of_bottoming(), *_of_sizes()]
    if messages:
        lines += ["Not computed:", "", *messages, ""]
    return "\n".join(lines).strip()


def draw() -> Any:
    """Deflections over the catalogue's, with bands of 2 u_val, against pressure; bottoming loads."""
    from tyrefem.reports.figures.style import FONT, PALETTE, QUIET, add_axes, figure, tidy

    drawn = figure(8.6, 3.9)
    axes = add_axes(drawn, 0.7, 0.55, 3.5, 2.9)
    axes.axhspan(1 - WITHIN, 1 + WITHIN, color=PALETTE[2], alpha=0.10, lw=0, label="20 % either way")
    axes.axhline(1.0, color=QUIET, lw=1)
    for group, color, marker in (("used", PALETTE[0], "o"), ("judged", PALETTE[1], "s")):
        rows = [row for row in rows_of(group) if row[RATIO]]
        x, y = ([float(row[key]) for row in rows] for key in ("pressure [kPa]", RATIO))
        error = [2 * u_val(row) for row in rows]
        axes.errorbar(x, y, yerr=error, fmt=marker, color=color, ms=4, lw=0.8, alpha=0.8, label=f"{group}, 2 u_val")
    axes.set_xlabel("rated pressure, kPa", fontsize=FONT)
    axes.set_ylabel("computed over catalogue deflection", fontsize=FONT)
    axes.legend(fontsize=7, frameon=False)
    tidy(axes)
    axes = add_axes(drawn, 4.95, 0.55, 3.4, 2.9)
    pairs = bottoming()
    ends = np.array([10.0, 1200.0])
    axes.plot(ends, ends, color=QUIET, lw=1)
    for reached, marker, label in ((True, "o", "at the bottoming radius"), (False, "x", "last balance before it")):
        points = [(a / KILONEWTON, b / KILONEWTON) for a, b, at_radius in pairs if at_radius is reached]
        if points:
            axes.plot(*zip(*points, strict=True), marker, color=PALETTE[0], ms=4, label=label)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("bottoming load of the catalogue, kN", fontsize=FONT)
    axes.set_ylabel("computed load, kN", fontsize=FONT)
    axes.legend(fontsize=7, frameon=False)
    tidy(axes)
    drawn.suptitle("Bias aircraft tyres by finite elements in large motion", fontsize=FONT, y=0.99)
    return drawn


def main() -> None:
    """Write the page's part and the figure."""
    from tyrefem.reports.figures.style import png

    text = PAGE.read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}\n\n{section()}\n\n{END}{after}", encoding="utf-8")
    PICTURE.write_bytes(png(draw()))


if __name__ == "__main__":
    main()
