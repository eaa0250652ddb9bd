"""Outcomes of a variant: its answers, its failure, or the reason why a reduced model cannot represent it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class Answered:
    """A variant with its answers.

    Parameters
    ----------
    answers : answer -> value; the answer's name ends in its unit. by : a full run or a reduced model.
    error : estimated error of the temperatures, K; None: no estimate.

    >>> Answered({"hottest_degC": 61.5}, "reduced").entry
    {'answers': {'hottest_degC': 61.5}, 'by': 'reduced'}
    """

    answers: Mapping[str, Any] = field(hash=False)
    by: Literal["full", "reduced"] = "full"
    error: float | None = None

    @property
    def entry(self) -> dict[str, Any]:
        """As files have it."""
        estimate = {} if self.error is None else {"error_K": self.error}
        return {"answers": dict(self.answers), "by": self.by, **estimate}


@dataclass(frozen=True)
class Failed:
    """A failed variant or task, with the reason.

    >>> Failed("the tyre bursts").entry
    {'failure': 'the tyre bursts'}
    """

    reason: str

    @property
    def entry(self) -> dict[str, Any]:
        """As files have it."""
        return {"failure": self.reason}


@dataclass(frozen=True)
class NotReducible:
    """A variant that a reduced model cannot represent, with the reason: it needs a full run."""

    reason: str


Outcome = Answered | Failed


def outcome_of(entry: Mapping[str, Any]) -> Outcome:
    """The outcome from an entry of a file.

    >>> outcome_of({"variant": 3, "failure": "the tyre bursts"})
    Failed(reason='the tyre bursts')
    """
    if "failure" in entry:
        return Failed(str(entry["failure"]))
    return Answered(entry["answers"], entry.get("by", "full"), entry.get("error_K"))


def answer_of(outcome: Outcome | None, name: str) -> Any:
    """An answer by name; None if the variant has no outcome, has failed, or has no such answer."""
    return outcome.answers.get(name) if isinstance(outcome, Answered) else None
