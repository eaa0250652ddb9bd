"""Answers about the variants of a sweep's sample: a table and sentences from the table of all variants."""

from __future__ import annotations

import functools
from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
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
    def table(self) -> pd.DataFrame:
        """The table of the answer.

        Raises
        ------
        InputError : the answer gave something else than a table.
        """
        import pandas as pd

        rows = self.question.rows(self.swept.table.copy())
        if not isinstance(rows, pd.DataFrame):
            name = type(self.question).__name__
            raise InputError(f"class {name}, rows: must give a pandas DataFrame, not {type(rows).__name__}")
        return rows

    @functools.cached_property
    def words(self) -> list[str]:
        """The answer in sentences."""
        return [str(line) for line in self.question.sentences(self.table)]

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {"rows": self.table.to_dict("records"), "words": self.words}
