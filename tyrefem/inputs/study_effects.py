"""Check of a study's effects."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tyrefem.effects import catalogue
from tyrefem.effects.tyre import StudyOfTyre
from tyrefem.errors import InputError, nearest, quoted
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
    before: dict[str, list[Effect]] = {}
    for effect in study.card.effects:
        problem = effect.problem(study)
        of_name = before.setdefault(effect.name, [])
        if problem is None and any(_same(effect, other) for other in of_name):
            problem = "is given twice"
        of_name.append(effect)
        if problem is not None:
            raise InputError(problem, field=f"effects.{effect.name}", file=study.file)
    excluded = study.card.diagnosis.exclude
    known = catalogue() if excluded else {}
    if unknown := [name for name in excluded if name not in known]:
        wrong = f"unknown effects {quoted(unknown, known)}; 'tyrefem list effects' names them all"
        raise InputError(wrong, field="diagnosis.exclude", file=study.file)


def _same(effect: Effect, other: Effect) -> bool:
    """Whether two effects of a name are the same, in all runs or in the same run."""
    if effect.choice != other.choice:
        return False
    if effect.runs is None or other.runs is None:
        return effect.runs is other.runs
    return not set(effect.runs).isdisjoint(other.runs)


def check_runs(study: CheckedStudy, names: Collection[str]) -> None:
    """Refuse an effect in a run that is none of the measured runs ``names``.

    Raises
    ------
    InputError : names the effect, the run, and the nearest measured run.
    """
    for effect in study.card.effects:
        for run in effect.runs or ():
            if run not in names:
                message = f"there is no measured run '{run}'{nearest(run, names)}"
                raise InputError(message, field=f"effects.{effect.name}.runs", file=study.file)
