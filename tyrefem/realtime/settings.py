"""How finely a real-time model is made: points of its tables, drives it learns from, drives it is examined by."""

from __future__ import annotations

from dataclasses import astuple, dataclass

from tyrefem.errors import InputError
from tyrefem.reduced.training import ReducedFineness

#: Few modes: a step costs their square, and its matrix their cube.
FINENESS = ReducedFineness(modes_tolerance=2e-4, source_tolerance=2e-6, most_modes=60, most_sources=60, fields=40)


@dataclass(frozen=True)
class TablePoints:
    """Points of the tables over the root of speed, the root of the deflection, and pressure."""

    speed: int = 25
    bend: int = 81
    pressure: int = 4


#: Fewer deflections and pressures where a strain cycle takes seconds.
COSTLY = TablePoints(bend=7, pressure=3)


@dataclass(frozen=True)
class ExportSettings:
    """Numbers of the method by which a real-time model is trained and certified.

    Parameters
    ----------
    points : of the tables; None: `COSTLY` where a strain cycle takes seconds, else the default ones.
    learn : random drives to learn from. fresh : drives with steady inputs, and as many random ones, of a certificate.
    rounds : certificates that are tried. fineness : of the modes. seed : of the random drives.

    Raises
    ------
    InputError : a number of drives, rounds or points below 1.

    >>> ExportSettings(rounds=0)
    Traceback (most recent call last):
    tyrefem.errors.InputError: settings: learn, fresh and rounds must be at least 1
    """

    points: TablePoints | None = None
    learn: int = 6
    fresh: int = 4
    rounds: int = 4
    fineness: ReducedFineness = FINENESS
    seed: int = 11

    def __post_init__(self) -> None:
        if min(self.learn, self.fresh, self.rounds) < 1:
            raise InputError("learn, fresh and rounds must be at least 1", field="settings")
        if self.points is not None and min(astuple(self.points)) < 2:
            raise InputError("a table needs at least two points over each input", field="settings.points")
