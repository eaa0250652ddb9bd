"""Answers in words: name, number, unit."""

from __future__ import annotations

#: Words for answers whose name alone is not clear.
WORDS = {
    "hottest_degC": "highest temperature",
    "rolling_resistance_coefficient": "rolling resistance coefficient",
    "rolling_resistance_N": "rolling resistance",
    "contained-air_degC": "contained air at the end",
    "gradient_K_m": "steepest gradient through the carcass",
    "mass_kg": "mass",
    "life_km": "shortest fatigue life",
    "life_log10_km": "log10 of the shortest fatigue life in km",
    "life_place_degC": "temperature of the place that fails first",
    "time_to_limit_s": "time to the given temperature",
}
_UNITS = {
    "_log10_km": "", "_km": "km", "_J_m3": "J/m³",
    "_degC": "°C", "_K_m": "K/m", "_Pa": "Pa", "_kg": "kg", "_J": "J", "_N": "N", "_time_s": "s", "_limit_s": "s",
    "_m": "m",
}  # fmt: skip


def shown(name: str, value: float, digits: int = 4) -> str:
    """An answer as text with its unit; NaN (a temperature that was not reached) is "never".

    >>> shown("hottest_degC", 81.234), shown("rolling_resistance_coefficient", 0.01)
    ('81.23 °C', '0.01')
    """
    if value != value:
        return "never"
    number = f"{value:.{digits}g}"
    return f"{number} {unit_of(name)}".strip()


def name_of(answer: str) -> str:
    """An answer in words.

    >>> name_of("hottest_degC"), name_of("crown-inner_max_degC")
    ('highest temperature', 'crown-inner max')
    """
    return WORDS.get(answer, answer.removesuffix("_degC").replace("_", " "))


def unit_of(name: str) -> str:
    """Unit of an answer, from the end of its name; °C for temperatures, empty for shares and coefficients."""
    for end, unit in _UNITS.items():
        if name.endswith(end):
            return unit
    return ""


def difference_unit(name: str) -> str:
    """Unit of the difference between two answers; K for temperatures."""
    return "K" if name.endswith("_degC") else unit_of(name)
