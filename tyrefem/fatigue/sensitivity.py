"""How speed, load, pressure, ambient temperature and slip shift the shortest life."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError, OutputError, ResultWarning
from tyrefem.fatigue.life import LifeData, life
from tyrefem.inputs.changes import is_overridden, scaled
from tyrefem.inputs.drive import SLIPS
from tyrefem.quantity import parse

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

#: Name -> what changes, and its keys of the drive.
SHIFTS: dict[str, tuple[str, tuple[str, ...]]] = {
    "speed": ("speed + 10 %", ("speed",)),
    "load": ("load + 10 %", ("load", "deflection")),
    "pressure": ("pressure - 10 %", ("pressure",)),
    "ambient": ("ambient + 10 K", ("ambient",)),
    "slip": ("slip, torque, slip angle, camber + 10 %", SLIPS),
}
#: Factors of numbers; the ambient's step, K.
FACTORS = {"speed": 1.1, "load": 1.1, "pressure": 0.9, "slip": 1.1}
WARMER = 10.0
#: Where a drive does not give the ambient temperature.
AMBIENT = "25 degC"


@dataclass(frozen=True)
class LifeShift:
    """The shortest life after a change of the drive: km, its share of the life before, and region of the place."""

    change: str
    km: float
    ratio: float
    region: str
    temperature: float


def shifts_of(study: StudyData) -> tuple[str, ...]:
    """The changes that mean something in a study: slip only if its tyre rolls with friction, and slips.

    >>> from tyrefem import study
    >>> shifts_of(study("nasa-22x5.5-8pr"))
    ('speed', 'load', 'pressure', 'ambient')
    """
    slips = study.card.boundaries.sliding.rolls and any(phase.slides for phase in study.card.drive.phases)
    return tuple(name for name in SHIFTS if name != "slip" or slips)


def shifts(
    before: LifeData, which: tuple[str, ...] | None = None, progress: Callable[[float], None] | None = None
) -> tuple[LifeShift, ...]:
    """The shortest life of the study under each change alone, all else as written; by default those of `shifts_of`.

    Without a run (a life at a given temperature) the ambient's step is added to that temperature. Speed then changes
    nothing; it is listed all the same. A change that the study cannot take, such as more load than the tyre carries, is
    left out with a `ResultWarning`.
    """
    made = []
    for name in shifts_of(before.study) if which is None else which:
        words = _words(before.study, name)
        try:
            after = _after(before, name, progress)
        except OutputError:
            raise
        except InputError as error:
            warnings.warn(f"{words} is left out: {error.message}", ResultWarning, stacklevel=2)
            continue
        element = after.first
        point = int(after.typical[element])
        made.append(
            LifeShift(
                words, after.shortest, after.shortest / before.shortest,
                after.rings.region_of(element), float(after.temperatures[element, point]),
            )
        )  # fmt: skip
    return tuple(made)


def _words(study: StudyData, name: str) -> str:
    """What a change changes: a drive without loads has deflections."""
    words = SHIFTS[name][0]
    by_deflection = all(phase.load is None for phase in study.card.drive.phases)
    return words.replace("load", "deflection") if by_deflection else words


def _after(before: LifeData, name: str, progress: Callable[[float], None] | None) -> LifeData:
    study = before.study.replace(changed(before.study, name))
    temperature = before.temperature
    if temperature is not None and name == "ambient":
        temperature += WARMER
    return life(study, temperature=temperature, plateau=before.plateau, progress=progress)


def changed(study: StudyData, name: str) -> dict[str, Any]:
    """Dotted name -> value of a change, in the drive and in every phase that gives the number itself.

    >>> from tyrefem import study
    >>> changed(study("nasa-22x5.5-8pr"), "speed")
    {'drive.speed': '22 mph'}
    """
    drive: Mapping[str, Any] = study.data["drive"]
    keys = SHIFTS[name][1]
    given = {**({"ambient": AMBIENT} if name == "ambient" else {}), **drive}
    changes: dict[str, Any] = {
        f"drive.{key}": _moved(given[key], name)
        for key in keys
        if key in given and not is_overridden(study.data, f"drive.{key}")
    }
    phases = [dict(phase) for phase in drive.get("phases", ())]
    if any(key in phase for phase in phases for key in keys):
        # As a whole: by its number, a phase might be taken for one whose name is that number.
        changes["drive.phases"] = [
            phase | {key: _moved(phase[key], name) for key in keys if key in phase} for phase in phases
        ]
    return changes


def _moved(value: Any, name: str) -> Any:
    if isinstance(value, Mapping):
        return {key: _moved(end, name) for key, end in value.items()}
    if name == "ambient":
        return f"{parse(value, 'degC') + WARMER:.9g} degC"
    return scaled(value, FACTORS[name], 9)
