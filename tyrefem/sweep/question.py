"""Questions with separate tables in a sweep file; a class in a module of this package, or a plugin, adds one."""

from __future__ import annotations

import functools
import importlib
import pkgutil
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar

from tyrefem.cards import Card
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.plugins import Kind, registry
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

    plugin_kind: ClassVar[Kind]
    #: The table as in a sweep file, with which `tyrefem check` tries the question; only what has no default.
    example: ClassVar[Mapping[str, Any]] = {}
    #: Name of its table in a sweep file, of its keyword in ``study.sweep``, and of its answer's files.
    key: ClassVar[str] = ""
    #: Model of the table.
    table: ClassVar[type[Card]] = Card
    #: Position among the answers.
    place: ClassVar[int] = 9
    #: Does it run variants of its choice? If not, kept variants hold after an edit of it.
    runs_variants: ClassVar[bool] = True

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
def shipped_questions() -> dict[str, type[SweepQuestion]]:
    """The questions of this package by key."""
    package = __package__ or ""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        importlib.import_module(f"{package}.{module.name}")
    classes: list[type[SweepQuestion]] = [*SweepQuestion.__subclasses__()]
    for question in classes:
        classes += question.__subclasses__()
    return {
        question.key: question for question in classes if question.key and question.__module__.startswith(f"{package}.")
    }


def _complaint(cls: type) -> str | None:
    """What is wrong with a user's question, beside its methods."""
    key, table = str(getattr(cls, "key", "")), getattr(cls, "table", None)
    if key in SweepCard.model_fields or key in RESERVED:
        return "has the name of another table, file or option of a sweep: rename it"
    if not re.fullmatch(r"[a-z][a-z0-9-]*", key):
        return "its key must be of small letters, digits and -, as it names files"
    if not (isinstance(table, type) and issubclass(table, Card)):
        return f"table must be a class that extends tyrefem.cards.Card, not {table!r:.40}"
    return None


#: Names that no question may have: of files and folders of a sweep, keys of its summary, keywords of ``study.sweep``.
RESERVED = (
    *("sweep", "errors", "summary", "pictures", "optimum", "indices", "variants"),
    *("complete", "asked", "failures", "mesh", "versions", "plugins", "input", "words", "files", "command"),
    *("checksums", "writing", *(each.name for each in fields(Execution))),
)
KIND = SweepQuestion.plugin_kind = Kind(
    "sweep answer",
    "sweep answers",
    'key: ClassVar[str] = "..."',
    lambda cls: str(getattr(cls, "key", "")),
    shipped_questions,
    _complaint,
    computes=lambda cls: bool(getattr(cls, "runs_variants", True)),
)


def sweep_questions() -> dict[str, type[SweepQuestion]]:
    """All questions by key, in the order of the report.

    >>> list(sweep_questions())
    ['tornado', 'envelope']
    """
    plugins: list[Any] = list(registry().classes(KIND).values())
    classes: list[type[SweepQuestion]] = [*shipped_questions().values(), *plugins]
    return {question.key: question for question in sorted(classes, key=lambda each: (each.place, each.key))}


def with_further_tables(data: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep file's content with the tables of further questions moved to ``further``, as `SweepCard` has them."""
    known = sweep_questions()
    for key in data:
        if key not in SweepCard.model_fields:
            registry().refuse(KIND, key, known=key in known)
    keys = [key for key in known if key in data and key not in SweepCard.model_fields]
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
        registry().refuse(KIND, key, known=key in known)
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
