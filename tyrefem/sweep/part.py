"""Interface of an answer in a design study."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Protocol

from tyrefem.brief import LINES, cut

if TYPE_CHECKING:
    import pandas as pd


class DesignPart(Protocol):
    """An answer of a design study: a table and sentences. ``name`` is the name of its folder and files.

    Its pictures are registered for its class with `tyrefem.reports.sweep_figures.figures`; a class without pictures
    sets ``drawn = False``. An answer from a `Sweep` hands on its ``interrupted``: then no further question is answered.
    An answer with runs of its own may have ``failed``, run -> reason: the command prints them and ends with 1.
    """

    name: str
    heading: str

    @property
    def table(self) -> pd.DataFrame:
        """The table of the answer."""
        ...

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        ...


class InSentences(ABC):
    """A part whose `repr` is its heading and its sentences, as a notebook shows them."""

    heading: str

    @property
    @abstractmethod
    def words(self) -> list[str]:
        """The answer in sentences."""

    def __repr__(self) -> str:
        rows = self.words
        shown = rows if len(rows) < LINES else [*rows[: LINES - 2], f"... and {len(rows) - LINES + 2} more"]
        return "\n".join([self.heading, *(cut(f"  {row}") for row in shown)])
