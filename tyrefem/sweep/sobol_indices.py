"""Sobol indices: the share of an answer's variance from each number, alone and with its interactions."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.sweep.part import InSentences
from tyrefem.sweep.sweep import Sweep
from tyrefem.variants.answer_units import name_of
from tyrefem.variants.samples import problem

if TYPE_CHECKING:
    import pandas as pd

#: Largest half width of a 95 % interval of a total index; beyond it the sample is too small.
WIDE = 0.15


def indices(swept: Sweep, answer: str) -> pd.DataFrame:
    """First-order and total Sobol indices of an answer with 95 % intervals; the largest total first.

    S_i = Var(E(y | x_i)) / Var(y), T_i = E(Var(y | x_~i)) / Var(y) (Saltelli et al. 2010, by SALib; intervals by its
    bootstrap), numbers uniform in their ranges and independent.

    Raises
    ------
    InputError : the variants are not a Saltelli sample, or some have no answer: the estimate needs all of them.
    """
    import pandas as pd
    from SALib.analyze import sobol

    plan = swept.plan
    if plan.sampling.get("sample") != "saltelli":
        raise InputError("Sobol indices need sample = 'saltelli'", field="sample")
    numbers = swept.packed.numbers
    y = np.full(len(plan.variants), np.nan)
    y[numbers] = swept.packed.columns(numbers, [answer]).answers[answer].astype(float)
    missing = int(np.isnan(y).sum())
    if missing:
        raise InputError(f"{missing} of {len(y)} variants have no '{answer}'; Sobol indices need them all")
    names = [varied.label for varied in plan.varied]
    if np.ptp(y) == 0:
        nothing = np.zeros(len(names))
        analysis = dict.fromkeys(("S1", "S1_conf", "ST", "ST_conf"), nothing)
    else:
        analysis = sobol.analyze(
            problem(plan.varied), y, calc_second_order=False, seed=plan.sampling["seed"], print_to_console=False
        )
    table = pd.DataFrame(
        {
            "number": names,
            "first": analysis["S1"],
            "first_95": analysis["S1_conf"],
            "total": analysis["ST"],
            "total_95": analysis["ST_conf"],
        }
    )
    return table.sort_values("total", ascending=False, ignore_index=True)


@dataclass(frozen=True, eq=False, repr=False)
class Indices(InSentences):
    """Sobol indices of some answers of a sweep over Saltelli's sample."""

    swept: Sweep
    answers: tuple[str, ...]

    name = "indices"
    heading = "Sobol indices"

    @functools.cached_property
    def _tables_or_reasons(self) -> dict[str, pd.DataFrame | str]:
        results: dict[str, pd.DataFrame | str] = {}
        for answer in self.answers:
            try:
                results[answer] = indices(self.swept, answer)
            except InputError as error:
                results[answer] = error.message
        return results

    @property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Answer -> its indices, for all answers with an estimate."""
        return {answer: result for answer, result in self._tables_or_reasons.items() if not isinstance(result, str)}

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """All indices; the first column is the answer."""
        import pandas as pd

        parts = [part.assign(answer=answer) for answer, part in self.tables.items()]
        columns = ["answer", "number", "first", "first_95", "total", "total_95"]
        return pd.concat(parts, ignore_index=True)[columns] if parts else pd.DataFrame(columns=columns)

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        sentences = []
        for answer, result in self._tables_or_reasons.items():
            if isinstance(result, str):
                sentences.append(f"No Sobol indices of the {name_of(answer)}: {result}.")
                continue
            shares = ", ".join(
                f"{row['number']} {100 * row['total']:.0f} % (±{100 * row['total_95']:.0f})"
                for row in result.head(4).to_dict("records")
            )
            wide = float(result["total_95"].max())
            alone = 100 * float(result["first"].sum())
            sentences.append(
                f"Shares in the variance of the {name_of(answer)}, with interactions: {shares}. First-order effects"
                f" explain {alone:.0f} % of it."
            )
            if wide > WIDE:
                sentences.append(f"Intervals of up to ±{100 * wide:.0f} % are wide: use a larger base sample.")
        return sentences

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {"rows": self.table.to_dict("records"), "words": self.words}
