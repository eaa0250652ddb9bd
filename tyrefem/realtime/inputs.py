"""Drives within a box of inputs, steady or of steps and ramps: as a study and as inputs of time steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.quantity import parse
from tyrefem.realtime.suitability import check_motion
from tyrefem.realtime.tyre import INPUTS, Inputs

Array = NDArray[np.float64]
NAMES = tuple(INPUTS)
#: Default ranges: factors on the study's smallest and largest value, and differences in K.
FACTORS = {"speed": (0.0, 1.5), "load": (0.5, 1.25), "pressure": (0.8, 1.2)}
AROUND = {"ambient": (-20.0, 20.0), "road_temperature": (-20.0, 40.0)}
#: Keys of a study's drive that are the same in every drive of the box.
KEPT = ("drum_diameter", "rim_temperature")
#: Parts of a random drive at most, and the shortest part, s.
PARTS, SHORTEST = 6, 20.0
#: A ramp of load or pressure becomes so many phases of the study: within each the strain cycles are interpolated
#: between nine points, which keeps their error small.
SPLIT = 3
#: Begin of the names of the phases of a drive within the box.
PART = "part "


@dataclass(frozen=True)
class Box:
    """Ranges of the inputs, SI: name -> (low, high) in the order of `NAMES`; with equal ends the input is fixed."""

    ranges: Mapping[str, tuple[float, float]]

    @property
    def low(self) -> Array:
        """(5,) lower ends."""
        return np.array([self.ranges[name][0] for name in NAMES])

    @property
    def high(self) -> Array:
        """(5,) upper ends."""
        return np.array([self.ranges[name][1] for name in NAMES])

    def at(self, places: Array) -> Array:
        """Values at places (..., 5) of the unit cube."""
        return self.low + (self.high - self.low) * np.asarray(places)


def box_of(study: StudyData, given: Mapping[str, tuple[Any, Any]] | None = None) -> Box:
    """The box of inputs around a study's drive; given ranges replace those of `FACTORS` and `AROUND`.

    Parameters
    ----------
    given : input -> (from, to), as in a study file or in SI.

    Raises
    ------
    InputError : an unknown input, a range from a higher to a lower value, a load or speed that is not positive.

    >>> import tyrefem
    >>> box_of(tyrefem.study("nasa-22x5.5-8pr"), {"load": ("10 kN", "14 kN")}).ranges["load"]
    (10000.0, 14000.0)
    """
    from tyrefem.errors import nearest

    ranges: dict[str, tuple[float, float]] = {}
    for name in given or {}:
        if name not in NAMES:
            raise InputError(f"unknown input '{name}'{nearest(name, NAMES)}")
    for name in NAMES:
        if given and name in given:
            try:
                low, high = (_end(name, limit) for limit in _pair(name, given[name]))
            except InputError as error:
                raise error if error.field else error.within(field=name) from None
        else:
            low, high = _around(study, name)
        written = _as_given(name, (given or {}).get(name, (low, high)))
        if not (np.isfinite(low) and np.isfinite(high) and low <= high):
            raise InputError(f"must be from a lower to a higher value, not {' to '.join(written)}", field=name)
        if name in FACTORS and (low < 0 or (high <= 0 and name != "pressure")):
            raise InputError(f"must be positive, not {' to '.join(written)}", field=name)
        ranges[name] = low, high
    box = Box(ranges)
    for name in given or {}:
        _check_drives(study, box, name, _as_given(name, (given or {})[name]))
    return box


def _as_given(name: str, ends: Any) -> tuple[str, str]:
    """Both ends of a range as a person gave them, numbers with the unit of the input."""
    low, high = (f"{end:g} {INPUTS[name]}" if isinstance(end, Real) else str(end) for end in _pair(name, ends))
    return low, high


def _check_drives(study: StudyData, box: Box, name: str, written: tuple[str, str]) -> None:
    """Raise `InputError` for an end of a range that the study's drive refuses."""
    for place, text in zip((0.0, 1.0), written, strict=True):
        places = np.full(len(NAMES), 0.5)
        places[NAMES.index(name)] = place
        try:
            steady(box, places, 1.0).study(study)
        except InputError as error:
            if (error.field or "").rpartition(".")[2] != name:
                raise
            raise InputError(f"{text}: {error.message}", field=name) from None


def _pair(name: str, given: Any) -> tuple[Any, Any]:
    if isinstance(given, str | bytes) or not isinstance(given, Sequence | np.ndarray) or len(given) not in (1, 2):
        raise InputError(f"a range is (from, to), not {given!r:.40}", field=name)
    return given[0], given[-1]


def _end(name: str, limit: Any) -> float:
    """One end of a range, SI; a number has the unit of the input."""
    if isinstance(limit, Real) and not isinstance(limit, bool):
        return float(limit)
    return parse(limit, INPUTS[name])


def _around(study: StudyData, name: str) -> tuple[float, float]:
    drive = study.card.drive
    if name == "load" and any(phase.load is None for phase in drive.phases):
        raise InputError("the study's drive gives a deflection: give a range of loads", field="load")
    ramps = [getattr(phase, name) or phase.ambient for phase in drive.phases]
    ends = [value for ramp in ramps for value in (ramp.start, ramp.end)]
    if name == "road_temperature" and study.card.boundaries.road.temperature is not None:
        ends.append(study.card.boundaries.road.temperature)
    if name in AROUND:
        below, above = AROUND[name]
        return min(ends) + below, max(ends) + above
    least, most = FACTORS[name]
    return min(ends) * least, max(ends) * most


@dataclass(frozen=True, eq=False)
class BoxDrive:
    """A drive within the box: inputs that are linear in time within each part, with jumps between parts.

    Parameters
    ----------
    ends : (n + 1,) s, times at which parts begin and end. first, last : (n, 5) inputs at the start and the end of each
        part. initial : initial temperature, degC.
    """

    ends: Array
    first: Array
    last: Array
    initial: float

    @property
    def steady(self) -> bool:
        """Are the inputs constant?"""
        return len(self.first) == 1 and bool((self.first == self.last).all())

    def inputs(self, begin: float, end: float) -> tuple[Inputs, Inputs]:
        """Inputs at the start and the end of a time step, as limits from within the step."""
        part = min(int(np.searchsorted(self.ends, (begin + end) / 2, side="right")) - 1, len(self.first) - 1)
        length, change = self.ends[part + 1] - self.ends[part], self.last[part] - self.first[part]
        both = (self.first[part] + change * float(np.clip((t - self.ends[part]) / length, 0, 1)) for t in (begin, end))
        first, last = (Inputs(*values.tolist()) for values in both)
        return first, last

    def jumps(self, t: float) -> bool:
        """Does a part begin at this time?"""
        return bool(np.abs(self.ends[:-1] - t).min() < 1e-6)

    def study(self, study: StudyData, every: float = 1.0) -> StudyData:
        """The study with this drive; ``every``: interval of the readings, s."""
        phases = []
        for k, (a, b) in enumerate(zip(self.first, self.last, strict=True)):
            length = self.ends[k + 1] - self.ends[k]
            count = SPLIT if (a[1:3] != b[1:3]).any() else 1
            for i in range(count):
                first, last = a + (b - a) * (i / count), a + (b - a) * ((i + 1) / count)
                name = f"{PART}{k + 1}" + (f".{i + 1}" if count > 1 else "")
                phases.append({"name": name, "duration": f"{length / count:.12g} s", **_written(first, last)})
        return study.replace(
            {
                "drive": {**_kept(study), "initial": f"{self.initial:.12g} degC", "phases": phases},
                "output.every": f"{every:.12g} s",
            }
        )


def _written(first: Sequence[float], last: Sequence[float]) -> dict[str, Any]:
    phase: dict[str, Any] = {}
    for name, a, b in zip(NAMES, first, last, strict=True):
        start, end = (f"{value:.12g} {INPUTS[name]}" for value in (a, b))
        phase[name] = start if start == end else {"from": start, "to": end}
    return phase


def _kept(study: StudyData) -> dict[str, Any]:
    drive = study.data["drive"]
    phases = drive.get("phases", [{}])
    check_motion(study)
    kept = {key: given[key] for given in (drive, *phases) for key in KEPT if key in given}
    for key in KEPT:
        values = [getattr(phase, key) for phase in study.card.drive.phases]
        if any(value != values[0] for value in values):
            words = f"'{key}' must be the same in every phase, also in those that do not give it"
            raise InputError(words, field="drive.phases")
    if isinstance(kept.get("rim_temperature"), Mapping):
        raise InputError("must be constant: it is not an input of a real-time model", field="drive.rim_temperature")
    return kept


def steady(box: Box, place: Array, duration: float) -> BoxDrive:
    """A drive with the constant inputs at a point of the unit cube; it starts at the ambient temperature."""
    values = box.at(place)[None]
    return BoxDrive(np.array([0.0, duration]), values, values, float(values[0, NAMES.index("ambient")]))


def random_drive(box: Box, duration: float, seed: int) -> BoxDrive:
    """A drive with parts of random length; in each about half of the inputs jump or ramp to new values.

    A quarter of the new values are ends of their range, where errors are largest.
    """
    rng = np.random.default_rng(seed)
    count = max(min(PARTS, int(duration / SHORTEST)), 1)
    spare = duration - count * SHORTEST
    cuts = np.sort(rng.random(count - 1)) * spare if spare > 0 else np.zeros(count - 1)
    ends = np.concatenate([[0.0], np.round(cuts) + SHORTEST * np.arange(1, count), [duration]])

    def fresh() -> Array:
        places = rng.random(5)
        extreme = rng.random(5) < 0.25
        return box.at(np.where(extreme, np.round(places), places))

    now, first, last = fresh(), [], []
    for number in range(count):
        target = np.where(rng.random(5) < 0.6, fresh(), now)
        ramp = number > 0 and rng.random() < 0.5
        first.append(now if ramp else target)
        last.append(target)
        now = target
    ambient = NAMES.index("ambient")
    return BoxDrive(ends, np.array(first), np.array(last), float(first[0][ambient]))
