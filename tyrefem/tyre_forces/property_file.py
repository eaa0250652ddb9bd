"""`.tir` files: a fitted Magic Formula as vehicle simulators read it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.tyre_forces.fitting import MagicFormulaFit
from tyrefem.tyre_forces.magic_formula import ALL, NAMES, MagicFormula

#: Scaling factors of the standard: all 1.
SCALING = (
    "LFZO LCX LMUX LEX LKX LHX LVX LCY LMUY LEY LKY LHY LVY LTR LRES LXAL LYKA LVYKA LS LKYC LKZC LMUV LMX LVMX LMY LMP"
)
#: Those that act on pure slip: a file whose factor is not 1 holds other forces than its coefficients say.
OF_PURE_SLIP = tuple(
    name for name in SCALING.split() if name not in {"LXAL", "LYKA", "LVYKA", "LS", "LMUV", "LMX", "LVMX", "LMY", "LMP"}
)
#: Of combined slip: shape factors 1 and slopes 0 leave each pure force as it is.
COMBINED: dict[str, dict[str, float]] = {
    "LONGITUDINAL": {"RBX1": 0, "RBX2": 0, "RBX3": 0, "RCX1": 1, "REX1": 0, "REX2": 0, "RHX1": 0},
    "LATERAL": {
        "RBY1": 0, "RBY2": 0, "RBY3": 0, "RBY4": 0, "RCY1": 1, "REY1": 0, "REY2": 0, "RHY1": 0, "RHY2": 0, "RVY1": 0,
        "RVY2": 0, "RVY3": 0, "RVY4": 0, "RVY5": 0, "RVY6": 0,
    },
    "ALIGNING": {"SSZ1": 0, "SSZ2": 0, "SSZ3": 0, "SSZ4": 0},
}  # fmt: skip
#: Largest slope of the load over load / deflection; at 2 the root of simulators is 0, and by rounding no number.
STEEPEST = 1.98
#: Nominal values of a file, and all numbers that are read of it.
NOMINAL = ("FNOMIN", "NOMPRES", "UNLOADED_RADIUS")
READ = {*ALL, *NOMINAL, *OF_PURE_SLIP, "FITTYP"}
#: Units of a file that is read; a file without them is in these.
UNITS = {"LENGTH": ("meter", "metre", "m"), "FORCE": ("newton", "n"), "ANGLE": ("radians", "radian", "rad"),
         "PRESSURE": ("pascal", "pa")}  # fmt: skip
#: Width of names.
WIDTH = 24


@dataclass(frozen=True)
class TyreDimensions(Brief):
    """What a `.tir` file states beside the coefficients.

    Parameters
    ----------
    width, rim_radius, rim_width : m. aspect_ratio : 1. mass : kg.
    vertical_stiffness : N/m, slope of the load under the nominal load. speed : of the forces, m/s.
    deflection : m, under the nominal load; None: a linear spring.
    """

    width: float
    rim_radius: float
    rim_width: float
    aspect_ratio: float
    mass: float
    vertical_stiffness: float
    speed: float
    deflection: float | None = None


def tir_text(fit: MagicFormulaFit, dimensions: TyreDimensions, title: str, notes: tuple[str, ...] = ()) -> str:
    """Contents of a `.tir` file, FITTYP 61, SI units and radians, axes ISO-W, a tyre of the left side.

    Combined slip has neutral coefficients: the file holds forces of pure slip. ``notes`` are comments at the top.
    """
    formula, points = fit.formula, fit.points
    lines = ["[MDI_HEADER]", *_entries({"FILE_TYPE": "'tir'", "FILE_VERSION": 3.0, "FILE_FORMAT": "'ASCII'"})]
    quality = ", ".join(f"{name} {error:.2%}" for name, error in fit.errors.items())
    comments = [title, f"fit of {len(points)} points; rms over the largest: {quality}", *notes]
    lines += [f"! : COMMENT : {' '.join(text.split())}" for text in comments]
    largest = np.abs(points.slip).max() or 1.0
    angle, camber = np.abs(points.slip_angle).max() or 0.3, np.abs(points.camber).max()
    pressure = formula.nominal_pressure
    sections: dict[str, Mapping[str, object]] = {
        "UNITS": {
            "LENGTH": "'meter'", "FORCE": "'newton'", "ANGLE": "'radians'", "MASS": "'kg'", "TIME": "'second'",
            "PRESSURE": "'pascal'",
        },
        "MODEL": {"FITTYP": 61, "TYRESIDE": "'LEFT'", "LONGVL": dimensions.speed or 10.0, "VXLOW": 1.0},
        "DIMENSION": {
            "UNLOADED_RADIUS": formula.radius, "WIDTH": dimensions.width, "RIM_RADIUS": dimensions.rim_radius,
            "RIM_WIDTH": dimensions.rim_width, "ASPECT_RATIO": dimensions.aspect_ratio,
        },
        "OPERATING_CONDITIONS": {"INFLPRES": pressure, "NOMPRES": pressure},
        "INERTIA": {"MASS": dimensions.mass},
        "VERTICAL": {"FNOMIN": formula.nominal_load, **_spring(formula, dimensions)},
        "INFLATION_PRESSURE_RANGE": {
            "PRESMIN": points.pressure.min() or pressure, "PRESMAX": points.pressure.max() or pressure,
        },
        "VERTICAL_FORCE_RANGE": {"FZMIN": points.load.min(), "FZMAX": points.load.max()},
        "LONG_SLIP_RANGE": {"KPUMIN": -largest, "KPUMAX": largest},
        "SLIP_ANGLE_RANGE": {"ALPMIN": -angle, "ALPMAX": angle},
        "INCLINATION_ANGLE_RANGE": {"CAMMIN": -camber, "CAMMAX": camber},
        "SCALING_COEFFICIENTS": dict.fromkeys(SCALING.split(), 1),
    }  # fmt: skip
    for part, names in NAMES.items():
        known = {name: formula.coefficients.get(name, 0.0) for name in names}
        sections[f"{part}_COEFFICIENTS"] = known | COMBINED[part]
    sections["OVERTURNING_COEFFICIENTS"] = {"QSX1": 0, "QSX2": 0, "QSX3": 0}
    sections["ROLLING_COEFFICIENTS"] = {"QSY1": 0, "QSY2": 0}
    for section, entries in sections.items():
        lines += ["$" + "-" * 70, f"[{section}]", *_entries(entries)]
    return "\n".join(lines) + "\n"


def _spring(formula: MagicFormula, dimensions: TyreDimensions) -> dict[str, float]:
    """Load over deflection D of the Magic Formula 6.1: F_z = F_z0 (q_1 x + q_2 x²), x = D / R_0.

    Slope and deflection D_0 under the nominal load give q_1 and q_2: with x_0 = D_0 / R_0 and c = C_z0 R_0 / F_z0, the
    slope in x, q_1 = 2 / x_0 - c and q_2 = (c - 1 / x_0) / x_0. Simulators read C_z0 and q_2, and take
    q_1 = sqrt(c² - 4 q_2): a slope above `STEEPEST` F_z0 / D_0 is written as that, for q_1 > 0. A slope that large
    motion could not compute, no number, is written as F_z0 / D_0.
    """
    stiffness = dimensions.vertical_stiffness
    if dimensions.deflection is None:
        return {"VERTICAL_STIFFNESS": stiffness}
    secant = formula.nominal_load / dimensions.deflection
    stiffness = min(stiffness, STEEPEST * secant) if math.isfinite(stiffness) else secant
    slope, x = stiffness * formula.radius / formula.nominal_load, dimensions.deflection / formula.radius
    return {"VERTICAL_STIFFNESS": stiffness, "Q_FZ1": 2.0 / x - slope, "Q_FZ2": (slope - 1.0 / x) / x}


def _entries(entries: Mapping[str, object]) -> list[str]:
    def text(value: object) -> str:
        return value if isinstance(value, str) else f"{float(value):.8g}"  # type: ignore[arg-type]

    return [f"{name:{WIDTH}} = {text(value)}" for name, value in entries.items()]


def read_tir(path: str | Path) -> MagicFormula:
    """The pure slip of a `.tir` file with FITTYP 61.

    Raises
    ------
    InputError : no such file; another FITTYP; a number that cannot be read, or that stands twice with other values;
        nominal load, pressure or radius missing; a scaling factor of pure slip that is not 1; units that are not SI
        and radians.
    """
    try:
        lines = Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=path) from None
    values: dict[str, float] = {}
    for number, line in enumerate(lines, 1):
        name, equals, rest = line.split("$")[0].split("!")[0].partition("=")
        name, word = name.strip().upper(), rest.strip()
        if equals and name in UNITS:
            unit = word.strip("'\" ").lower()
            if unit not in UNITS[name]:
                message = f"line {number}: must be '{UNITS[name][0]}', not '{unit}': numbers are read in SI and radians"
                raise InputError(message, file=path, field=name)
        if not equals or name not in READ:
            continue
        try:
            value = float(word.strip("'\" "))
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(f"line {number}: '{word}' is not a number", file=path, field=name)
        if values.setdefault(name, value) != value:
            raise InputError(f"line {number}: is {value:g} here, {values[name]:g} above", file=path, field=name)
    if values.get("FITTYP") != 61:
        raise InputError(f"must be 61, not {values.get('FITTYP', 'missing')}", file=path, field="FITTYP")
    for name in NOMINAL:
        if name not in values:
            raise InputError("is missing", file=path, field=name)
        if not values[name] > 0:
            raise InputError(f"must be positive, not {values[name]:g}", file=path, field=name)
    for name in OF_PURE_SLIP:
        if values.get(name, 1.0) != 1.0:
            message = f"must be 1, not {values[name]:g}: the formula has no scaling factors"
            raise InputError(message, file=path, field=name)
    coefficients = {name: values[name] for name in ALL if name in values}
    return MagicFormula(coefficients, values["FNOMIN"], values["NOMPRES"], values["UNLOADED_RADIUS"])
