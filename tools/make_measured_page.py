"""Make docs/measured.md and its figures of the tables of benchmarks/measured.py (run from the root).

    python tools/make_measured_page.py

Writes docs/evidence/tables/measured-comparison.csv (every row), the part of docs/measured.md between its marks, and
docs/pictures/measured-*.png. `comparison()` and `page_tables()` are what a test compares with the stored files.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from dataclasses import astuple, fields

import numpy as np
from measured_comparison import (
    ECF,
    PASSENGER,
    ROOT,
    TABLES,
    Comparison,
    aircraft_facts,
    comparison,
    computed,
    data,
    slope,
)
from measured_pictures import FIGURES

from tyrefem.output import atomic_path

PICTURES, PAGE = ROOT / "docs/pictures", ROOT / "docs/measured.md"
BEGIN, END = "<!-- made by tools/make_measured_page.py -->", "<!-- end -->"


def _lines(head: str, rows: Iterable[Sequence[object]]) -> list[str]:
    columns = head.count("|") + 1
    return [f"| {head} |", "|" + "---|" * columns, *(f"| {' | '.join(map(str, row))} |" for row in rows), ""]


def _rms(rows: Sequence[Comparison]) -> float:
    return float(np.sqrt(np.mean([row.deviation**2 for row in rows if not math.isnan(row.deviation)])))


def summary(rows: Sequence[Comparison]) -> list[str]:
    """One line for each tyre and quantity."""
    lines = []
    for tyre, quantity in dict.fromkeys((row.tyre, row.quantity) for row in rows):
        part = [row for row in rows if (row.tyre, row.quantity) == (tyre, quantity)]
        errors = [row.deviation for row in part if not math.isnan(row.deviation)]
        spread = f"{errors[0]:+.1f}" if len(part) == 1 else f"{min(errors):+.1f} to {max(errors):+.1f}"
        verdicts = [sum(row.verdict == verdict for row in part) for verdict in ("within u_val", "within 2 u_val")]
        if tyre == ECF:
            goal, met = f"rms {part[0].goal:.0f}", "yes" if _rms(part) <= part[0].goal else "no"
        else:
            goal, met = f"{part[0].goal:.0f}", f"{sum(row.goal_met == 'yes' for row in part)} of {len(part)}"
        beyond = len(errors) - sum(verdicts)
        u_val = f"{np.mean([row.u_val for row in part]):.1f}"
        lines.append((tyre, quantity, len(part), spread, f"{_rms(part):.1f}", u_val, *verdicts, beyond, goal, met))
    head = "tyre | quantity | rows | E, % | rms of E, % | u_val, % | within u_val | within 2 u_val | model error"
    return _lines(f"{head} | goal, % | met", lines)


def motions(rows: Sequence[Comparison]) -> list[str]:
    """Deviations of both motions: range and rms."""
    lines = []
    for tyre, quantity in dict.fromkeys((row.tyre, row.quantity) for row in rows if row.quantity != "mass"):
        part = [row for row in rows if (row.tyre, row.quantity) == (tyre, quantity)]
        cells = []
        for computed_values in ([row.linear for row in part], [row.computed for row in part]):
            pairs = zip(computed_values, part, strict=True)
            errors = np.array([100 * (value / row.measured - 1) for value, row in pairs])
            spread = f"{errors[0]:+.0f}" if len(part) == 1 else f"{errors.min():+.0f} to {errors.max():+.0f}"
            cells += [spread, f"{np.sqrt(np.mean(errors**2)):.1f}"]
        lines.append((tyre, quantity, len(part), *cells))
    return _lines("tyre | quantity | rows | linear: E, % | rms, % | large: E, % | rms, %", lines)


def aircraft() -> list[str]:
    """The bias aircraft tyres by the load law."""
    facts = aircraft_facts()
    close = abs(facts["median"] - 1) <= 0.05
    rows: list[tuple[object, ...]] = [
        ("tyres", facts["tyres"], "", ""),
        (
            "computed over catalogue deflection at rated load, median",
            f"{facts['median']:.3f}", "0.95 to 1.05", "yes" if close else "no",
        ),
        ("the same, 5 % and 95 % quantiles", f"{facts['5 %']:.3f}, {facts['95 %']:.3f}", "", ""),
        (
            "share within 20 %", f"{facts['within 20 %']:.1%}", "90 %",
            "yes" if facts["within 20 %"] >= 0.9 else "no",
        ),
        ("tyres with a bottoming load", facts["with bottoming load"], "", ""),
        (
            "load at the bottoming radius over bottoming load, median",
            f"{facts['median of bottoming loads']:.3f}", "", "",
        ),
        (
            "rank correlation of the two loads", f"{facts['order of bottoming loads']:.3f}", "right order",
            "yes" if facts["order of bottoming loads"] > 0.95 else "no",
        ),
    ]  # fmt: skip
    return _lines("what | value | goal | met", rows)


def rolling_resistance() -> list[str]:
    """Exponents of the coefficient over load and pressure, and the effect of temperature."""
    measured = data("measured-205-60r15/summary.csv")
    loads = [row["load [N]"] for row in measured]
    cold = [computed(PASSENGER, "rolling resistance at 20 degC", 220, load, "large") for load in loads]
    warm = computed(PASSENGER, "rolling resistance at 50 degC", 220, 4000, "large")
    at_pressures = [computed(PASSENGER, "rolling resistance at 20 degC", p, 4000, "large") for p in (200, 240)]
    coefficients = [row["rolling_resistance_coefficient [1]"] for row in measured]
    trends = (ROOT / "studies/measured-205-60r15/rolling-resistance-j2452.csv").read_text(encoding="utf-8").splitlines()
    others = list(csv.DictReader(line for line in trends if not line.startswith("#")))
    load_trend = ", ".join(f"{float(row['beta']) - 1:+.2f}" for row in others)
    pressure_trend = ", ".join(f"{float(row['alpha']):+.2f}" for row in others)
    rows = [
        ("load", f"{slope(loads, cold):+.2f}", f"{slope(loads, coefficients):+.2f}", load_trend),
        ("pressure", f"{slope((200, 240), at_pressures):+.2f}", "", pressure_trend),
    ]
    return [
        *_lines("over | computed | 205/60R15 (Magic Formula) | two other tyres (SAE J2452)", rows),
        f"The coefficient at 4000 N is {cold[2]:.4f} with all rubber at 20 °C and {warm:.4f} at 50 °C; "
        f"measured: {coefficients[2]:.4f}.",
    ]


#: Directions of the push on the standing tyre.
WAYS = ("forward", "sideways")


def standing() -> list[str]:
    """Stiffness of the standing tyre of `benchmarks/rolling.py --standing`."""
    with (TABLES / "rolling-standing.csv").open(encoding="utf-8", newline="") as lines:
        stored = list(csv.DictReader(lines))
    rows = []
    for row in stored:
        ways = [(float(row[f"{way} [N/mm]"]), float(row[f"{way} [% of measured, less 100]"])) for way in WAYS]
        rows.append((row["contact"], row["moduli"], *(f"{value:.0f} ({error:+.0f} %)" for value, error in ways)))
    return _lines("contact | moduli | forward, N/mm (E) | sideways, N/mm (E)", rows)


def page_tables() -> str:
    """The tables of the page."""
    rows = comparison()
    sections = {
        "": summary(rows),
        "Both motions: deviation from the measured values.": motions(rows),
        "Bias aircraft tyres by the load law of NASA TR R-64.": aircraft(),
        f"The standing {PASSENGER} at 220 kPa and 4000 N, pushed along the road. A small push has the moduli at 0.1 % "
        "of shear ([why](method/rolling-friction.md#standing-tyre)).": standing(),
        "Exponents of the rolling resistance coefficient.": rolling_resistance(),
    }
    return "\n".join("\n".join([*([title, ""] if title else []), *lines]) for title, lines in sections.items()).strip()


def main() -> None:
    """Write the comparison's table, the page's tables and the figures."""
    from tyrefem.reports.figures.style import png

    with atomic_path(TABLES / "measured-comparison.csv") as path, open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([field.name for field in fields(Comparison)])
        writer.writerows(astuple(row) for row in comparison())
    text = PAGE.read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END, 1)[1]
    PAGE.write_text(f"{before}{BEGIN}\n\n{page_tables()}\n\n{END}{after}", encoding="utf-8")
    for name, draw in FIGURES.items():
        (PICTURES / f"measured-{name}.png").write_bytes(png(draw()))


if __name__ == "__main__":
    main()
