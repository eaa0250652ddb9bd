"""Questions with separate tables in a sweep file; a class in any module of this package adds a question."""

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
    """A question about a study: the planned work, and the answer.

    Parameters
    ----------
    study : the unchanged study. table : the table of the question. card : the whole sweep file.

    Raises
    ------
    InputError : the table is invalid for the study.
    """

    #: Name of its table in a sweep file, of its keyword in ``study.sweep``, and of its answer's files.
    key: ClassVar[str] = ""
    #: Model of the table.
    table: ClassVar[type[Card]] = Card
    #: Position among the answers.
    place: ClassVar[int] = 9

    @abstractmethod
    def __init__(self, study: StudyData, table: Any, card: SweepCard) -> None: ...

    @property
    @abstractmethod
    def words(self) -> str:
        """The planned work, e.g. "a tornado of 5 tolerances"."""

    @abstractmethod
    def answered(self, execution: Execution) -> DesignPart:
        """Answer the question. ``execution`` has a separate folder for its finished variants."""


@functools.cache
def sweep_questions() -> dict[str, type[SweepQuestion]]:
    """All questions by key, in the order of the report.

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


def with_further_tables(data: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep file's content with the tables of further questions moved to ``further``, as `SweepCard` has them."""
    keys = [key for key in sweep_questions() if key in data and key not in SweepCard.model_fields]
    rest = {key: value for key, value in data.items() if key not in keys}
    further = {key: data[key] for key in keys if data[key] is not None}
    return {**rest, "further": further} if further else rest


def questions_of(study: StudyData, card: SweepCard) -> tuple[SweepQuestion, ...]:
    """The questions of a sweep file.

    Raises
    ------
    InputError : an unknown question, or a table that is invalid for the study; names the table.
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
