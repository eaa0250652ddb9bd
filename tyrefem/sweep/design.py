"""A design study: everything that a sweep file asks of a study, checked before anything runs, and the answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.studies import Study
from tyrefem.sweep.card import SweepCard
from tyrefem.sweep.envelope import Envelope
from tyrefem.sweep.indices import Indices
from tyrefem.sweep.optimum import Optimum
from tyrefem.sweep.pareto import ParetoFront
from tyrefem.sweep.responses import Responses, judged
from tyrefem.sweep.sweep import Sweep
from tyrefem.sweep.tornado import Tornado

if TYPE_CHECKING:
    import pandas as pd


class Part(Protocol):
    """One answer: a table and words. Its folder of finished variants and its files have its ``name``.

    Its pictures are what is registered for its class with `tyrefem.sweep.pictures.figures`.
    """

    name: str
    heading: str

    @property
    def table(self) -> pd.DataFrame:
        """To take away."""
        ...

    @property
    def words(self) -> list[str]:
        """Sentences."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        ...


@dataclass(frozen=True, eq=False)
class Design(Brief):
    """The answers to a design study.

    Parameters
    ----------
    study, card : what was asked. swept : the variants of the sample; None: none were asked for.
    tornado, optimum, envelope : the answers asked for, else None. interrupted : why some were not reached; empty: none.
    """

    study: Study
    card: SweepCard
    swept: Sweep | None
    tornado: Tornado | None = None
    optimum: Optimum | None = None
    envelope: Envelope | None = None
    interrupted: str = ""

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        swept = {} if self.swept is None else self.swept._facts()
        told = {part.name: next(iter(part.words), "nothing to tell") for part in self.parts}
        return {**swept, **told, **({"interrupted": self.interrupted} if self.interrupted else {})}

    @property
    def parts(self) -> tuple[Part, ...]:
        """All answers, in the order in which they are told."""
        found: list[Part] = []
        if self.optimum is not None:
            found.append(self.optimum)
        if self.swept is not None and self.swept.outcomes:
            found.append(Responses(self.swept, self.card.answers))
            found.append(ParetoFront(self.swept, dict(self.card.pareto)))
        found += [one for one in (self.indices, self.tornado, self.envelope) if one is not None]
        return tuple(found)

    @property
    def table(self) -> pd.DataFrame:
        """A row per variant: see `Sweep.table`; without a sample those that the optimiser evaluated."""
        if self.swept is not None:
            return self.swept.table
        if self.optimum is not None:
            return self.optimum.table
        raise InputError("no variants were asked for")

    @property
    def pareto(self) -> pd.DataFrame:
        """The variants that no other beats: see `tyrefem.sweep.pareto.front`."""
        from tyrefem.sweep.pareto import front

        return front(self.table, dict(self.card.pareto))

    @property
    def indices(self) -> Indices | None:
        """Sobol indices, of a Saltelli sample."""
        if self.swept is None or self.swept.plan.how.get("sample") != "saltelli" or not self.swept.complete:
            return None
        return Indices(self.swept, tuple(judged(self.swept, self.card.answers)))

    @property
    def failed(self) -> dict[str, str]:
        """Variant -> why it has no answers."""
        return {} if self.swept is None else self.swept.failed

    @property
    def words(self) -> list[str]:
        """All answers in sentences."""
        return [line for part in self.parts for line in part.words]
