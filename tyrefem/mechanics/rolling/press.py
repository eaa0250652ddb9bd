"""`press` with `mechanics.rolling`: the tyre turns at the drive's speed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.footprint import press as presses
from tyrefem.mechanics.footprint.press_order import press_order
from tyrefem.mechanics.rolling.turning import turn


def press(study: StudyData, *, speed: float | None = None, **options: Any) -> presses.Pressed:
    """As `footprint.press.press`; with ``[mechanics] rolling = true`` the tyre turns at the speed of the first phase.

    It then has centrifugal growth, inertia and, in linear motion, lag by loss (`turning.turn`). A drive at rest is
    pressed without.

    Parameters
    ----------
    speed : m/s, in place of the drive's; without ``mechanics.rolling`` it counts for the loss alone.
    options : as of `footprint.press.press`.

    Raises
    ------
    InputError : as `footprint.press.press`; a speed that is negative, or beyond the tread's critical speed.
    """
    if speed is not None and not speed >= 0:
        raise InputError(f"must be at least 0 m/s, not {speed:g} m/s", field="speed")
    if not study.card.mechanics.rolling:
        return replace(presses.press(study, **options), given_speed=speed)

    given, speed = speed, presses.speed_of(study) if speed is None else speed
    if not speed:
        return replace(presses.press(study, **options), given_speed=given)
    order = press_order(study, **options)
    turning = turn(order, speed)
    parts = (turning.tyre, turning.pressing, turning.footprint, order.tolerance, turning.path)
    return presses.Pressed(order.study, order.mesh, *parts, order.moduli, turning.path_harmonics, turning, given)
