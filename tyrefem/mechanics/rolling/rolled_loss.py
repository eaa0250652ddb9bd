"""Hysteresis of a rolling tyre: the loss of its strain cycle, as a drive takes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.rolling.rolled_footprint import RolledFootprint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tyrefem.mechanics.rolling.roll import RolledStudy


def strain_losses(
    rolled: RolledStudy, temperature: float | NDArray | None = None, footprint: RolledFootprint | None = None
) -> tuple[RevolutionLoss, ...]:
    """Loss of the strain cycle by the cards: of a full section; of a half section, as if each side's were both's.

    ``temperature``: degC, a number or (n_elements, n_points); by default the drive's initial one.
    ``footprint``: that of the rolling tyre, if it is there already.
    """
    pressed = rolled.wheel.pressed
    footprint = RolledFootprint.of_rolled(rolled, 1.0) if footprint is None else footprint
    cards = {region: pressed.study.materials[region] for region in pressed.tyre.body.parts}
    warm = pressed.study.card.drive.initial if temperature is None else temperature
    speed = rolled.state.motion.speed
    return tuple(RevolutionLoss.of_cards(cycle, cards, speed, warm) for cycle in footprint.sides)


def hysteresis(rolled: RolledStudy, temperature: float | NDArray | None = None) -> float:
    """Power, W, that the strain cycle turns into heat: sum over the harmonics n of n pi tan delta e_n : C' : e_n times
    the revolutions per second. The heat of a drive (`boundaries.sliding = "rolling"`) is the same integral.

    With ``[mechanics] rolling = false`` the contact does not feel it.
    """
    losses = strain_losses(rolled, temperature)
    return float(sum(loss.energy * loss.frequency for loss in losses)) / len(losses)
