"""Settings of a real-time model: points of its tables, training drives, validation drives."""

from __future__ import annotations

from dataclasses import astuple, dataclass

from tyrefem.errors import InputError
from tyrefem.reduced.training import ReducedFineness

#: Few modes: the cost of a step grows with their square, that of its matrix with their cube.
FINENESS = ReducedFineness(modes_tolerance=2e-4, source_tolerance=2e-6, most_modes=60, most_sources=60, fields=40)


@dataclass(frozen=True)
class TablePoints:
    """Numbers of table points over the root of speed, the root of the deflection, and pressure."""

    speed: int = 25
    bend: int = 81
    pressure: int = 4


#: Fewer deflections and pressures, for strain laws that take seconds per cycle.
COSTLY = TablePoints(bend=7, pressure=3)
#: The fewest for cubics over the deflection: what a certificate of a box tries first with such laws.
FEWEST = TablePoints(bend=4, pressure=3)


@dataclass(frozen=True)
class ExportSettings:
    """Numbers of the method by which a real-time model is trained and certified.

    Parameters
    ----------
    points : of the tables; None: `COSTLY` if a strain cycle takes seconds, else the default points.
    training : random training drives. fresh : steady validation drives of a certificate, and as many random ones.
    rounds : certificates that are tried. fineness : resolution of the modes. seed : of the random drives.

    Raises
    ------
    InputError : a number of drives, rounds or points below 1.

    >>> ExportSettings(rounds=0)
    Traceback (most recent call last):
    tyrefem.errors.InputError: settings: training, fresh and rounds must be at least 1
    """

    points: TablePoints | None = None
    training: int = 6
    fresh: int = 4
    rounds: int = 4
    fineness: ReducedFineness = FINENESS
    seed: int = 11

    def __post_init__(self) -> None:
        if min(self.training, self.fresh, self.rounds) < 1:
            raise InputError("training, fresh and rounds must be at least 1", field="settings")
        if self.points is not None and min(astuple(self.points)) < 2:
            raise InputError("a table needs at least two points over each input", field="settings.points")
