"""Checks of slip, torque, slip angle and camber of a drive against the rest of its study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tyrefem.errors import InputError
from tyrefem.inputs.drive import LOOKS, Phase
from tyrefem.inputs.motion import ROUNDING, motion_in, slip_ratio_in
from tyrefem.inputs.study_card import StudyCard

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.materials.card import MaterialCard

#: Keys of a phase that only rolling with friction takes.
ONLY_ROLLING = ("camber", "torque")
#: Keys of a phase that load the two sides of a tyre differently.
TWO_SIDED = ("slip_angle", "camber")


class DrivenStudy(Protocol):
    """What a study is checked by."""

    @property
    def card(self) -> StudyCard:
        """The study's data, validated."""

    @property
    def section(self) -> Section:
        """The section."""

    @property
    def materials(self) -> Mapping[str, MaterialCard]:
        """Region -> its card."""

    @property
    def file(self) -> Path | None:
        """The study's file."""


def check_wheel_states(study: DrivenStudy) -> None:
    """Refuse slip, torque, slip angle or camber that the study's law of sliding cannot take.

    Raises
    ------
    InputError : torque or camber without the law ``rolling``; that law without finite elements or without friction
        of a card; a slip angle or camber on a half section; a locked wheel. It names phase and key.
    """
    try:
        if not study.card.boundaries.sliding.rolls:
            _refuse_torque_and_camber(study)
            return
        _check_law(study)
        for phase in study.card.drive.phases:
            _check_phase(study, phase)
    except InputError as error:
        raise error.within(file=study.file) from None


def check_rim_temperature(study: DrivenStudy) -> None:
    """Refuse a rim temperature that changes in the drive of a lumped rim, whose own balance follows its start.

    Raises
    ------
    InputError : it names phase and key.
    """
    if study.card.boundaries.rim.law != "lumped":
        return
    given = [(phase.name, phase.rim_temperature) for phase in study.card.drive.phases]
    known = [(name, ramp) for name, ramp in given if ramp is not None]
    for name, ramp in known:
        if {ramp.start, ramp.end} != {known[0][1].start}:
            raise InputError(
                "changes in the drive, but a lumped rim only starts from it and then follows its heat balance",
                field=f"drive.phases.{name}.rim_temperature",
                file=study.file,
            )


def _refuse_torque_and_camber(study: DrivenStudy) -> None:
    for phase in study.card.drive.phases:
        for key in ONLY_ROLLING:
            if getattr(phase, key) is not None:
                law = study.card.boundaries.sliding.law
                message = f"needs boundaries.sliding = 'rolling', which computes the rolling tyre; the law is '{law}'"
                raise InputError(message, field=f"drive.phases.{phase.name}.{key}")


def _check_law(study: DrivenStudy) -> None:
    mechanics = study.card.mechanics
    field = "boundaries.sliding"
    if mechanics.strain != "fem":
        message = f"the law 'rolling' needs mechanics.strain = 'fem', not '{mechanics.strain}'"
        raise InputError(message, field=field)
    if all(card.friction is None for card in study.materials.values()):
        message = "the law 'rolling' needs the table [friction] on the card of the rubber that meets the road"
        raise InputError(message, field="materials.tread.friction")


def _check_phase(study: DrivenStudy, phase: Phase) -> None:
    place = f"drive.phases.{phase.name}"
    if study.section.half:
        for key in TWO_SIDED:
            ramp = getattr(phase, key)
            if ramp is not None and (ramp.start or ramp.end):
                message = "needs both sides of the tyre: [mesh] section = 'full'"
                raise InputError(message, field=f"{place}.{key}")
    if phase.slip_ratio is None and phase.slip_speed is None:
        return
    for fraction in LOOKS:
        motion = motion_in(phase, fraction)
        # A stated ratio also holds at rest, where nothing turns.
        locked = not motion.turns if motion.speed > 0 else slip_ratio_in(phase, fraction) >= 1 - ROUNDING
        if locked:
            key = "slip_speed" if phase.slip_ratio is None else "slip_ratio"
            message = "a locked wheel does not roll: less than 1, or boundaries.sliding = 'constant' or 'brush'"
            raise InputError(message, field=f"{place}.{key}")
