"""The drives that a plan compares: a few points spread over the stated limits."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cards.entries import entry_number
from tyrefem.diagnose.layout.planned_runs import READING_INTERVAL
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.changes import check_compatible, scaled
from tyrefem.inputs.plan_choice import Limits, limit_unit
from tyrefem.inputs.study import StudyData
from tyrefem.quantity import amount_parts, convert, parse

Array = NDArray[np.float64]
#: Limits without stated ones: factors on the study's drive (estimates).
DEFAULT_FACTORS = {"speed": (0.5, 1.5), "load": (0.75, 1.25), "deflection": (0.75, 1.25), "pressure": (0.8, 1.2)}
#: Largest number of limited quantities.
MOST_LIMITS = 12


@dataclass(frozen=True)
class CandidateDrive(Brief):
    """A drive that may be the next run: values of the ``[drive]`` table, and its cost.

    ``ratios``: quantity -> its value over that of the study's drive, where both are constant.
    """

    changes: dict[str, str]
    duration: float
    cost: float
    ratios: dict[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The drive in words: "speed 35 mph, load 4000 lbf"."""
        words = [f"{quantity_name(key)} {value}" for key, value in self.changes.items()]
        return ", ".join(words) or "the study's drive"


def quantity_name(key: str) -> str:
    """A key of the drive in words.

    >>> quantity_name("phases.rolling.road_temperature"), quantity_name("phases.1.speed")
    ('rolling road temperature', 'phase 1 speed')
    """
    words = key.removeprefix("phases.").replace(".", " ").replace("_", " ")
    return f"phase {words}" if words != key and not words[:1].isalpha() else words


def candidate_drives(study: StudyData) -> tuple[CandidateDrive, ...]:
    """Drives within the limits of the study's ``[plan]`` table, far apart from each other; the first is the middle.

    Raises
    ------
    InputError : a limited quantity is not in the drive; a drive within stated limits cannot run.
    """
    choice = study.card.plan
    limits = dict(choice.limits) or default_limits(study)
    _check_phases(study, limits)
    if len(limits) > MOST_LIMITS:
        message = f"{len(limits)} quantities are limited; at most {MOST_LIMITS} can vary in one plan"
        raise InputError(message, field="plan.limits", file=study.file)
    try:
        check_compatible(study.data, {key: low for key, (low, _) in limits.items()})
    except InputError as error:
        raise error.within(field="plan.limits", file=study.file) from None
    drives, refused = [], []
    for point in spread_points(len(limits), choice.drives):
        changes = {
            key.removeprefix("drive."): between(*pair, float(share), limit_unit(key))
            for (key, pair), share in zip(limits.items(), point, strict=True)
        }
        try:
            drives.append(_drive(study, changes))
        except InputError as error:
            if choice.limits:
                raise refused_drive(study, changes, error) from None
            refused.append((changes, error))
    if not drives:
        raise refused_drive(study, *refused[0])
    return tuple(drives)


def _check_phases(study: StudyData, limits: Limits) -> None:
    """Refuse limits of a phase that the drive does not have."""
    names = [str(phase.name) for phase in study.card.drive.phases] if "phases" in study.data["drive"] else []
    for key in limits:
        table, _, rest = key.removeprefix("drive.").partition(".")
        phase = rest.rpartition(".")[0]
        if table == "phases" and phase not in (*names, *map(str, range(len(names)))):
            allowed = nearest(phase, names) if names else ": it has no phases, so name the quantity alone"
            raise InputError(f"the drive has no phase '{phase}'{allowed}", field=f"plan.limits.{key}", file=study.file)


def refused_drive(study: StudyData, changes: Mapping[str, str], error: InputError) -> InputError:
    """The error of a drive that cannot run."""
    words = ", ".join(f"{quantity_name(key)} {value}" for key, value in changes.items())
    reason = f"{error.field}: {error.message}" if error.field else error.message
    message = f"the drive with {words} cannot run: {reason}; state narrower limits"
    return InputError(message, field="plan.limits", file=study.file)


def _drive(study: StudyData, changes: dict[str, str]) -> CandidateDrive:
    driven = study.with_drive(changes)
    end = driven.card.drive.end
    if end < READING_INTERVAL:
        least = f"it must last at least {READING_INTERVAL:g} s, the interval between two readings"
        raise InputError(f"the drive lasts {end:g} s; {least}", field="drive")
    choice = study.card.plan
    cost = choice.run_cost + choice.hour_cost * end / 3600.0
    return CandidateDrive(changes, end, cost, _ratios(study, driven, changes))


def _ratios(study: StudyData, driven: StudyData, changes: Mapping[str, str]) -> dict[str, float]:
    """Quantity -> factor on the study's drive, where the first phase that has the quantity gives both as numbers.

    A quantity of a phase is compared in this phase.
    """
    ratios: dict[str, float] = {}
    phases = list(zip(study.card.drive.phases, driven.card.drive.phases, strict=False))
    names = [{"name": str(phase.name)} for phase in study.card.drive.phases]
    for key in changes:
        of_phase, _, name = key.removeprefix("phases.").rpartition(".")
        for before, after in [phases[entry_number(names, of_phase, key)]] if of_phase else phases:
            old, new = getattr(before, name), getattr(after, name)
            old, new = (getattr(value, "start", value) for value in (old, new))
            if old and new and name in DEFAULT_FACTORS:
                ratios[key] = new / old
                break
    return ratios


def default_limits(study: StudyData) -> Limits:
    """Limits about the study's drive by `DEFAULT_FACTORS`, for its constant quantities that are not zero.

    Raises
    ------
    InputError : the drive has no such quantity.
    """
    drive = study.data["drive"]
    phases = [phase for phase in drive.get("phases", []) if isinstance(phase, Mapping)]
    limits: Limits = {}
    for quantity, factors in DEFAULT_FACTORS.items():
        places = [(quantity, drive.get(quantity))]
        places += [(f"phases.{phase.get('name', i)}.{quantity}", phase.get(quantity)) for i, phase in enumerate(phases)]
        for key, value in places:
            if _scalable(study, key, value):
                low, high = (str(scaled(value, factor, significant=4)) for factor in factors)
                limits[f"drive.{key}"] = (low, high)
                break
    if not limits:
        message = "the drive has no constant speed, load or pressure: state limits, e.g. \"drive.speed\" = ['5 mph', "
        raise InputError(message + "'20 mph']", field="plan.limits", file=study.file)
    return limits


def _scalable(study: StudyData, key: str, value: Any) -> bool:
    """Whether a quantity of the drive is a constant number, not zero, that can be changed by its name."""
    if not isinstance(value, str) or parse(value, limit_unit(key)) == 0.0:
        return False
    try:
        study.with_drive({key: value})
    except InputError:
        return False
    return True


def between(low: str, high: str, share: float, unit: str) -> str:
    """The quantity at a share of the way from ``low`` to ``high``, in the unit of the lower limit; a limit as written.

    >>> between("10 mph", "40mph", 0.5, "m/s"), between("1 m/s", "40 mph", 0.5, "m/s")
    ('25 mph', '9.441 m/s')
    >>> between("12345 N", "20 kN", 0.0, "N"), between("12345 N", "20 kN", 1.0, "N")
    ('12345 N', '20 kN')
    """
    if share in (0.0, 1.0):
        # Rounded, it might lie beyond the limit.
        return (high if share else low).strip()
    amounts = [amount_parts(text) or (text, "") for text in (low, high)]
    if unit != "1" and amounts[0][1] == amounts[1][1]:
        first, last = (float(amount[0]) for amount in amounts)
        return f"{first + share * (last - first):.4g} {amounts[0][1]}"
    values = [parse(text, unit) for text in (low, high)]
    value = values[0] + share * (values[1] - values[0])
    if unit == "1":
        return f"{value:.4g}"
    written = amounts[0][1] if unit != "degC" else unit
    return f"{convert(value, unit, written) if written != unit else value:.4g} {written}"


def spread_points(dimensions: int, count: int) -> Array:
    """(n, dimensions): up to ``count`` points of a grid in the unit cube, each as far from the others as possible.

    The first point is the middle, the next ones are corners.

    >>> spread_points(2, 3).tolist()
    [[0.5, 0.5], [0.0, 0.0], [0.0, 1.0]]
    """
    levels = {1: max(count, 3) | 1, 2: 5}.get(dimensions, 3 if dimensions <= 5 else 2)
    grid = np.array(list(itertools.product(np.linspace(0.0, 1.0, levels), repeat=dimensions)))
    chosen = [int(np.argmin(np.abs(grid - 0.5).sum(axis=1)))]
    distance = np.linalg.norm(grid - grid[chosen[0]], axis=1)
    while len(chosen) < min(count, len(grid)):
        chosen.append(int(np.argmax(np.round(distance, 9))))
        distance = np.minimum(distance, np.linalg.norm(grid - grid[chosen[-1]], axis=1))
    return np.asarray(grid[chosen])
