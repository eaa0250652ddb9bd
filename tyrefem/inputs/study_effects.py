"""Check of a study's effects."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tyrefem.effects import catalogue
from tyrefem.effects.tyre import StudyOfTyre
from tyrefem.errors import InputError, quoted
from tyrefem.inputs.study_card import StudyCard

if TYPE_CHECKING:
    from tyrefem.effects import Effect


class CheckedStudy(StudyOfTyre, Protocol):
    """Data of a study for its effects, with the file for error messages."""

    @property
    def card(self) -> StudyCard:
        """The study's data, validated."""

    @property
    def file(self) -> Path | None:
        """The study's file."""


def check_effects(study: CheckedStudy) -> None:
    """Refuse an effect that is not possible in the study, and unknown names of effects.

    Raises
    ------
    InputError : names the effect and what is wrong with it.
    """
    effects = study.card.effects
    for number, effect in enumerate(effects):
        problem = effect.problem(study)
        if problem is None and any(_same(effect, other) for other in effects[:number]):
            problem = "is given twice"
        if problem is not None:
            raise InputError(problem, field=f"effects.{effect.name}", file=study.file)
    excluded = study.card.diagnosis.exclude
    unknown = [name for name in excluded if name not in catalogue()] if excluded else []
    if unknown:
        wrong = f"unknown effects {quoted(unknown, catalogue())}; 'tyrefem list effects' names them all"
        raise InputError(wrong, field="diagnosis.exclude", file=study.file)


def _same(effect: Effect, other: Effect) -> bool:
    return effect.name == other.name and effect.choice == other.choice
