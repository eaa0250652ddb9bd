"""Answers about the variants of a sweep's sample: a table and sentences from the table of all variants."""

from __future__ import annotations

import functools
from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.plugins import registry
from tyrefem.plugins.guard import plugin_error
from tyrefem.sweep.part import DesignPart
from tyrefem.sweep.question import SweepQuestion
from tyrefem.sweep.sweep import Sweep
from tyrefem.variants.card import SweepCard
from tyrefem.variants.execution import Execution

if TYPE_CHECKING:
    import pandas as pd


class SampleAnswer(SweepQuestion):
    """Base of an answer about the sample of a sweep, which is computed once for all of them.

    A subclass has a ``key``, a ``heading``, and `rows`; its ``table`` is the model of its table in the sweep file.

    Raises
    ------
    InputError : the sweep has no sample: nothing varies.
    """

    #: Heading on the sweep's page.
    heading: ClassVar[str] = ""
    runs_variants: ClassVar[bool] = False

    def __init__(self, study: StudyData, table: Any, card: SweepCard) -> None:
        if not card.sampled:
            raise InputError("needs a sample of variants: [vary], or a table of cases")
        #: The table of the sweep file, and the study.
        self.settings, self.study = table, study

    @property
    def words(self) -> str:
        """The answer by name; the sample is counted by itself."""
        return f"the answer '{self.key}'"

    @abstractmethod
    def rows(self, variants: pd.DataFrame) -> pd.DataFrame:
        """The answer's table, from the table with a row per variant: its values, answers, ``feasible``, ``failure``."""

    def sentences(self, rows: pd.DataFrame) -> list[str]:
        """The answer in sentences, from its table."""
        return []

    def answered(self, execution: Execution) -> DesignPart:
        """Not used: the answer needs the sweep's own sample, see `of`."""
        raise NotImplementedError("a SampleAnswer is answered by `of`, from the sweep's sample")

    def of(self, swept: Sweep) -> SampleRows:
        """The answer of a finished sample."""
        return SampleRows(self.key, self.heading or self.key, self, swept)


@dataclass(frozen=True, eq=False)
class SampleRows:
    """A `SampleAnswer` of a sample. ``name``: of its files; ``heading``: on the page."""

    name: str
    heading: str
    question: SampleAnswer
    swept: Sweep
    drawn: ClassVar[bool] = False

    @functools.cached_property
    def rows(self) -> pd.DataFrame:
        """The rows as the answer's class gives them.

        Raises
        ------
        InputError : they are no table that can be written; names file, class and column.
        """
        rows = self.question.rows(self.swept.table.copy())
        fault = _fault(rows)
        if fault:
            raise self._error("rows", fault)
        return rows

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """The table of the answer; a named index, as ``groupby`` gives it, becomes columns."""
        named = [name for name in self.rows.index.names if name is not None]
        return self.rows.reset_index(named) if named else self.rows

    @functools.cached_property
    def words(self) -> list[str]:
        """The answer in sentences.

        Raises
        ------
        InputError : they are no list of texts; names file and class.
        """
        lines = self.question.sentences(self.rows.copy())
        if not isinstance(lines, list | tuple) or not all(isinstance(line, str) for line in lines):
            raise self._error("sentences", f"must give a list of texts, not {lines!r:.60}")
        return list(lines)

    def _error(self, method: str, words: str) -> InputError:
        """An error of the answer's class, with its file."""
        cls = type(self.question)
        plugin = registry().of_class(cls)
        place = f"class {cls.__name__}, {method}"
        return InputError(f"{place}: {words}") if plugin is None else plugin_error(plugin.origin, place, words)

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {"rows": self.table.to_dict("records"), "words": self.words}


def _fault(rows: Any) -> str | None:
    """What is wrong with the rows of an answer; None: they are a table that can be written."""
    import pandas as pd
    import pyarrow

    if not isinstance(rows, pd.DataFrame):
        return f"must give a pandas DataFrame, not {type(rows).__name__}"
    names = [*rows.columns, *(name for name in rows.index.names if name is not None)]
    wrong = next((name for name in names if not isinstance(name, str)), None)
    if wrong is not None:
        return f"columns must be named by text, not {wrong!r:.60}"
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        return f"has two columns '{twice}': rename either"
    for name in rows.columns:
        try:
            pyarrow.array(rows[name], from_pandas=True)
        except (pyarrow.ArrowException, TypeError, ValueError):
            kinds = " and ".join(sorted({type(value).__name__ for value in rows[name].dropna()}))
            return f"column '{name}' must have numbers only or texts only, not {kinds}"
    return None
