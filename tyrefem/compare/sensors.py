"""The sensors of a comparison: uncertainties of their readings, and the check that every column is one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tyrefem.compare.interface import SensorLike, StudyLike
from tyrefem.errors import InputError, nearest, quoted
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_card import Sensor
from tyrefem.measured import MeasuredRun
from tyrefem.measured.heading import parts

#: Temperatures that are computed with the sensors and measured like them, but at no place in the rubber.
OUTSIDE_THE_RUBBER = ("contained-air", "rim")


@dataclass(frozen=True)
class SensorWithoutCard:
    """Standard uncertainties of a reading outside the rubber: the defaults of a sensor's card, and no position."""

    noise: float = Sensor.model_fields["noise"].default
    accuracy: float = Sensor.model_fields["accuracy"].default
    position_sd: float = 0.0


def sensor_of(study: StudyLike, name: str) -> SensorLike:
    """Standard uncertainties of a sensor; those of contained air and rim, if the study gives them no card."""
    return study.sensors.get(name, SensorWithoutCard())


def check_sensors(runs: Sequence[MeasuredRun], study: StudyLike) -> None:
    """Raises InputError for all columns that are no sensors, and for a sensor's column without a temperature unit."""
    allowed = {*study.sensors, *OUTSIDE_THE_RUBBER}
    if isinstance(study, StudyData) and "rim" not in study.sensors and study.card.boundaries.rim.law == "fixed":
        allowed.remove("rim")
        for run in runs:
            if "rim" in run.sensors:
                raise InputError(
                    "column 'rim': the rim of the study has a given temperature, so none is computed; ignore the "
                    'column, or set boundaries.rim to law = "lumped"',
                    file=run.file,
                )
    unknown: dict[str, list[MeasuredRun]] = {}
    for run in runs:
        for sensor in run.sensors:
            if sensor not in allowed:
                unknown.setdefault(sensor, []).append(run)
        for heading in run.channels:
            if parts(heading)[0] in allowed:
                raise InputError(f"column '{heading}': a sensor's unit is degC, degF or K", file=run.file)
    if not unknown:
        return
    files = {run.file for runs_with in unknown.values() for run in runs_with}
    file = next(iter(files)) if len(files) == 1 else None
    names = sorted(path.name for path in files if path is not None)
    where = f" (in {', '.join(names)})" if len(names) > 1 else ""
    if len(unknown) == 1:
        (column,) = unknown
        wrong = f"column '{column}'{where} is no sensor of study '{study.name}'{nearest(column, allowed)}"
        raise InputError(f"{wrong}; rename it, ignore it, or add it to [sensors]", file=file)
    raise InputError(
        f"columns {quoted(unknown, allowed)}{where} are no sensors of study '{study.name}'; allowed: "
        f"{', '.join(sorted(allowed))}; rename them, ignore them, or add them to [sensors]",
        file=file,
    )
