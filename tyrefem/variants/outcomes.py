"""What became of a variant: its answers, why it failed, or why a reduced model cannot follow it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class Answered:
    """A variant with its answers.

    Parameters
    ----------
    answers : answer -> number or name, the unit at the end of the answer's name. by : a full run or a reduced model.

    >>> Answered({"hottest_degC": 61.5}, "reduced").entry
    {'answers': {'hottest_degC': 61.5}, 'by': 'reduced'}
    """

    answers: Mapping[str, Any] = field(hash=False)
    by: Literal["full", "reduced"] = "full"

    @property
    def entry(self) -> dict[str, Any]:
        """As files have it."""
        return {"answers": dict(self.answers), "by": self.by}


@dataclass(frozen=True)
class Failed:
    """Work without a result, and the reason in words.

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
    """A variant that a reduced model cannot follow, and the reason in words: a full run has to answer it."""

    reason: str


Outcome = Answered | Failed


def outcome_of(entry: Mapping[str, Any]) -> Outcome:
    """The outcome of an entry as files have it.

    >>> outcome_of({"variant": 3, "failure": "the tyre bursts"})
    Failed(reason='the tyre bursts')
    """
    if "failure" in entry:
        return Failed(str(entry["failure"]))
    return Answered(entry["answers"], entry.get("by", "full"))


def answer_of(outcome: Outcome | None, name: str) -> Any:
    """An answer by name; None: the variant has no outcome, has failed, or has no such answer."""
    return outcome.answers.get(name) if isinstance(outcome, Answered) else None
