"""Light-truck tyres whose size gives the diameter: ``31x10.50R15LT``; their diameter, rim, load and pressure."""

from __future__ import annotations

from tyrefem.sizes.load_index import GRAVITY
from tyrefem.sizes.rules import UNITS

INCH, PSI = UNITS["in"][1], UNITS["psi"][1]
STANDARD = "Tire and Rim Association, UN R54 (from memory)"
#: A new highway tread lies so far below the nominal diameter, m; traction treads half of it.
BELOW_NOMINAL = 0.5 * INCH
DIAMETER_SOURCE = (
    f"{STANDARD}: 0.5 in below the nominal diameter; traction treads 0.25 in below it "
    "(catalogue of the Radar Renegade X: 781, 832, 883 mm for 31, 33, 35 in)"
)
#: Measuring rim, and the rim of the nominal width, over the nominal width.
RIM_SHARE = 0.8
RIM_SOURCE = (
    "0.8 nominal widths to the half inch: the measuring rims 8.5, 10, 11, 12.5 in of 10.50, 12.50, 13.50, 15.50 in in "
    "the catalogue of the Radar Renegade X"
)
WIDTH_SOURCE = "rule of ETRTO; 268, 318, 346 mm for 10.50, 12.50, 13.50 in in the catalogue of the Radar Renegade X"
#: Allowed rims, so much narrower and wider than the measuring rim, of the nominal width: 7 to 9 in for 10.50, 8 to 11
#: in for 12.50, 9.5 to 12 in for 13.50, 11 to 14 in for 15.50 in that catalogue.
RIM_REACH = (0.16, 0.1)
TREAD_SHARE = 0.81
TREAD_SOURCE = "estimate: 0.81 nominal widths (makers' catalogues, from memory)"
#: Pressure of the load ranges, psi, up to `NARROW` of nominal width and wider (Tire and Rim Association, from memory).
NARROW = 11.5 * INCH
NARROW_PRESSURES = {"C": 50, "D": 65, "E": 80}
WIDE_PRESSURES = {"C": 35, "D": 50, "E": 65, "F": 80}
#: Load by volume at 50 psi and a width of 12.5 in, kg/l, and exponents of width and pressure: 174 loads of 24 sizes of
#: a load table (tirepressure.com), within 3 % where that table does not stop at the load of a lower pressure.
DENSITY, WIDTH_EXPONENT, PRESSURE_EXPONENT = 29.7, -0.65, 0.65
#: A load index is carried at a pressure whose load by volume is this share of it: the 3 % of the rule.
LEAST_SHARE = 0.97
LOAD_SOURCE = (
    "29.7 kg per litre of width x height x mean diameter x (12.5 in/width)^0.65 x (pressure/50 psi)^0.65, "
    "within 3 % of a load table of 24 sizes (tirepressure.com)"
)


def load_by_volume(width: float, height: float, rim_diameter: float, pressure: float) -> float:
    """Load by the size's volume, N.

    >>> round(load_by_volume(12.5 * INCH, 8.75 * INCH, 15 * INCH, 35 * PSI) / GRAVITY)
    1003
    """
    volume = width * height * (rim_diameter + height) * 1e3
    width_factor = (width / (12.5 * INCH)) ** WIDTH_EXPONENT
    return float(DENSITY * volume * width_factor * (pressure / (50 * PSI)) ** PRESSURE_EXPONENT * GRAVITY)


def pressure_of(
    width: float, height: float, rim_diameter: float, load_range: str | None, load: float | None
) -> tuple[float, str]:
    """Rated pressure, Pa, and its source: of the load range; else the lowest that carries the load; else load range C.

    >>> pressure_of(10.5 * INCH, 7.75 * INCH, 15 * INCH, "C", None)[0] / PSI
    50.0
    """
    pressures = NARROW_PRESSURES if width <= NARROW + 1e-6 else WIDE_PRESSURES
    words = "Tire and Rim Association, from memory"
    if load_range is not None:
        return pressures[load_range] * PSI, f"of load range {load_range} ({words})"
    if load is None:
        return pressures["C"] * PSI, f"estimate: load range C, as the size names none ({words})"
    carries = (
        letter
        for letter, pressure in pressures.items()
        if load_by_volume(width, height, rim_diameter, pressure * PSI) > LEAST_SHARE * load
    )
    lowest = next(carries, None)
    letter = lowest or max(pressures)
    reason = "the lowest that carries" if lowest else "the highest, which by volume carries less than"
    return pressures[letter] * PSI, f"estimate: load range {letter}, {reason} the load index ({words})"
