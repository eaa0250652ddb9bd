"""Coefficients of the Magic Formula from points of forces, by least squares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.tyre_forces.magic_formula import MagicFormula
from tyrefem.tyre_forces.points import ZERO, ForcePoints

Array = NDArray[np.float64]
#: Bounds: shape factors as in published fits, bends at most 1, friction positive. Others are free.
BOUNDS: dict[str, tuple[float, float]] = {
    "PCX1": (1.0, 2.2), "PDX1": (0.05, 5.0), "PEX1": (-30.0, 1.0), "PEX4": (-0.9, 0.9), "PKX1": (1.0, 200.0),
    "PCY1": (1.0, 2.2), "PDY1": (0.05, 3.0), "PEY1": (-12.0, 1.0), "PEY3": (-0.9, 0.9), "PKY1": (-200.0, -0.5),
    "PKY2": (0.2, 8.0), "QBZ1": (0.5, 60.0), "QCZ1": (0.6, 1.6), "QEZ1": (-30.0, 1.0), "QDZ1": (-0.5, 0.5),
}  # fmt: skip
#: First values.
START = {"PCX1": 1.6, "PDX1": 1.0, "PKX1": 20.0, "PCY1": 1.3, "PDY1": 1.0, "PKY1": -20.0, "PKY2": 1.5, "PKY4": 2.0}
START |= {"QBZ1": 10.0, "QCZ1": 1.1, "QDZ1": 0.1, "QBZ10": 1.0}
#: Coefficients that a number of loads at least can tell: of the first power of dfz two loads, of the second three.
LONGITUDINAL = {
    1: "PCX1 PDX1 PEX1 PKX1", 2: "PDX2 PEX2 PKX2", 3: "PEX3 PKX3",
}  # fmt: skip
LATERAL = {1: "PCY1 PDY1 PEY1 PKY1", 2: "PDY2 PEY2 PKY2"}
ALIGNING = {1: "QBZ1 QCZ1 QDZ1 QEZ1", 2: "QBZ2 QDZ2 QEZ2", 3: "QBZ3 QEZ3"}
#: Coefficients of what is not odd in the slip (ply steer, conicity), where both signs are given.
LONGITUDINAL_ODD = {1: "PEX4 PHX1 PVX1", 2: "PHX2 PVX2"}
LATERAL_ODD = {1: "PEY3 PHY1 PVY1", 2: "PHY2 PVY2"}
ALIGNING_ODD = {1: "QHZ1 QDZ6 QEZ4", 2: "QHZ2 QDZ7"}
#: Coefficients of the camber, where several cambers are given. The trail changes with its square: programs read QDZ3
#: with |camber| (Pacejka 2012, 4.E43) or with its sign (Besselink et al. 2010, A60).
LATERAL_CAMBER = {1: "PDY3 PKY3 PKY6 PVY3", 2: "PKY7 PVY4"}
ALIGNING_CAMBER = {1: "QBZ5 QDZ4 QDZ8 QHZ3", 2: "QDZ9 QHZ4"}
#: Coefficients of the pressure, where several pressures are given.
LONGITUDINAL_PRESSURE, LATERAL_PRESSURE, ALIGNING_PRESSURE = "PPX1 PPX3", "PPY1 PPY2 PPY3", "PPZ1"
#: Coefficients that must not be zero, fitted or not; the stiffness, whose first value the points give.
NEEDED = {
    "longitudinal": ("PCX1", "PDX1"),
    "lateral": ("PCY1", "PDY1", "PKY2", "PKY4"),
    "aligning": ("QBZ1", "QCZ1", "QDZ1", "QBZ10"),
}
#: Different slips, both signs alike, that a kind of coefficient needs: slope, peak, shape, curvature. Those of the
#: camber need slips of cambered points.
SLIPS = {"PD": 2, "QB": 2, "PC": 3, "QC": 3, "PE": 4, "QE": 4}
CAMBERED_SLIPS = {"PKY3": 1, "QDZ4": 1, "PDY3": 3, "QBZ5": 3}
SLOPE = {"longitudinal": "PKX1", "lateral": "PKY1"}
#: Fewest points of a fit.
FEWEST = 4
#: Pull towards the first values: it decides where two coefficients do the same.
PULL = 1e-5
ITERATIONS = 200
#: Loads, cambers and pressures nearer than this share count as the same.
SAME = 0.02


@dataclass(frozen=True, eq=False)
class MagicFormulaFit(Brief):
    """A fitted Magic Formula. Made by `fit_magic_formula`.

    Parameters
    ----------
    formula : the Magic Formula. points : what it was fitted to.
    fitted : names of the coefficients that the points could tell; the others are zero, or the first values.
    errors : "longitudinal", "lateral", "aligning" -> root mean square of the deviation over the largest force or
        moment; only what was fitted.
    """

    formula: MagicFormula
    points: ForcePoints
    fitted: tuple[str, ...]
    errors: Mapping[str, float]

    def summary(self) -> dict[str, Any]:
        """Plain data, SI; ``coefficients``: fitted ones and all others that are not zero."""
        formula = self.formula
        coefficients = {name: float(value) for name, value in formula.coefficients.items()}
        return {
            "nominal_load_N": formula.nominal_load,
            "nominal_pressure_Pa": formula.nominal_pressure,
            "unloaded_radius_m": formula.radius,
            "points": len(self.points),
            "rms_over_largest": dict(self.errors),
            "coefficients": {name: value for name, value in coefficients.items() if value or name in self.fitted},
        }


def fit_magic_formula(
    points: ForcePoints,
    radius: float,
    *,
    nominal_load: float | None = None,
    nominal_pressure: float | None = None,
    symmetric: bool = False,
) -> MagicFormulaFit:
    """The Magic Formula 6.1 that fits points of pure slip best, in the least squares of force over load.

    F_x is fitted to the points that roll straight ahead; F_y, then M_z, to those of zero slip. Coefficients that the
    points cannot tell (one load, no camber, one sign of slip, few slips) stay zero, or first values:
    `MagicFormulaFit.fitted` names the others.

    Parameters
    ----------
    points : at least four of each force that is to be fitted.
    radius : of the unloaded tyre, m. nominal_load : N; by default the mean of the smallest and the largest load.
    nominal_pressure : Pa; by default the median.
    symmetric : a tyre that is its own mirror image: without camber it has no ply steer and no conicity.

    Raises
    ------
    InputError : too few points for any force.
    """
    load = (points.load.min() + points.load.max()) / 2 if nominal_load is None else nominal_load
    pressure = float(np.median(points.pressure)) if nominal_pressure is None else nominal_pressure
    blank = MagicFormula({}, float(load), pressure if pressure > 0 else 1.0, radius)
    known: dict[str, float] = {}
    fitted: list[str] = []
    errors: dict[str, float] = {}
    for part in _parts(points, radius, symmetric=symmetric):
        names = [name for stage in part.stages for name in stage]
        enough = len(part.points) >= max(FEWEST, len(names)) and np.abs(part.measured).max() > 0
        if not enough or (part.name == "aligning" and "lateral" not in errors):
            continue
        known = part.fitted(replace(blank, coefficients=known))
        fitted += names
        left = part.deviation(replace(blank, coefficients=known))
        errors[part.name] = float(np.sqrt((left**2).mean()) / np.abs(part.measured).max())
    if not errors:
        raise InputError(
            "too few points for a Magic Formula: at least four of slip straight ahead, or of slip angle without slip",
            field="points",
        )
    return MagicFormulaFit(replace(blank, coefficients=known), points, tuple(fitted), errors)


@dataclass(frozen=True, eq=False)
class _Part:
    """A force or moment: its points, measured values (n,), prediction, scale (n,), coefficients in stages."""

    name: str
    points: ForcePoints
    measured: Array
    predict: Callable[..., Array]
    scale: Array
    stages: list[list[str]]

    def deviation(self, formula: MagicFormula) -> Array:
        """Predicted minus measured."""
        points, cross = self.points, self.points.slip if self.name == "longitudinal" else self.points.slip_angle
        pressures = points.pressure if points.pressure.any() else None
        return np.asarray(self.predict(formula, points.load, cross, points.camber, pressures) - self.measured)

    def fitted(self, formula: MagicFormula) -> dict[str, float]:
        """All known coefficients, with this part's: each stage starts from the stages before."""
        values = dict(formula.coefficients) | {key: START[key] for key in NEEDED[self.name]}
        values |= {SLOPE[self.name]: _steepness(self.points, self.name)} if self.name in SLOPE else {}

        def residuals(trial: dict[str, float]) -> Array:
            return self.deviation(replace(formula, coefficients=values | trial)) / self.scale

        for last in range(1, len(self.stages) + 1):
            free = [name for stage in self.stages[:last] for name in stage]
            values.update(_least_squares(free, START | values, residuals))
        return values


def _parts(points: ForcePoints, radius: float, *, symmetric: bool) -> list[_Part]:
    ahead, rolling = points.where_if(points.straight), points.where_if(points.free)
    parts = []
    if ahead is not None:
        stages = _stages(ahead, LONGITUDINAL, LONGITUDINAL_ODD, {}, LONGITUDINAL_PRESSURE)
        predict = MagicFormula.longitudinal_force
        parts.append(_Part("longitudinal", ahead, ahead.longitudinal, predict, ahead.load, stages))
    if rolling is not None:
        stages = _stages(rolling, LATERAL, {} if symmetric else LATERAL_ODD, LATERAL_CAMBER, LATERAL_PRESSURE)
        parts.append(_Part("lateral", rolling, rolling.lateral, MagicFormula.lateral_force, rolling.load, stages))
        stages = _stages(rolling, ALIGNING, {} if symmetric else ALIGNING_ODD, ALIGNING_CAMBER, ALIGNING_PRESSURE)
        scale = 0.1 * radius * rolling.load
        parts.append(_Part("aligning", rolling, rolling.aligning, MagicFormula.aligning_moment, scale, stages))
    return parts


def _count(values: Array) -> int:
    """Number of different values."""
    ordered = np.sort(values)
    return 1 + int((np.diff(ordered) > SAME * max(np.abs(ordered).max(), ZERO)).sum())


def _stages(points: ForcePoints, always: Any, odd: Any, camber: Any, pressure: str) -> list[list[str]]:
    """Names of the coefficients that the points can tell, in the order in which they become free."""
    loads = _count(points.load)
    slip = points.slip + points.slip_angle
    level = np.abs(points.camber) <= ZERO
    slips, cambered = _slips(slip[level] if level.any() else slip), _slips(slip[~level])

    def tellable(names: str, needs: Mapping[str, int], known: int) -> list[str]:
        return [name for name in names.split() if known >= needs.get(name, needs.get(name[:2], 0))]

    tables = [always, *([odd] if slip.min() < -ZERO and slip.max() > ZERO else [])]
    stages = [tellable(those, SLIPS, slips) for table in tables for least, those in table.items() if loads >= least]
    if _count(points.camber) > 1:
        stages += [tellable(those, CAMBERED_SLIPS, cambered) for least, those in camber.items() if loads >= least]
    if _count(points.pressure) > 1:
        stages.append(pressure.split())
    return [stage for stage in stages if stage]


def _slips(slip: Array) -> int:
    """Number of different slips that are not zero, both signs alike."""
    moved = np.abs(slip)[np.abs(slip) > ZERO]
    return _count(moved) if moved.size else 0


def _steepness(points: ForcePoints, name: str) -> float:
    """First value of the stiffness over the load: median of the steeper half of the secants from the origin."""
    slip, force = (points.slip, points.longitudinal) if name == "longitudinal" else (points.slip_angle, points.lateral)
    moved = np.abs(slip) > ZERO
    first = START[SLOPE[name]]
    if not moved.any():
        return first
    secant = force[moved] / slip[moved] / points.load[moved] * np.sign(first)
    return float(np.sign(first) * max(np.quantile(secant, 0.75), 0.1 * abs(first)))


def _least_squares(
    names: list[str], start: Mapping[str, float], residuals: Callable[[dict[str, float]], Array]
) -> dict[str, float]:
    from scipy.optimize import least_squares

    low, high = np.array([BOUNDS.get(name, (-np.inf, np.inf)) for name in names]).T
    first = np.clip([start.get(name, 0.0) for name in names], low + 1e-6, high - 1e-6)
    scale = np.maximum(np.abs(first), 0.1)

    def deviations(x: Array) -> Array:
        return np.concatenate([residuals(dict(zip(names, x, strict=True))), PULL * (x - first) / scale])

    fit = least_squares(deviations, first, bounds=(low, high), x_scale=scale, max_nfev=ITERATIONS)
    return dict(zip(names, map(float, fit.x), strict=True))
