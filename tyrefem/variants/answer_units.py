"""Answers in words: name, number, unit."""

from __future__ import annotations

from tyrefem.output import key_units
from tyrefem.output.key_units import ending, readable

#: Words for answers whose name alone is not clear.
WORDS = {
    "hottest_degC": "highest temperature",
    "hottest_s_m": "place of the highest temperature along the meridian",
    "hottest_depth_m": "depth of the highest temperature",
    "hottest_time_s": "time of the highest temperature",
    "rolling_resistance_coefficient": "rolling resistance coefficient",
    "rolling_resistance_coefficient_cold": "cold rolling resistance coefficient",
    "rolling_resistance_N": "rolling resistance",
    "contained-air_degC": "contained air at the end",
    "gas_pressure_Pa": "pressure of the contained air at the end",
    "rim_degC": "rim at the end",
    "gradient_K_m": "steepest gradient through the wall",
    "gradient_s_m": "place of the steepest gradient along the meridian",
    "mass_kg": "mass",
    "life_km": "shortest fatigue life",
    "life_log10_km": "log10 of the shortest fatigue life in km",
    "life_s_m": "place along the meridian that fails first",
    "life_place_degC": "temperature of the place that fails first",
    "life_peak_J_m3": "peak cracking energy of the place that fails first",
    "time_to_limit_s": "time to the given temperature",
}


def shown(name: str, value: float, digits: int = 4) -> str:
    """An answer as text with its unit; NaN is "never" as a time, else "none", as the share of a boundary in no heat.

    >>> shown("hottest_degC", 81.234), shown("rolling_resistance_coefficient", 0.01)
    ('81.23 °C', '0.01')
    >>> shown("time_to_limit_s", float("nan")), shown("lost_rim_share", float("nan"))
    ('never', 'none')
    """
    if value != value:
        return "never" if name.endswith("_s") else "none"
    number = f"{value:.{digits}g}"
    return f"{number} {unit_of(name)}".strip()


def name_of(answer: str) -> str:
    """An answer in words.

    >>> name_of("hottest_degC"), name_of("crown-inner_max_degC"), name_of("load_N")
    ('highest temperature', 'crown-inner max', 'load')
    """
    end = ending(answer)
    # "tkph" is a name and its unit in one.
    without = answer.removesuffix(end) if end.startswith("_") else answer
    return WORDS.get(answer, without.replace("_", " "))


def unit_of(name: str) -> str:
    """Unit of an answer, from the end of its name; °C for temperatures, empty for shares and coefficients.

    >>> unit_of("hottest_degC"), unit_of("life_peak_J_m3"), unit_of("films_W_m2_K")
    ('°C', 'J/m³', 'W/m²/K')
    """
    return readable(key_units.unit_of(name))


def difference_unit(name: str) -> str:
    """Unit of the difference between two answers; K for temperatures."""
    return "K" if name.endswith("_degC") else unit_of(name)
