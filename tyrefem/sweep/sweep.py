"""A sweep: evaluation of all variants of a plan on a scheduler, and the table of their answers."""

from __future__ import annotations

import functools
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.sweep.evaluation import VariantEvaluation
from tyrefem.variants.dask_cluster import ClusterLostError
from tyrefem.variants.execution import Execution, ExecutionOptions
from tyrefem.variants.outcomes import Answered, Failed, Outcome
from tyrefem.variants.plan import Plan

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.reduced.surrogate import SurrogateCertificate


@dataclass(frozen=True, eq=False)
class Sweep(Brief):
    """The outcomes of a plan's finished variants.

    Parameters
    ----------
    plan : the variants. outcomes : number -> `Answered` or `Failed`.
    certificate : of the reduced model; None: all answers are from full runs. why_full : why no model was used.
    seconds : wall time. resumed : variants that were finished before. interrupted : why the sweep is incomplete; empty:
        it is complete.
    """

    plan: Plan
    outcomes: Mapping[int, Outcome]
    certificate: SurrogateCertificate | None = None
    why_full: str = ""
    seconds: float = 0.0
    resumed: int = 0
    interrupted: str = ""

    def _title(self) -> str:
        return f"of {self.plan.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        reduced = self.reduced
        return {
            "varied": self.plan.headings,
            "variants": f"{len(self.outcomes)} of {len(self.plan.variants)} finished, {len(self.failed)} failed",
            "answers": self.answers,
            "answered by": f"{len(self.outcomes) - reduced} full runs"
            + (f", {reduced} by the reduced model, error {self.certificate.error:.2g} K" if self.certificate else ""),
            "wall time": f"{self.seconds:.3g} s",
        }

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """A row per finished variant: its values and answers, ``by``, ``error_K``, ``feasible``, ``failure``.

        ``error_K`` is the estimated error of a variant's temperatures, 0 for a full run. ``failure`` is empty
        without a failure.
        """
        import pandas as pd

        rows = [self._row(number) for number in sorted(self.outcomes)]
        table = pd.DataFrame(rows)
        if table.empty:
            return pd.DataFrame(columns=["variant", *self.plan.headings, "feasible", "failure"])
        for name in table.columns:
            if table[name].dtype == object and name not in ("variant", "failure", "by"):
                numbers = pd.to_numeric(table[name], errors="coerce")
                if numbers.notna().sum() == table[name].notna().sum():
                    table[name] = numbers
        last = {name: table.pop(name) for name in ("by", "error_K", "failure")}
        last["failure"] = last["failure"].fillna("")
        feasible = (last["failure"] == "") & self._within_limits(table)
        return table.assign(by=last["by"], error_K=last["error_K"], feasible=feasible, failure=last["failure"])

    def _row(self, number: int) -> dict[str, Any]:
        outcome, values = self.outcomes[number], self.plan.row(number)
        if isinstance(outcome, Failed):
            return values | {"by": "", "error_K": None, "failure": outcome.reason}
        error = self.certificate.error_of(outcome.error) if outcome.by == "reduced" and self.certificate else 0.0
        return values | dict(outcome.answers) | {"by": outcome.by, "error_K": error, "failure": ""}

    def _within_limits(self, table: pd.DataFrame) -> Any:
        within = np.ones(len(table), dtype=bool)
        for name, limit in self.plan.limits.items():
            if name not in table:
                raise InputError(f"no answer '{name}'{nearest(name, self.answers)}", field="limits")
            values = table[name].to_numpy(dtype=float)
            if limit.below is not None:
                within &= values < limit.below
            if limit.above is not None:
                # A time that is not reached (NaN) is later than any.
                within &= ~(values <= limit.above)
        return within

    @functools.cached_property
    def answers(self) -> list[str]:
        """Names of the answers."""
        return list(dict.fromkeys(name for outcome in self.answered.values() for name in outcome.answers))

    @functools.cached_property
    def answered(self) -> dict[int, Answered]:
        """Number -> outcome, of all variants with answers."""
        return {number: outcome for number, outcome in self.outcomes.items() if isinstance(outcome, Answered)}

    @property
    def reduced(self) -> int:
        """Number of variants that the reduced model answered."""
        return sum(outcome.by == "reduced" for outcome in self.answered.values())

    @property
    def failed(self) -> dict[str, str]:
        """Variant -> reason of its failure."""
        outcomes = sorted(self.outcomes.items())
        return {self.plan.names[n]: outcome.reason for n, outcome in outcomes if isinstance(outcome, Failed)}

    @property
    def complete(self) -> bool:
        """Do all variants have an outcome?"""
        return len(self.outcomes) == len(self.plan.variants)


def sweep(plan: Plan, execution: Execution | None = None, **options: Unpack[ExecutionOptions]) -> Sweep:
    """Evaluate all variants of a plan that are not finished yet.

    Parameters
    ----------
    execution : see `Execution`. options : its fields by name (``scheduler``, ``folder``, ``restart``, ``reduced``,
        ``tolerance``, ``progress``, ``settings``); they replace those of ``execution``.

    Ctrl-C or the loss of the cluster ends the sweep with the finished variants; `Sweep.interrupted` has the reason.

    Raises
    ------
    InputError : the folder holds another sweep; ``reduced`` is ``always`` and no model could be certified.
    """
    began, interrupted, numbers = time.perf_counter(), "", range(len(plan.variants))
    execution = (execution or Execution()).given(options)
    work = VariantEvaluation(plan, execution, plan.variants, plan.digest)
    try:
        with work:
            for number in numbers:
                work.resume(number)
            execution.report_progress("variants", len(work.outcomes), len(numbers))
            left = [number for number in numbers if number not in work.outcomes]
            if left:
                work.train(len(left))
            for finished in work.evaluate(left):
                execution.report_progress("variants", finished, len(numbers))
    except KeyboardInterrupt:
        interrupted = "interrupted"
    except ClusterLostError as error:
        interrupted = str(error)
    seconds = time.perf_counter() - began
    return Sweep(plan, work.outcomes, work.certificate, work.why_full, seconds, work.resumed, interrupted)
