"""What a tyre carries: the load index, and the load at another pressure."""

from __future__ import annotations

from tyrefem.errors import InputError

GRAVITY = 9.80665
#: kg of the load indices 60 to 139 (ISO 4000-1, ETRTO; from memory). 80 indices higher it is ten times as much, of the
#: halves too that are left out here (257 for 257.5).
_MASSES = (
    *(250, 257, 265, 272, 280, 290, 300, 307, 315, 325, 335, 345, 355, 365, 375, 387, 400, 412, 425, 437),
    *(450, 462, 475, 487, 500, 515, 530, 545, 560, 580, 600, 615, 630, 650, 670, 690, 710, 730, 750, 775),
    *(800, 825, 850, 875, 900, 925, 950, 975, 1000, 1030, 1060, 1090, 1120, 1150, 1180, 1215, 1250, 1285, 1320, 1360),
    *(1400, 1450, 1500, 1550, 1600, 1650, 1700, 1750, 1800, 1850, 1900, 1950, 2000, 2060, 2120, 2180, 2240, 2300),
    *(2360, 2430),
)
#: Exponent of load over pressure: road tyres (ETRTO Standards Manual, general notes, from memory), aircraft tyres
#: (data books: inflation in proportion to the load).
ROAD_EXPONENT, AIRCRAFT_EXPONENT = 0.8, 1.0


def load_of_index(index: int) -> float:
    """The load of a load index, N, to 0.1 N.

    Raises
    ------
    InputError : outside 60 to 179.

    >>> round(load_of_index(91) / GRAVITY), round(load_of_index(152) / GRAVITY)
    (615, 3550)
    """
    if not 60 <= index < 180:
        raise InputError(f"load index {index} is outside 60 to 179", field="size")
    mass = _MASSES[index - 60] if index < 140 else 10 * _MASSES[index - 140]
    if index >= 140 and mass % 100 in (20, 70):
        mass += 5
    return round(mass * GRAVITY, 1)


def capacity(load: float, pressure: float, at: float, exponent: float) -> float:
    """What a tyre rated for a load at a pressure carries at another: Q = Q_r (p/p_r)^n, not more than Q_r  [N].

    >>> round(capacity(6000.0, 250e3, 200e3, ROAD_EXPONENT))
    5019
    """
    return load * min(at / pressure, 1.0) ** exponent


def check_carries(load: float, pressure: float, wanted: float, at: float, exponent: float) -> None:
    """Raise `InputError` where a load is more than a rated tyre carries at a pressure."""
    if wanted > load * (1 + 1e-6):
        raise InputError(f"{wanted:.5g} N is more than the rated load of {load:.5g} N", field="load")
    most = capacity(load, pressure, at, exponent)
    if wanted > most * (1 + 1e-6):
        needed = pressure * (wanted / load) ** (1 / exponent)
        raise InputError(
            f"{at / 1e3:.4g} kPa carries {most:.5g} N, not {wanted:.5g} N: at least {needed / 1e3:.4g} kPa are "
            "needed (load goes "
            f"with pressure to the power {exponent:g} from {load:.5g} N at {pressure / 1e3:.4g} kPa)",
            field="pressure",
        )
