"""Roberts' tables 2 (rubber on wood) and 3 (rubber on ice) with the results of the equations.

The numbers are in ``studies/roberts-sliding``; its README lists those that are not printed in the paper.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tyrefem import library
from tyrefem.boundaries.friction import ICE, TEAK
from tyrefem.boundaries.friction_rise import distance_of_fall_off, exit_rise, exit_rise_of_stress, fall_off
from tyrefem.errors import InputError
from tyrefem.measured.cases import Case, read_cases
from tyrefem.quantity import parse

STUDY = "roberts-sliding"
#: Largest deviation of a printed prediction that agrees with its inputs: five do (1.9 % at most), two not (23, 90 %).
PRINTED_TOLERANCE = 0.025
#: Corrected rises of table 3 are printed in whole kelvins.
ICE_ROUNDING = 0.5


@dataclass(frozen=True)
class WoodRow:
    """One row of table 2. SI; rises at `behind` the exit edge; `printed` is the paper's prediction."""

    name: str
    length: float
    breadth: float
    load: float
    speed: float
    friction: float
    behind: float
    observed: float
    uncertainty: float
    printed: float

    @property
    def exit_rise(self) -> float:
        """Equation 3, K."""
        return exit_rise(self.friction * self.load, self.speed, self.length, self.breadth, TEAK)

    @property
    def predicted(self) -> float:
        """Equations 3 and 4, K."""
        return self.exit_rise * fall_off(self.behind, self.length)

    @property
    def deviation(self) -> float:
        """Predicted minus observed, K."""
        return self.predicted - self.observed

    @property
    def follows(self) -> bool:
        """True if the printed prediction agrees with the printed inputs."""
        return abs(self.predicted / self.printed - 1.0) <= PRINTED_TOLERANCE

    def summary(self) -> dict[str, str | float | bool]:
        """Measured and predicted rise, for a table or JSON; `deviation` is relative to the observed rise."""
        return {
            "name": self.name,
            "observed_K": self.observed,
            "uncertainty_K": self.uncertainty,
            "predicted_K": self.predicted,
            "deviation_K": self.deviation,
            "deviation": self.deviation / self.observed,
            "printed_K": self.printed,
            "printed_follows": self.follows,
        }


@dataclass(frozen=True)
class IceRow:
    """One row of table 3. SI; `measured` rise behind the pad, `corrected` by the paper to the exit edge; no load."""

    name: str
    length: float
    speed: float
    measured: float
    corrected: float
    friction: float
    to_melting: float
    melting: str

    def predicted(self, distance: float) -> float:
        """Rise at the exit edge from the measured one by equation 4, K."""
        return self.measured / fall_off(distance, self.length)

    def follows(self, distance: float) -> bool:
        """True if the prediction rounds to the printed, corrected rise."""
        return abs(self.predicted(distance) - self.corrected) <= ICE_ROUNDING

    @property
    def needed_pressure(self) -> float:
        """Contact pressure with which equation 12 gives the corrected rise, Pa."""
        return self.corrected / exit_rise_of_stress(self.friction, self.speed, self.length, ICE)

    def rise_at(self, pressure: float) -> float:
        """Equation 12 at a contact pressure in Pa, K."""
        return exit_rise_of_stress(self.friction * pressure, self.speed, self.length, ICE)

    def summary(self, distance: float, pressure: float) -> dict[str, str | float | bool]:
        """Measured rise, equation 4 at a distance (m), and equation 12 at a pressure (Pa)."""
        return {
            "name": self.name,
            "measured_K": self.measured,
            "corrected_K": self.corrected,
            "predicted_K": self.predicted(distance),
            "deviation_K": self.predicted(distance) - self.corrected,
            "printed_follows": self.follows(distance),
            "same_load_exit_rise_K": self.rise_at(pressure),
            "needed_pressure_Pa": self.needed_pressure,
            "above_melting": self.corrected > self.to_melting,
        }


def ice_distance(rows: tuple[IceRow, ...]) -> float:
    """The distance behind the pad that agrees with all corrections of table 3, m.

    The paper does not print it. The corrected rise is rounded, so each row gives bounds of equation 4's ratio. The
    result is the middle of the range that all rows allow.

    Raises InputError if no distance fits all rows.

    >>> round(1e3 * ice_distance(ice_rows()))
    207
    """
    low = max(row.measured / (row.corrected + ICE_ROUNDING) for row in rows)
    high = min(row.measured / (row.corrected - ICE_ROUNDING) for row in rows)
    if low > high:
        raise InputError("no one distance behind the pad agrees with the corrected rises of every row")
    return distance_of_fall_off((low + high) / 2.0, rows[0].length)


def wood_rows(path: Path | None = None) -> tuple[WoodRow, ...]:
    """The rows of table 2; ``path``: another table with the same columns.

    Raises InputError for an unreadable table, a missing column or a cell that is not a quantity.

    >>> [row.follows for row in wood_rows()].count(True)
    5
    """
    units = {"length": "m", "breadth": "m", "load": "N", "speed": "m/s", "friction": "1", "behind": "m"}
    kelvins = dict.fromkeys(("observed", "uncertainty", "printed"), "delta_degC")
    file = path or _shipped("table-2-rubber-on-wood.csv")
    return tuple(WoodRow(case.name, **_numbers(case, {**units, **kelvins}, file)) for case in read_cases(file))


def ice_rows(path: Path | None = None) -> tuple[IceRow, ...]:
    """The rows of table 3; parameters and errors as in `wood_rows`.

    >>> [row.corrected for row in ice_rows()]
    [7.0, 15.0, 21.0]
    """
    units = {"length": "m", "speed": "m/s", "friction": "1"}
    kelvins = dict.fromkeys(("measured", "corrected", "to_melting"), "delta_degC")
    file = path or _shipped("table-3-rubber-on-ice.csv")
    return tuple(
        IceRow(case.name, **_numbers(case, {**units, **kelvins}, file), melting=str(case.changes.get("melting", "")))
        for case in read_cases(file)
    )


def _numbers(case: Case, units: dict[str, str], file: Path) -> dict[str, float]:
    numbers = {}
    for name, unit in units.items():
        if name not in case.changes:
            raise InputError(f"line {case.line}: has no '{name}'", file=file)
        try:
            numbers[name] = parse(case.changes[name], unit)
        except InputError as error:
            raise InputError(f"line {case.line}: {error.message}", field=name, file=file) from None
        if not numbers[name] > 0:
            raise InputError(f"line {case.line}: must be more than 0", field=name, file=file)
    return numbers


def _shipped(name: str) -> Path:
    places = [root / library.FOLDERS["study"] / STUDY / name for root in library.roots()]
    file = next((place for place in places if place.is_file()), None)
    if file is None:
        raise InputError(f"no file '{STUDY}/{name}' in the library's studies")
    return file
