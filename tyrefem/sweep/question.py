"""A question of a sweep file that has a table of its own: one class in a module of this package, found by existing."""

from __future__ import annotations

import functools
import importlib
import pkgutil
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from tyrefem.cards import Card
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.sweep.part import DesignPart
from tyrefem.variants.card import SweepCard
from tyrefem.variants.execution import Execution


class SweepQuestion(ABC):
    """A question about a study: what it would run, and its answer.

    Parameters
    ----------
    study : the study as it is. table : the question's own table. card : the whole sweep file.

    Raises
    ------
    InputError : when made: something in the table makes no sense for the study.
    """

    #: Its table in a sweep file, its keyword of ``study.sweep``, and the name of its answer's files.
    key: ClassVar[str] = ""
    #: What the table may say.
    table: ClassVar[type[Card]] = Card
    #: Its place among the answers.
    place: ClassVar[int] = 9

    @abstractmethod
    def __init__(self, study: StudyData, table: Any, card: SweepCard) -> None: ...

    @property
    @abstractmethod
    def words(self) -> str:
        """What would be run: "a tornado of 5 tolerances"."""

    @abstractmethod
    def answered(self, how: Execution) -> DesignPart:
        """Run it. ``how`` keeps finished variants in a folder of the question's own."""


@functools.cache
def sweep_questions() -> dict[str, type[SweepQuestion]]:
    """Every question by its key, in the order in which they are told.

    >>> list(sweep_questions())
    ['tornado', 'envelope']
    """
    package = __package__ or ""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        importlib.import_module(f"{package}.{module.name}")
    classes: list[type[SweepQuestion]] = [*SweepQuestion.__subclasses__()]
    for question in classes:
        classes += question.__subclasses__()
    return {
        question.key: question for question in sorted(classes, key=lambda each: (each.place, each.key)) if question.key
    }


def further_apart(data: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep file's content with the tables of further questions under ``further``, where `SweepCard` takes them."""
    keys = [key for key in sweep_questions() if key in data and key not in SweepCard.model_fields]
    rest = {key: value for key, value in data.items() if key not in keys}
    further = {key: data[key] for key in keys if data[key] is not None}
    return {**rest, "further": further} if further else rest


def questions_of(study: StudyData, card: SweepCard) -> tuple[SweepQuestion, ...]:
    """The questions that a sweep file asks.

    Raises
    ------
    InputError : an unknown question, or a table that makes no sense for the study; names the table.
    """
    known = sweep_questions()
    for key in card.further:
        if key not in known:
            raise InputError(f"unknown question '{key}'{nearest(key, known)}", field="further")
    questions = []
    for key, question in known.items():
        table = card.further.get(key, getattr(card, key, None))
        if table is None:
            continue
        try:
            questions.append(question(study, question.table.check(table), card))
        except InputError as error:
            placed = error.file or (error.field or "").split(".")[0] == key
            raise error if placed else error.within(field=key) from None
    return tuple(questions)
