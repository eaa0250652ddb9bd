"""Measured tyres beside computed ones: deviation, uncertainty and verdict of every row, of the stored tables."""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
TABLES = ROOT / "docs/evidence/tables"
LBF, PSI, INCH = 4.4482216152605, 6.894757293168361, 25.4
PASSENGER, RE71R, ECF = "205/60R15", "255/40R17 RE-71R", "255/40ZR17 ECF"
SOURCES = {PASSENGER: "passenger", RE71R: "radius", ECF: "prints"}
#: Quantities of the contact.
CONTACT = ("length", "width", "gross area", "net area")
#: The tyre whose sensitivities a tyre takes.
VARIED = {PASSENGER: PASSENGER, RE71R: PASSENGER, ECF: ECF}
#: Standard uncertainty of a measured value, relative: estimates.
MEASURED = {"deflection": 0.03, "stiffness": 0.03, "length": 0.03, "width": 0.05, "gross area": 0.04, "net area": 0.05,
            "rolling radius": 0.005, "mass": 0.01, "rise": 0.05, "rolling resistance": 0.10}  # fmt: skip
#: Tolerance of a balance: a part of the numerical uncertainty, beside mesh and harmonics.
TOLERANCE, TOLERANCES = 0.001, {"mass": 0.0, "rolling radius": 0.0}
#: Of a rise with pressure: two deflections known to half a per cent at pressures a fifth apart; inputs: estimate.
RISE = (0.05, 0.05)


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


@functools.cache
def table(name: str) -> tuple[dict[str, str], ...]:
    """Rows of a table of benchmarks/measured.py."""
    with (TABLES / f"measured-{name}.csv").open(encoding="utf-8", newline="") as lines:
        return tuple(csv.DictReader(lines))


def data(path: str) -> list[dict[str, float]]:
    """Rows of a measured table of numbers."""
    lines = (ROOT / "studies" / path).read_text(encoding="utf-8").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [{key: float(value) for key, value in row.items()} for row in rows]


def column(row: dict[str, str], quantity: str) -> float:
    """A quantity of a row of a table, whatever its unit."""
    return next(float(value) for key, value in row.items() if key.split(" [")[0] == quantity)


def rows_at(tyre: str, pressure: float, motion: str) -> list[dict[str, str]]:
    """Computed rows of a tyre at a pressure, kPa."""
    rows = table(SOURCES[tyre])
    return [row for row in rows if row["motion"] == motion and abs(float(row["pressure [kPa]"]) - pressure) < 0.5]


def computed(tyre: str, quantity: str, pressure: float, load: float, motion: str) -> float:
    """A computed value at a pressure, kPa, and a load, N; nan: none.

    Stiffness in large motion: slope of the parabola through the origin and the loads, as the measured one of a Magic
    Formula.
    """
    rows = rows_at(tyre, pressure, motion)
    if quantity == "stiffness" and motion == "large" and rows:
        deflections, loads = (np.array([column(row, key) for row in rows]) for key in ("deflection", "load"))
        powers = np.stack([deflections, deflections**2], axis=1)
        (a, b), *_ = np.linalg.lstsq(powers / loads[:, None], np.ones(len(loads)), rcond=None)
        return float(math.sqrt(a * a + 4 * b * load))
    near = [row for row in rows if abs(column(row, "load") / load - 1) < 0.01]
    return column(near[0], quantity) if near else math.nan


def _relative(name: str, tyre: str, quantity: str) -> dict[str, float]:
    """Relative change of a quantity in each row of a table against the tyre's first."""
    rows = [row for row in table(name) if row["tyre"] == VARIED[tyre] and row["motion"] == "large"]
    nominal = column(rows[0], quantity)
    return {row["number"]: column(row, quantity) / nominal - 1 for row in rows[1:]}


def changes(tyre: str, quantity: str) -> dict[str, float]:
    """Uncertain number -> relative change of a quantity when it is one standard deviation higher."""
    return _relative("sensitivities", tyre, quantity)


def uncertainties(tyre: str, quantity: str) -> tuple[float, float, float]:
    """Standard uncertainties, relative: of the measured value, of the numerics and of the inputs.

    A stiffness takes those of the deflection, because it is a slope through several loads. Those of a rise with
    pressure are estimates. Contact jumps with the grid, so that it takes the larger numerical change of two tyres.
    """
    kind = next(key for key in MEASURED if quantity.startswith(key))
    if kind == "rise":
        return MEASURED[kind], *RISE
    of = {"rolling resistance": "rolling resistance at 20 degC", "stiffness": "deflection"}.get(kind, kind)
    tolerance = TOLERANCES.get(kind, TOLERANCE)
    tyres = (PASSENGER, ECF) if kind in CONTACT else (tyre,)
    numerical = max(math.hypot(*_relative("numerics", other, of).values(), tolerance) for other in tyres)
    return MEASURED[kind], numerical, math.hypot(*changes(tyre, of).values())


def compared(
    tyre: str, quantity: str, pressure: float, load: float, measured: float, large: float, linear: float, goal: float
) -> Comparison:
    """One row with its verdict in the manner of V&V 20: E = computed - measured against u_val."""
    parts = uncertainties(tyre, quantity)
    u_val = math.hypot(*parts)
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
    numbers = [float(f"{value:.5g}") for value in (pressure, load, measured, large, linear)]
    row = (*numbers[:4], "as drawn" if quantity == "mass" else "large", numbers[4], *percent)
    return Comparison(tyre, quantity, *row, verdict, round(100 * goal, 6), met)


def slope(x: Sequence[float], y: Sequence[float]) -> float:
    """Exponent of y over x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def both(tyre: str, quantity: str, pressure: float, load: float) -> tuple[float, float]:
    """The computed value in large motion, which is compared, and that in linear motion."""
    large, linear = (computed(tyre, quantity, pressure, load, motion) for motion in ("large", "linear"))
    return large, linear


def passenger() -> list[Comparison]:
    """The 205/60R15."""
    rows, summary = [], data("measured-205-60r15/summary.csv")
    for row in summary:
        load = row["load [N]"]
        for quantity, name in (
            ("deflection", "deflection [mm]"),
            ("length", "contact_length [mm]"),
            ("width", "contact_width [mm]"),
            ("rolling radius", "effective_rolling_radius [mm]"),
        ):
            pair = both(PASSENGER, quantity, 220, load)
            rows.append(compared(PASSENGER, quantity, 220, load, row[name], *pair, 0.10))
    pair = both(PASSENGER, "stiffness", 220, 4000)
    rows.append(compared(PASSENGER, "stiffness", 220, 4000, 209.7, *pair, 0.10))
    rises = []
    for motion, stiffness in zip(("large", "linear"), pair, strict=True):
        deflections = [computed(PASSENGER, "deflection", pressure, 4000, motion) for pressure in (200, 240)]
        rises.append(-stiffness * np.diff(deflections)[0] / math.log(240 / 200) / 4000)
    rows.append(compared(PASSENGER, "rise of load with pressure", 220, 4000, 0.7097, *rises, 0.10))
    rows.append(compared(PASSENGER, "mass", 220, 4000, 9.3, *both(PASSENGER, "mass", 220, 4000), 0.10))
    for row in summary:
        measured = row["rolling_resistance_coefficient [1]"]
        pair = both(PASSENGER, "rolling resistance at 20 degC", 220, row["load [N]"])
        rows.append(compared(PASSENGER, "rolling resistance", 220, row["load [N]"], measured, *pair, 0.20))
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
        pair = both(RE71R, "stiffness", psi * PSI, 3560)
        values.append((psi * PSI, measured, *pair))
        rows.append(compared(RE71R, "stiffness", psi * PSI, 3560, measured, *pair, 0.10))
    pressures, *columns = zip(*(row for row in values if not math.isnan(sum(row))), strict=True)
    rises = [slope(pressures, values) for values in columns]
    rows.append(compared(RE71R, "rise of stiffness with pressure", 28.5 * PSI, 3560, *rises, 0.15))
    return rows


def prints() -> list[Comparison]:
    """The ECF's ink prints."""
    rows = []
    for row in data("measured-255-40r17/footprints-ecf.csv"):
        pressure, load = row["pressure [psi]"] * PSI, row["load [lbf]"] * LBF
        for quantity, name, unit in (
            ("length", "length [in]", INCH),
            ("width", "width [in]", INCH),
            ("gross area", "gross_area [in**2]", INCH**2 / 100),
            ("net area", "net_area [in**2]", INCH**2 / 100),
        ):
            pair = both(ECF, quantity, pressure, load)
            rows.append(compared(ECF, quantity, pressure, load, row[name] * unit, *pair, 0.10))
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
