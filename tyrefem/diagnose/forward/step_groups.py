"""Unknowns that take their steps at once: each changes the reading of another sensor and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TypeVar

from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

Changed = TypeVar("Changed")


def step_groups(unknowns: Sequence[Unknown], study: StudyData) -> list[tuple[int, ...]]:
    """Numbers of the unknowns in groups: place, lag or offset of different sensors, or one other unknown.

    Where a channel records another sensor, each unknown is alone.

    >>> from tyrefem import study
    >>> step_groups([Unknown("materials.tread.k.value", 0.1)], study("hidden-effect"))
    [(0,)]
    """
    apart = any(effect.overrides("channel") for effect in study.effects)
    groups: list[list[int]] = []
    # What is changed -> sensor -> number of its unknowns so far: a sensor may have one as a nuisance and as an effect.
    known: dict[tuple[str | None, str], dict[str, int]] = {}
    places: dict[tuple[str | None, str, int], int] = {}
    for number, unknown in enumerate(unknowns):
        sensor = None if apart else unknown.only_sensor
        if sensor is None or unknown.parameter is None:
            groups.append([number])
            continue
        changed = unknown.effect, unknown.parameter.name
        count = known.setdefault(changed, {}).get(sensor, 0)
        known[changed][sensor] = count + 1
        place = places.setdefault((*changed, count), len(groups))
        if place == len(groups):
            groups.append([])
        groups[place].append(number)
    return [tuple(group) for group in groups]


def stepped(
    unknowns: Sequence[Unknown], group: Sequence[int], at: Mapping[Unknown, float], sign: float = 1.0
) -> dict[Unknown, float]:
    """Values of the unknowns, ``at`` with a step of every member of a group; ``sign`` -1: a step back."""
    steps = {unknowns[number]: sign * unknowns[number].step for number in group}
    return {**at, **{unknown: at.get(unknown, 0.0) + step for unknown, step in steps.items()}}


def of_further_effect(unknown: Unknown) -> bool:
    """True of an unknown of an effect that the study does not have: without it a tyre can be built."""
    return unknown.effect is not None and unknown.origin is None


def possible_step(
    unknowns: Sequence[Unknown],
    group: Sequence[int],
    at: Mapping[Unknown, float],
    attempt: Callable[[Mapping[Unknown, float], float], Changed],
) -> tuple[Changed, float] | None:
    """What ``attempt`` makes of a step of a group, and the sign of the step: numbers at their limit step back.

    None for a further effect with which no tyre can be built.

    Parameters
    ----------
    attempt : called with the values of the unknowns and the sign; see `stepped`.

    Raises
    ------
    InputError : no tyre can be built with either step.
    """
    try:
        return attempt(stepped(unknowns, group, at), 1.0), 1.0
    except InputError:
        if of_further_effect(unknowns[group[0]]):
            return None
        with suppress(InputError):
            return attempt(stepped(unknowns, group, at, -1.0), -1.0), -1.0
        raise
