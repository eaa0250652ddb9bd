"""Units at the end of the keys of JSON files and of the columns of tables."""

from __future__ import annotations

#: End of a key -> unit; of two that fit, the longer one first.
UNITS = {
    "_W_m2_K": "W/m2/K", "_log10_km": "", "_mm_per_1000_km": "mm per 1000 km", "_mg_per_km": "mg/km", "_rad_s": "rad/s",
    "_m_rad": "m/rad", "_N_rad": "N/rad", "_km_h": "km/h", "_m2_s": "m2/s", "_m_s": "m/s", "_N_m": "N/m",
    "_K_m": "K/m", "_W_m3": "W/m3", "_W_m2": "W/m2", "_J_m3": "J/m3", "_J_m2": "J/m2", "_1_m": "1/m", "_m3": "m3",
    "_m2": "m2", "_degC": "degC", "_nats": "nats", "tkph": "t km/h", "_Nm": "N m", "_Pa": "Pa", "_rad": "rad",
    "_deg": "deg", "_km": "km", "_kg": "kg", "_Hz": "Hz", "_N": "N", "_W": "W", "_J": "J", "_K": "K", "_m": "m",
    "_s": "s",
}  # fmt: skip


def unit_of(key: str) -> str:
    """The unit at the end of a key; empty: a pure number, or no number.

    >>> unit_of("load_N"), unit_of("films_W_m2_K"), unit_of("gradient_K_m"), unit_of("harmonics")
    ('N', 'W/m2/K', 'K/m', '')
    """
    return UNITS.get(ending(key), "")


def ending(key: str) -> str:
    """The end of a key that is its unit; empty: a pure number, or no number.

    >>> ending("gradient_K_m"), ending("life_log10_km"), ending("harmonics")
    ('_K_m', '_log10_km', '')
    """
    return next((end for end in UNITS if key.endswith(end)), "")


def readable(unit: str) -> str:
    """A unit as people read it.

    >>> readable("degC"), readable("J/m3"), readable("m2/s")
    ('°C', 'J/m³', 'm²/s')
    """
    return unit.replace("degC", "°C").replace("m2", "m²").replace("m3", "m³")
