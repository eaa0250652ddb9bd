"""A sweep: evaluation of all variants of a plan on a scheduler, and the table of their answers."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief, counted
from tyrefem.cache import Cache
from tyrefem.errors import InputError, nearest
from tyrefem.sweep.evaluation import VariantEvaluation
from tyrefem.variants.answers import TIME_TO, comparable
from tyrefem.variants.blocks import Numbers
from tyrefem.variants.dask_cluster import ClusterLostError
from tyrefem.variants.execution import Execution, ExecutionOptions
from tyrefem.variants.outcome_table import OutcomeColumns, OutcomeTable
from tyrefem.variants.outcomes import Answered, Outcome
from tyrefem.variants.plan import Plan

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.reduced.surrogate import SurrogateCertificate

#: Rows of a table that are made at once.
ROWS_AT_ONCE = 8192
#: Answers that sentences and pictures use by default.
USUAL = ("hottest_degC", "rolling_resistance_coefficient", "mass_kg", TIME_TO)


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
            "answered by": counted(len(self.outcomes) - reduced, "full run")
            + (f", {reduced} by the reduced model, error {self.certificate.error:.2g} K" if self.certificate else ""),
            "wall time": f"{self.seconds:.3g} s",
        }

    @functools.cached_property
    def packed(self) -> OutcomeTable:
        """The outcomes, packed."""
        return self.outcomes if isinstance(self.outcomes, OutcomeTable) else OutcomeTable(self.outcomes)

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """A row per finished variant: its values and answers, ``by``, ``error_K``, ``feasible``, ``failure``.

        ``error_K`` is the estimated error of a variant's temperatures, 0 for a full run. ``failure`` is empty
        without a failure.
        """
        return self.rows(self.packed.numbers)

    def overview(self, answers: Sequence[str] = ()) -> pd.DataFrame:
        """`table` with some answers only: `USUAL`, those with limits, and ``answers`` as far as there are any."""
        wanted = tuple(dict.fromkeys((*USUAL, *self.plan.limits, *answers)))
        return self._overviews.get(wanted, lambda: self._joined(self.packed.numbers, wanted))

    @functools.cached_property
    def _overviews(self) -> Cache[pd.DataFrame]:
        return Cache(2)

    def rows(self, numbers: Numbers) -> pd.DataFrame:
        """The rows of `table` of some finished variants, by their increasing numbers."""
        return self._joined(numbers, self.answers)

    def parts(self, rows: int = ROWS_AT_ONCE) -> Iterator[pd.DataFrame]:
        """`table` in parts of so many rows, without all rows in memory; every part has the types of the whole table."""
        numbers, texts = self.packed.numbers, self.packed.other_than_floats
        overview, headings = self.overview(), self.plan.headings
        settings, order = overview.dtypes, [name for name in overview if name in {"variant", *headings}]
        for first in range(0, len(numbers), rows):
            part = self._part(numbers[first : first + rows], self.answers)
            # Variants of a list may leave out values: a part need not have all of them, nor in this order.
            part = part.reindex(columns=[*order, *(name for name in part if name not in order)])
            types: dict[str, Any] = {name: settings[name] for name in headings if name in settings}
            types |= {name: np.dtype(object if name in texts else float) for name in self.answers}
            shown: dict[Any, Any] = {name: kind for name, kind in types.items() if name in part}
            yield self._judged(part.astype(shown))

    def _joined(self, numbers: Numbers, answers: Sequence[str]) -> pd.DataFrame:
        """The rows of some variants with some answers, part by part, so that few are in memory as objects."""
        import pandas as pd

        if not len(numbers):
            return pd.DataFrame(columns=["variant", *self.plan.headings, "feasible", "failure"])
        firsts = range(0, len(numbers), ROWS_AT_ONCE)
        parts = [self._part(numbers[first : first + ROWS_AT_ONCE], answers) for first in firsts]
        table = parts[0] if len(parts) == 1 else pd.concat(parts, ignore_index=True)
        for name in table.columns:
            if table[name].dtype == object and name not in ("variant", "failure", "by"):
                numeric = pd.to_numeric(table[name], errors="coerce")
                if numeric.notna().sum() == table[name].notna().sum():
                    table[name] = numeric
        return self._judged(table)

    def _part(self, numbers: Numbers, answers: Sequence[str]) -> pd.DataFrame:
        """The rows of a few variants, without ``feasible``."""
        import pandas as pd

        settings = pd.DataFrame([self.plan.row(number) for number in numbers.tolist()])
        columns = self.packed.columns(numbers, answers)
        known = {name: values for name, values in columns.answers.items() if name in self.answers}
        last = {"by": columns.by, "error_K": self._errors(columns), "failure": columns.failures}
        return pd.concat([settings, pd.DataFrame({**known, **last})], axis=1)

    def _errors(self, columns: OutcomeColumns) -> NDArray[np.float64]:
        """Estimated errors, K: 0 of full runs, NaN of failures."""
        errors = np.where(columns.by == "", np.nan, 0.0)
        if self.certificate is not None:
            for row in np.flatnonzero(columns.by == "reduced"):
                estimate = float(columns.errors[row])
                errors[row] = self.certificate.error_of(None if math.isnan(estimate) else estimate)
        return errors

    def _judged(self, table: pd.DataFrame) -> pd.DataFrame:
        """The table with the column ``feasible``."""
        feasible = (table["failure"] == "") & self._within_limits(table)
        table.insert(list(table.columns).index("failure"), "feasible", feasible)
        return table

    def _within_limits(self, table: pd.DataFrame) -> Any:
        within = np.ones(len(table), dtype=bool)
        for name, limit in self.plan.limits.items():
            if name not in table:
                if not self.answers:
                    # All variants failed: none keeps a limit.
                    return np.zeros(len(table), dtype=bool)
                raise InputError(f"no answer '{name}'{nearest(name, self.answers)}", field="limits")
            values = comparable(name, table[name])
            if limit.below is not None:
                within &= values < limit.below
            if limit.above is not None:
                within &= values > limit.above
        return within

    @functools.cached_property
    def answers(self) -> list[str]:
        """Names of the answers."""
        return self.packed.names

    @property
    def answered(self) -> Iterator[tuple[int, Answered]]:
        """(number, outcome) of all variants with answers, by number."""
        return ((number, outcome) for number, outcome in self.packed.items() if isinstance(outcome, Answered))

    @property
    def reduced(self) -> int:
        """Number of variants that the reduced model answered."""
        return self.packed.reduced

    @functools.cached_property
    def failed(self) -> dict[str, str]:
        """Variant -> reason of its failure."""
        return {self.plan.names[number]: outcome.reason for number, outcome in self.packed.failed.items()}

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
            execution.report_progress("variants", len(work.outcomes), len(numbers))
            left = work.outcomes.without(np.arange(len(numbers), dtype=np.intp))
            if len(left):
                work.train(len(left))
            for finished in work.evaluate(left):
                execution.report_progress("variants", finished, len(numbers))
    except KeyboardInterrupt:
        interrupted = "interrupted"
    except ClusterLostError as error:
        interrupted = str(error)
    seconds = time.perf_counter() - began
    return Sweep(plan, work.outcomes, work.certificate, work.why_full, seconds, work.resumed, interrupted)
