"""A contract: what a plugin must do, in plain words, and what is wrong with it."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyrefem.conduction import SolverError
from tyrefem.errors import InputError
from tyrefem.plugins import Trial
from tyrefem.plugins.guard import failure_words


@dataclass(frozen=True)
class Contract:
    """What a plugin must do. ``fault``: what is wrong; None: it is kept. ``trials``: how often it was tried."""

    words: str
    fault: str | None = None
    trials: int = 1

    @property
    def line(self) -> str:
        """The contract in a line, with "pass" or "FAIL" before it."""
        often = f" ({self.trials} trials)" if self.trials > 1 else ""
        return f"FAIL  {self.words}: {self.fault}" if self.fault else f"pass  {self.words}{often}"


def kept(words: str, attempt: Callable[[], str | None]) -> Contract:
    """A contract that is kept if ``attempt`` gives None; it gives what is wrong, or fails with an error.

    >>> kept("film is a number", lambda: None).line, kept("film is a number", lambda: "it is text").line
    ('pass  film is a number', 'FAIL  film is a number: it is text')
    """
    try:
        return Contract(words, attempt())
    except (InputError, SolverError) as error:
        return Contract(words, str(error))
    except Exception as error:
        return Contract(words, failure_words(error, ""))


def of_trials(trials: Iterable[Trial]) -> Iterator[Contract]:
    """Trials of the same claim as a contract each: the first fault, or how many trials it has passed."""
    by_claim: dict[str, list[Trial]] = {}
    try:
        for trial in trials:
            by_claim.setdefault(trial.claim, []).append(trial)
    except Exception as error:
        message = str(error) if isinstance(error, InputError) else failure_words(error, "")
        yield Contract("its values can be tried", message)
    for claim, tried in by_claim.items():
        yield Contract(claim, next((trial.fault for trial in tried if trial.fault), None), len(tried))


def pickles(value: Any) -> Contract:
    """The object reaches worker processes and is the same there."""

    def attempt() -> str | None:
        again = pickle.loads(pickle.dumps(value))
        return None if again == value else "it is another after pickling"

    return kept("it reaches worker processes unchanged", attempt)


def finite_run(study: Any) -> Contract:
    """A short run of a study with the plugin ends with finite temperatures and a closed heat budget."""

    def attempt() -> str | None:
        from tyrefem.simulation.run import run

        result = run(study)
        readings = result.readings.drop(columns="time_s").to_numpy(dtype=float)
        if not np.isfinite(readings).all():
            return "temperatures are not finite"
        imbalance = result.heat_budget.imbalance
        return None if imbalance < 1e-4 else f"the heat budget does not close: {100 * imbalance:.2g} % are missing"

    return kept("a short run with it ends: finite temperatures, closed heat budget", attempt)
