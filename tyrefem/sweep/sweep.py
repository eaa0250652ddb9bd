"""A sweep: every variant answered wherever the scheduler has room, kept as it is finished, one table of answers."""

from __future__ import annotations

import functools
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.sweep.answering import Answering
from tyrefem.variants.dask_cluster import ClusterLostError
from tyrefem.variants.execution import Execution, ExecutionOptions
from tyrefem.variants.outcomes import Answered, Failed, Outcome
from tyrefem.variants.plan import Plan

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.reduced.surrogate import SurrogateCertificate


@dataclass(frozen=True, eq=False)
class Sweep(Brief):
    """The answers of a plan's variants, as far as they are finished.

    Parameters
    ----------
    plan : the variants. outcomes : number -> `Answered` or `Failed`.
    certificate : of the reduced model; None: every answer is that of a full run. why_full : why none was used.
    seconds : wall time. taken_up : how many were finished before. interrupted : why some were not run; empty: all were.
    """

    plan: Plan
    outcomes: Mapping[int, Outcome]
    certificate: SurrogateCertificate | None = None
    why_full: str = ""
    seconds: float = 0.0
    taken_up: int = 0
    interrupted: str = ""

    def _title(self) -> str:
        return f"of {self.plan.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        reduced = self.reduced
        return {
            "varied": self.plan.keys,
            "variants": f"{len(self.outcomes)} of {len(self.plan.variants)} finished, {len(self.failed)} failed",
            "answers": self.answers,
            "answered by": f"{len(self.outcomes) - reduced} full runs"
            + (f", {reduced} by the reduced model, good to {self.certificate.worst:.2g} K" if self.certificate else ""),
            "wall time": f"{self.seconds:.3g} s",
        }

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """A row per finished variant: its values, its answers, ``by``, ``error_K`` (largest error of a temperature on
        fresh full runs; 0 for a full run), ``feasible``, ``failure`` (empty: none)."""
        import pandas as pd

        rows = [self._row(number) for number in sorted(self.outcomes)]
        table = pd.DataFrame(rows)
        if table.empty:
            return pd.DataFrame(columns=["variant", *self.plan.keys, "feasible", "failure"])
        for name in table.columns:
            if table[name].dtype == object and name not in ("variant", "failure", "by"):
                numbers = pd.to_numeric(table[name], errors="coerce")
                if numbers.notna().sum() == table[name].notna().sum():
                    table[name] = numbers
        last = {name: table.pop(name) for name in ("by", "error_K", "failure")}
        last["failure"] = last["failure"].fillna("")
        feasible = (last["failure"] == "") & self._kept(table)
        return table.assign(by=last["by"], error_K=last["error_K"], feasible=feasible, failure=last["failure"])

    def _row(self, number: int) -> dict[str, Any]:
        outcome, values = self.outcomes[number], self.plan.row(number)
        if isinstance(outcome, Failed):
            return values | {"by": "", "error_K": None, "failure": outcome.reason}
        error = self.certificate.worst if outcome.by == "reduced" and self.certificate else 0.0
        return values | dict(outcome.answers) | {"by": outcome.by, "error_K": error, "failure": ""}

    def _kept(self, table: pd.DataFrame) -> Any:
        kept = np.ones(len(table), dtype=bool)
        for name, limit in self.plan.limits.items():
            if name not in table:
                raise InputError(f"no answer '{name}'{nearest(name, self.answers)}", field="limits")
            values = table[name].to_numpy(dtype=float)
            if limit.below is not None:
                kept &= values < limit.below
            if limit.above is not None:
                # A time that was never reached is later than any.
                kept &= ~(values <= limit.above)
        return kept

    @functools.cached_property
    def answers(self) -> list[str]:
        """Names of the answers."""
        return list(dict.fromkeys(name for outcome in self.answered.values() for name in outcome.answers))

    @functools.cached_property
    def answered(self) -> dict[int, Answered]:
        """Number -> the answers of a variant that has some."""
        return {number: outcome for number, outcome in self.outcomes.items() if isinstance(outcome, Answered)}

    @property
    def reduced(self) -> int:
        """How many variants the reduced model answered."""
        return sum(outcome.by == "reduced" for outcome in self.answered.values())

    @property
    def failed(self) -> dict[str, str]:
        """Variant -> why it has no answers."""
        outcomes = sorted(self.outcomes.items())
        return {self.plan.names[n]: outcome.reason for n, outcome in outcomes if isinstance(outcome, Failed)}

    @property
    def complete(self) -> bool:
        """Has every variant an outcome?"""
        return len(self.outcomes) == len(self.plan.variants)


def sweep(plan: Plan, how: Execution | None = None, **options: Unpack[ExecutionOptions]) -> Sweep:
    """Answer every variant that is not finished yet.

    Parameters
    ----------
    how : see `Execution`. said : its fields by name (``scheduler``, ``folder``, ``restart``, ``reduced``,
        ``tolerance``, ``progress``), in place of it or to say some of it otherwise.

    Ctrl-C, or a cluster that is lost, ends the sweep with what is finished; `Sweep.interrupted` says why.

    Raises
    ------
    InputError : the folder holds another sweep; ``always``, and no reduced model could be certified.
    """
    began, interrupted, numbers = time.perf_counter(), "", range(len(plan.variants))
    how = (how or Execution()).given(options)
    work = Answering(plan, how, plan.variants, plan.digest)
    try:
        with work:
            for number in numbers:
                work.take_up(number)
            how.tick("variants", len(work.outcomes), len(numbers))
            left = [number for number in numbers if number not in work.outcomes]
            if left:
                work.train(len(left))
            for finished in work.answer(left):
                how.tick("variants", finished, len(numbers))
    except KeyboardInterrupt:
        interrupted = "interrupted"
    except ClusterLostError as error:
        interrupted = str(error)
    seconds = time.perf_counter() - began
    return Sweep(plan, work.outcomes, work.certificate, work.why_full, seconds, work.taken_up, interrupted)
