"""Make docs/measured.md and its figures of the tables of benchmarks/measured.py (run from the root).

    python tools/make_measured_page.py

Writes docs/evidence/tables/measured-comparison.csv (every row), the part of docs/measured.md between its marks, and
docs/pictures/measured-*.png. `comparison()` and `page_tables()` are what a test compares with the stored files.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
TABLES, PICTURES, PAGE = ROOT / "docs/evidence/tables", ROOT / "docs/pictures", ROOT / "docs/measured.md"
BEGIN, END = "<!-- made by tools/make_measured_page.py -->", "<!-- end -->"
LBF, PSI, INCH = 4.4482216152605, 6.894757293168361, 25.4
PASSENGER, RE71R, ECF = "205/60R15", "255/40R17 RE-71R", "255/40ZR17 ECF"
#: Standard uncertainty of a measured value and of the numbers of mesh, harmonics and tolerance, relative: estimates.
MEASURED = {"deflection": 0.03, "stiffness": 0.03, "length": 0.03, "width": 0.05, "gross area": 0.04, "net area": 0.05,
            "rolling radius": 0.005, "mass": 0.01, "rise": 0.05, "rolling resistance": 0.10}  # fmt: skip
NUMERICAL = {"deflection": 0.02, "stiffness": 0.05, "length": 0.08, "width": 0.03, "gross area": 0.08, "net area": 0.03,
             "rolling radius": 0.001, "mass": 0.005, "rise": 0.15, "rolling resistance": 0.05}  # fmt: skip
#: Loss tangents of the cards: 20 % each; the tread has most of the loss.
LOSS_TANGENT = 0.15
#: Bands of figures: so many standard uncertainties.
BAND = 2.0


#: Quantities of the contact, and the table of each tyre's other results.
CONTACT = ("length", "width", "gross area", "net area")
SOURCES = {PASSENGER: "passenger", RE71R: "radius"}


@dataclass(frozen=True)
class Comparison:
    """A measured value beside the computed ones. Deviations and uncertainties in per cent of the measured value."""

    tyre: str
    quantity: str
    kilopascal: float
    newton: float
    measured: float
    computed: float
    motion: str
    linear: float
    deviation: float
    u_measured: float
    u_numerical: float
    u_input: float
    u_val: float
    verdict: str
    goal: float
    goal_met: str


def table(name: str) -> list[dict[str, str]]:
    """Rows of a table of benchmarks/measured.py."""
    with (TABLES / f"measured-{name}.csv").open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def data(path: str) -> list[dict[str, float]]:
    """Rows of a measured table of numbers."""
    lines = (ROOT / "studies" / path).read_text(encoding="utf-8").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [{key: float(value) for key, value in row.items()} for row in rows]


def computed(tyre: str, quantity: str, pressure: float, load: float, motion: str) -> float:
    """A computed value at a pressure, kPa, and a load, N; nan: none.

    Contact: of the linear presses with many harmonics. Stiffness in large motion: slope of the parabola through the
    origin and the loads, as the load of one balance is known to 1 %.
    """
    if quantity in CONTACT:
        rows = [row for row in table("prints") if row["tyre"] in tyre]
    else:
        rows = [row for row in table(SOURCES[tyre]) if row["motion"] == motion]
    rows = [row for row in rows if abs(float(row["pressure [kPa]"]) - pressure) < 0.5]
    if not rows:
        return math.nan
    if quantity == "stiffness" and motion == "large":
        deflections, loads = (np.array([float(row[key]) for row in rows]) for key in ("deflection [mm]", "load [N]"))
        powers = np.stack([deflections, deflections**2], axis=1)
        (a, b), *_ = np.linalg.lstsq(powers / loads[:, None], np.ones(len(loads)), rcond=None)
        return float(math.sqrt(a * a + 4 * b * load))
    column = next(key for key in rows[0] if key.split(" [")[0] == quantity)
    near = min(rows, key=lambda row: abs(float(row["load [N]"]) - load))
    return float(near[column]) if abs(float(near["load [N]"]) / load - 1) < 0.03 else math.nan


def input_uncertainty(tyre: str, quantity: str) -> float:
    """Root of the sum of squares over the uncertain numbers, relative."""
    rows = [row for row in table("sensitivities") if row["tyre"] == tyre.replace("ZR", "R")[:9]]
    return math.sqrt(sum(float(row[quantity]) ** 2 for row in rows))


def compared(
    tyre: str, quantity: str, pressure: float, load: float, measured: float, large: float, linear: float, goal: float
) -> Comparison:
    """One row with its verdict in the manner of V&V 20: E = computed - measured against u_val."""
    kind = next(key for key in MEASURED if quantity.startswith(key))
    of_input = {"rise": 0.05, "rolling resistance": LOSS_TANGENT}.get(kind)
    if of_input is None:
        of_input = input_uncertainty(tyre, kind)
    parts = (MEASURED[kind], NUMERICAL[kind], of_input)
    u_val = math.sqrt(sum(part**2 for part in parts))
    error = large / measured - 1
    if math.isnan(error):
        verdict = "not computed"
    elif abs(error) <= u_val:
        verdict = "within u_val"
    elif abs(error) <= 2 * u_val:
        verdict = "within 2 u_val"
    else:
        verdict = "model error"
    met = "-" if math.isnan(error) else ("yes" if abs(error) <= goal else "no")
    percent = [round(100 * value, 1) for value in (error, *parts, u_val)]
    numbers = [float(f"{value:.5g}") for value in (pressure, load, measured, large)]
    motion = {"mass": "as drawn"}.get(quantity, "linear" if quantity in CONTACT else "large")
    return Comparison(
        tyre, quantity, *numbers, motion, float(f"{linear:.5g}"), *percent, verdict, round(100 * goal, 6), met
    )


def slope(x: Sequence[float], y: Sequence[float]) -> float:
    """Exponent of y over x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def passenger() -> list[Comparison]:
    """The 205/60R15."""
    rows = []
    for row in data("measured-205-60r15/summary.csv"):
        load = row["load [N]"]
        for quantity, column in (
            ("deflection", "deflection [mm]"),
            ("length", "contact_length [mm]"),
            ("width", "contact_width [mm]"),
            ("rolling radius", "effective_rolling_radius [mm]"),
        ):
            both = [computed(PASSENGER, quantity, 220, load, motion) for motion in ("large", "linear")]
            rows.append(compared(PASSENGER, quantity, 220, load, row[column], both[0], both[1], 0.10))
    both = [computed(PASSENGER, "stiffness", 220, 4000, motion) for motion in ("large", "linear")]
    rows.append(compared(PASSENGER, "stiffness", 220, 4000, 209.7, both[0], both[1], 0.10))
    rises = []
    for motion in ("large", "linear"):
        deflections = [computed(PASSENGER, "deflection", pressure, 4000, motion) for pressure in (200, 240)]
        stiffness = computed(PASSENGER, "stiffness", 220, 4000, motion)
        rises.append(-stiffness * np.diff(deflections)[0] / math.log(240 / 200) / 4000)
    rows.append(compared(PASSENGER, "rise of load with pressure", 220, 4000, 0.7097, rises[0], rises[1], 0.10))
    weight = next(float(row["mass [kg]"]) for row in table("prints") if row["tyre"] == PASSENGER)
    rows.append(compared(PASSENGER, "mass", 220, 0, 9.3, weight, weight, 0.10))
    for row in data("measured-205-60r15/summary.csv"):
        both = [
            computed(PASSENGER, "rolling resistance at 20 degC", 220, row["load [N]"], m) for m in ("large", "linear")
        ]
        measured = row["rolling_resistance_coefficient [1]"]
        goal = 0.20
        rows.append(compared(PASSENGER, "rolling resistance", 220, row["load [N]"], measured, both[0], both[1], goal))
    return rows


def load_radius() -> list[Comparison]:
    """The RE-71R: stiffness at 3560 N and its rise with pressure."""
    rows, values = [], []
    data_rows = data("measured-255-40r17/load-radius-re71r.csv")
    for psi in (24, 27, 30, 33):
        points = [(row["loaded_radius [mm]"], row["load [N]"]) for row in data_rows if row["pressure [psi]"] == psi]
        radius, load = np.array(points).T
        fit = np.polyfit(radius, load, 2)
        at = np.interp(3560, load[::-1], radius[::-1])
        measured = float(-np.polyval(np.polyder(fit), at))
        both = [computed(RE71R, "stiffness", psi * PSI, 3560, motion) for motion in ("large", "linear")]
        values.append((psi * PSI, measured, *both))
        rows.append(compared(RE71R, "stiffness", psi * PSI, 3560, measured, both[0], both[1], 0.10))
    pressures, *columns = zip(*(row for row in values if not math.isnan(sum(row))), strict=True)
    rises = [slope(pressures, column) for column in columns]
    rows.append(
        compared(RE71R, "rise of stiffness with pressure", 28.5 * PSI, 3560, rises[0], rises[1], rises[2], 0.15)
    )
    return rows


def prints() -> list[Comparison]:
    """The ECF's ink prints."""
    rows = []
    for row in data("measured-255-40r17/footprints-ecf.csv"):
        pressure, load = row["pressure [psi]"] * PSI, row["load [lbf]"] * LBF
        for quantity, column, unit in (
            ("length", "length [in]", INCH),
            ("width", "width [in]", INCH),
            ("gross area", "gross_area [in**2]", INCH**2 / 100),
            ("net area", "net_area [in**2]", INCH**2 / 100),
        ):
            both = [computed(ECF, quantity, pressure, load, motion) for motion in ("large", "linear")]
            rows.append(compared(ECF, quantity, pressure, load, row[column] * unit, both[0], both[1], 0.10))
    return rows


def comparison() -> list[Comparison]:
    """All rows."""
    return [*passenger(), *load_radius(), *prints()]


def aircraft_facts() -> dict[str, float]:
    """Quantiles of computed over catalogue deflection, and of the loads at the bottoming radius."""
    rows = table("aircraft")
    ratio = np.array([float(row["computed over catalogue"]) for row in rows])
    loads = np.array([[float(row[key]) for key in row if "lbf" in key] for row in rows])
    loads = loads[~np.isnan(loads).any(axis=1)]
    ranks = loads.argsort(axis=0).argsort(axis=0)
    low, median, high = np.quantile(ratio, [0.05, 0.5, 0.95])
    return {
        "tyres": len(ratio),
        "median": float(median),
        "5 %": float(low),
        "95 %": float(high),
        "within 20 %": float((abs(ratio - 1) <= 0.2).mean()),
        "with bottoming load": len(loads),
        "median of bottoming loads": float(np.median(loads[:, 1] / loads[:, 0])),
        "order of bottoming loads": float(np.corrcoef(ranks.T)[0, 1]),
    }


def page_tables() -> str:
    """The tables of the page."""
    rows = comparison()
    units = {
        "deflection": "mm",
        "stiffness": "N/mm",
        "length": "mm",
        "width": "mm",
        "rolling radius": "mm",
        "mass": "kg",
    }
    lines = [
        "| tyre | quantity | kPa | N | measured | computed | motion | linear | E, % | u_val, % | verdict | goal, % "
        "| met |",
        "|" + "---|" * 13,
    ]
    for row in rows:
        if row.tyre == ECF:
            continue
        name = f"{row.quantity}, {units[row.quantity]}" if row.quantity in units else row.quantity
        if row.quantity == "rolling resistance":
            name = "rolling resistance coefficient"
        numbers = f"{row.measured:.4g} | {row.computed:.4g} | {row.motion} | {row.linear:.4g}"
        lines.append(
            f"| {row.tyre} | {name} | {row.kilopascal:.0f} | {row.newton:.0f} | {numbers} | {row.deviation:+.1f} | "
            f"{row.u_val:.1f} | {row.verdict} | {row.goal:.0f} | {row.goal_met} |"
        )
    lines += ["", f"Ink prints of the {ECF}, goal: rms 10 %.", ""]
    lines += ["| quantity | rows | rms of E, % | mean of E, % | u_val, % | met |", "|" + "---|" * 6]
    for quantity in ("length", "width", "gross area", "net area"):
        part = [row for row in rows if row.tyre == ECF and row.quantity == quantity and not math.isnan(row.deviation)]
        errors = np.array([row.deviation for row in part])
        rms = float(np.sqrt((errors**2).mean()))
        lines.append(
            f"| {quantity} | {len(part)} | {rms:.1f} | {errors.mean():+.1f} | {part[0].u_val:.1f} | "
            f"{'yes' if rms <= 10 else 'no'} |"
        )
    facts = aircraft_facts()
    lines += [
        "",
        "Bias aircraft tyres by the load law of NASA TR R-64.",
        "",
        "| what | value | goal | met |",
        "|---|---|---|---|",
    ]
    off = abs(facts["median"] - 1) <= 0.05
    lines += [
        f"| tyres | {facts['tyres']} | | |",
        f"| computed over catalogue deflection at rated load, median | {facts['median']:.3f} | 0.95 to 1.05 | "
        f"{'yes' if off else 'no'} |",
        f"| the same, 5 % and 95 % quantiles | {facts['5 %']:.3f}, {facts['95 %']:.3f} | | |",
        f"| share within 20 % | {facts['within 20 %']:.1%} | 90 % | {'yes' if facts['within 20 %'] >= 0.9 else 'no'} |",
        f"| tyres with a bottoming load | {facts['with bottoming load']} | | |",
        f"| load at the bottoming radius over bottoming load, median | {facts['median of bottoming loads']:.3f} | | |",
        f"| rank correlation of the two loads | {facts['order of bottoming loads']:.3f} | right order | "
        f"{'yes' if facts['order of bottoming loads'] > 0.95 else 'no'} |",
    ]  # fmt: skip
    measured = data("measured-205-60r15/summary.csv")
    loads = [row["load [N]"] for row in measured]
    cold = [computed(PASSENGER, "rolling resistance at 20 degC", 220, load, "large") for load in loads]
    warm = computed(PASSENGER, "rolling resistance at 50 degC", 220, 4000, "large")
    over_pressure = slope(
        (200, 240), [computed(PASSENGER, "rolling resistance at 20 degC", p, 4000, "large") for p in (200, 240)]
    )
    coefficients = [row["rolling_resistance_coefficient [1]"] for row in measured]
    trends = (ROOT / "studies/measured-205-60r15/rolling-resistance-j2452.csv").read_text(encoding="utf-8").splitlines()
    others = list(csv.DictReader(line for line in trends if not line.startswith("#")))
    load_trend = ", ".join(f"{float(row['beta']) - 1:+.2f}" for row in others)
    pressure_trend = ", ".join(f"{float(row['alpha']):+.2f}" for row in others)
    lines += [
        "", "Exponents of the rolling resistance coefficient.", "",
        "| over | computed | 205/60R15 (Magic Formula) | two other tyres (SAE J2452) |", "|---|---|---|---|",
        f"| load | {slope(loads, cold):+.2f} | {slope(loads, coefficients):+.2f} | {load_trend} |",
        f"| pressure | {over_pressure:+.2f} | | {pressure_trend} |", "",
        f"The coefficient at 4000 N is {cold[2]:.4f} with all rubber at 20 °C and {warm:.4f} at 50 °C; "
        f"measured: {coefficients[2]:.4f}.",
    ]  # fmt: skip
    return "\n".join(lines)


def _points(axes: object, column: str, pressure: float, tyre: str, color: str) -> None:
    for motion, style in (("large", "-"), ("linear", ":")):
        if column in CONTACT:
            rows = [row for row in table("prints") if row["tyre"] in tyre]
        else:
            rows = [row for row in table(SOURCES[tyre]) if row["motion"] == motion]
        rows = [row for row in rows if abs(float(row["pressure [kPa]"]) - pressure) < 0.5]
        key = next(key for key in rows[0] if key.split(" [")[0] == column)
        line = np.array(sorted((float(row["load [N]"]) / 1e3, float(row[key])) for row in rows))
        axes.plot(*line.T, ":" if column in CONTACT else style, color=color, lw=1.3)  # type: ignore[attr-defined]
        if motion == "large":
            wide = BAND * math.hypot(NUMERICAL[column], input_uncertainty(tyre, column))
            low, high = line[:, 1] * (1 - wide), line[:, 1] * (1 + wide)
            axes.fill_between(line[:, 0], low, high, color=color, alpha=0.15, lw=0)  # type: ignore[attr-defined]


def _panels(title: str, panels: Sequence[tuple[str, Callable[[object], None]]]) -> object:
    from tyrefem.reports.figures.style import FONT, add_axes, figure, tidy

    drawn = figure(8.2, 6.2)
    for number, (label, draw) in enumerate(panels):
        axes = add_axes(drawn, 0.75 + 4.0 * (number % 2), 0.5 + 2.85 * (1 - number // 2), 3.2, 2.3)
        draw(axes)
        axes.set_xlabel("load, kN", fontsize=FONT)
        axes.set_ylabel(label, fontsize=FONT)
        tidy(axes)
    drawn.suptitle(title, fontsize=FONT, y=0.995)
    return drawn


def draw_passenger() -> object:
    """205/60R15 at 2.2 bar."""
    rows = data("measured-205-60r15/summary.csv")
    names = {
        "deflection": "deflection",
        "length": "contact_length",
        "width": "contact_width",
        "rolling radius": "effective_rolling_radius",
    }

    def panel(quantity: str) -> Callable[[object], None]:
        def draw(axes: object) -> None:
            _points(axes, quantity, 220, PASSENGER, "#0072B2")
            pairs = [(r["load [N]"] / 1e3, r[f"{names[quantity]} [mm]"]) for r in rows]
            axes.plot(*zip(*pairs, strict=True), "o", color="#1b1b1b", ms=4)  # type: ignore[attr-defined]

        return draw

    return _panels(
        "205/60R15, 220 kPa. Points: measured; line: large motion; dotted: linear; band: 2 u of the computed",
        [(f"{quantity}, mm", panel(quantity)) for quantity in names],
    )


def draw_prints() -> object:
    """ECF ink prints."""
    rows = data("measured-255-40r17/footprints-ecf.csv")
    names = {
        "length": ("length [in]", INCH, "mm"),
        "width": ("width [in]", INCH, "mm"),
        "gross area": ("gross_area [in**2]", INCH**2 / 100, "cm²"),
        "net area": ("net_area [in**2]", INCH**2 / 100, "cm²"),
    }

    def panel(quantity: str) -> Callable[[object], None]:
        column, unit, _ = names[quantity]

        def draw(axes: object) -> None:
            for psi, color in ((26, "#0072B2"), (28, "#009E73"), (30, "#D55E00")):
                part = [r for r in rows if r["pressure [psi]"] == psi]
                _points(axes, quantity, psi * PSI, ECF, color)
                pairs = [(r["load [lbf]"] * LBF / 1e3, r[column] * unit) for r in part]
                axes.plot(*zip(*pairs, strict=True), "o", color=color, ms=4, label=f"{psi * PSI:.0f} kPa")  # type: ignore[attr-defined]
            axes.legend(fontsize=7, frameon=False)  # type: ignore[attr-defined]

        return draw

    return _panels(
        "255/40ZR17 ECF, ink prints. Points: measured; dotted: computed, linear; band: 2 u of the computed",
        [(f"{quantity}, {names[quantity][2]}", panel(quantity)) for quantity in names],
    )


def draw_radius() -> object:
    """RE-71R: load over loaded radius."""
    from tyrefem.reports.figures.style import FONT, add_axes, figure, tidy

    drawn = figure(6.4, 4.2)
    axes = add_axes(drawn, 0.7, 0.55, 5.3, 3.25)
    rows = data("measured-255-40r17/load-radius-re71r.csv")
    for psi, color in ((24, "#0072B2"), (27, "#009E73"), (30, "#D55E00"), (33, "#CC79A7")):
        part = [(r["loaded_radius [mm]"], r["load [N]"] / 1e3) for r in rows if r["pressure [psi]"] == psi]
        axes.plot(*zip(*part, strict=True), "o", ms=3, color=color, label=f"{psi * PSI:.0f} kPa")
        for motion, style in (("large", "-"), ("linear", ":")):
            chosen = [
                r
                for r in table("radius")
                if r["motion"] == motion and abs(float(r["pressure [kPa]"]) - psi * PSI) < 0.5
            ]
            if not chosen:
                continue
            line = sorted(
                (float(r["loaded radius [mm]"]), float(r["load [N]"]) / 1e3, float(r["deflection [mm]"]))
                for r in chosen
            )
            free = line[-1][0] + line[-1][2]
            r, load, deflection = np.array([*line, (free, 0.0, 0.0)]).T
            axes.plot(r, load, style, color=color, lw=1.2)
            if motion == "large":
                wide = BAND * math.hypot(NUMERICAL["deflection"], input_uncertainty(RE71R, "deflection")) * deflection
                axes.fill_betweenx(load, r - wide, r + wide, color=color, alpha=0.12, lw=0)
    axes.set_xlabel("loaded radius, mm", fontsize=FONT)
    axes.set_ylabel("load, kN", fontsize=FONT)
    axes.legend(fontsize=8, frameon=False)
    tidy(axes)
    drawn.suptitle(
        "255/40R17 RE-71R. Points: measured; lines: large motion, band 2 u; dotted: linear", fontsize=FONT, y=0.99
    )
    return drawn


def draw_aircraft() -> object:
    """Catalogue and computed deflections of 395 bias tyres."""
    from tyrefem.reports.figures.style import FONT, add_axes, figure, tidy

    drawn = figure(5.2, 4.4)
    axes = add_axes(drawn, 0.7, 0.55, 4.2, 3.5)
    pairs = np.array(
        [(float(r["catalogue deflection [mm]"]), float(r["computed deflection [mm]"])) for r in table("aircraft")]
    )
    ends = np.array([0.0, 140.0])  # one row, a slip of the transcription, lies beyond
    axes.fill_between(ends, 0.8 * ends, 1.2 * ends, color="#009E73", alpha=0.15, lw=0, label="20 % either way")
    axes.plot(ends, ends, color="#6a6a6a", lw=1)
    axes.plot(*pairs.T, ".", color="#0072B2", ms=4, label="tyre of the data book")
    axes.set_xlim(*ends)
    axes.set_ylim(*ends)
    axes.set_xlabel("catalogue deflection at rated load, mm", fontsize=FONT)
    axes.set_ylabel("computed by TR R-64, mm", fontsize=FONT)
    axes.legend(fontsize=8, frameon=False)
    tidy(axes)
    return drawn


def main() -> None:
    """Write the comparison's table, the page's tables and the figures."""
    from tyrefem.output import atomic_path
    from tyrefem.reports.figures.style import png

    with atomic_path(TABLES / "measured-comparison.csv") as path, open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([field.name for field in fields(Comparison)])
        writer.writerows(astuple(row) for row in comparison())
    text = PAGE.read_text(encoding="utf-8")
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}\n\n{page_tables()}\n\n{END}{after}", encoding="utf-8")
    for name, draw in (
        ("passenger", draw_passenger),
        ("radius", draw_radius),
        ("prints", draw_prints),
        ("aircraft", draw_aircraft),
    ):
        (PICTURES / f"measured-{name}.png").write_bytes(png(draw()))  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
