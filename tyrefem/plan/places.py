"""The places of further thermocouples that a plan compares."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from tyrefem.diagnose.next_experiment import SKIN
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

#: Number of stations along the meridian without stated places; the last is at this share of the meridian.
STATIONS, LAST = 7, 0.95
LEVELS = {
    "inside": "1 mm below the inner surface",
    "middle": "in the middle",
    "outside": "1 mm below the outer surface",
}


@dataclass(frozen=True)
class CandidatePlace:
    """A thermocouple that may be added: its name, and its place in words."""

    name: str
    words: str


def with_candidate_sensors(
    study: StudyData, installed: Collection[str]
) -> tuple[StudyData, tuple[CandidatePlace, ...]]:
    """The study with all sensors that a plan may add, and these sensors.

    Sensors of the study that are not ``installed`` are candidates too. No candidates if ``sensors_most`` is 0.

    Raises
    ------
    InputError : a stated sensor has the name of another one, or is not in the section.
    """
    choice = study.card.plan
    if not choice.sensors_most and not choice.sensors:
        return study, ()
    idle = [CandidatePlace(name, f"thermocouple {name}") for name in study.sensors if name not in installed]
    if not choice.sensors:
        further = _even_places(study)
    else:
        further = {}
        for name, place in choice.sensors.items():
            if name in study.sensors:
                message = "is a sensor of the study: give the further sensor another name"
                raise InputError(message, field=f"plan.sensors.{name}", file=study.file)
            through = {"depth": place.depth, "below_surface": place.below_surface}
            further[name] = (_sensor(place.s, **through), f"{name} (s = {place.s * 1e3:.0f} mm)")
    extended = study
    for name, (sensor, _) in further.items():
        try:
            extended = extended.replace({f"sensors.{name}": sensor})
        except InputError as error:
            raise InputError(error.message, field=f"plan.sensors.{name}", file=study.file) from None
    if not choice.sensors_most:
        return study, ()
    return extended, (
        *idle,
        *(CandidatePlace(name, f"thermocouple {words}") for name, (_, words) in further.items()),
    )


def _sensor(s: float, **through: float | None) -> dict[str, str]:
    """A sensor of a study: its station and depth, m."""
    return {key: f"{value:.6g} m" for key, value in {"s": s, **through}.items() if value is not None}


def _even_places(study: StudyData) -> dict[str, tuple[dict[str, str], str]]:
    """Name -> sensor, words: even stations from crown to bead, at three depths."""
    section = study.section
    places: dict[str, tuple[dict[str, str], str]] = {}
    for s in np.linspace(0.0, LAST * section.line.length, STATIONS):
        total = float(np.asarray(section.rubber_thickness(np.array([s])))[0])
        for (level, words), depth in zip(LEVELS.items(), (SKIN, total / 2, total - SKIN), strict=True):
            sensor = _sensor(float(s), depth=depth)
            places[f"s{s * 1e3:.0f}-{level}"] = (sensor, f"at s = {s * 1e3:.0f} mm, {words}")
    return {name: place for name, place in places.items() if name not in study.sensors}
