"""A sweep: every variant answered wherever the scheduler has room, kept as it is finished, one table of answers."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.errors import InputError, nearest
from tyrefem.sweep.cluster import ClusterLostError
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.schedulers import Here, Scheduler
from tyrefem.sweep.store import Store
from tyrefem.sweep.task import perform, perform_all

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.reduced.surrogate import Certificate, Surrogate

Tick = Callable[[str, int, int], None]
#: Fewer variants than this per number that varies are run in full: training would cost as much.
WORTH_TRAINING = 12
#: Variants of one piece of work at most; so many variants are run one by one.
PIECE, SINGLE = 64, 2000
#: Under this name a sweep's folder keeps the certificate of the reduced model.
CERTIFICATE = "certificate"


@dataclass(frozen=True, eq=False)
class Sweep:
    """The answers of a plan's variants, as far as they are finished.

    Parameters
    ----------
    plan : the variants. outcomes : number -> ``{"answers": ..., "by": "full" | "reduced"}`` or ``{"failure": ...}``.
    certificate : of the reduced model; None: every answer is that of a full run. why_full : why none was used.
    seconds : wall time. taken_up : how many were finished before. interrupted : why some were not run; empty: all were.
    """

    plan: Plan
    outcomes: dict[int, dict[str, Any]]
    certificate: Certificate | None = None
    why_full: str = ""
    seconds: float = 0.0
    taken_up: int = 0
    interrupted: str = ""

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
        outcome = self.outcomes[number]
        by = outcome.get("by", "")
        error = self.certificate.worst if by == "reduced" and self.certificate else 0.0
        found = self.plan.row(number) | dict(outcome.get("answers", {}))
        return found | {"by": by, "error_K": error if by else None, "failure": outcome.get("failure", "")}

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
        return list(dict.fromkeys(name for one in self.outcomes.values() for name in one.get("answers", {})))

    @property
    def failed(self) -> dict[str, str]:
        """Variant -> why it has no answers."""
        return {self.plan.names[n]: one["failure"] for n, one in sorted(self.outcomes.items()) if "failure" in one}

    @property
    def complete(self) -> bool:
        """Has every variant an outcome?"""
        return len(self.outcomes) == len(self.plan.variants)


def sweep(
    plan: Plan,
    *,
    scheduler: Scheduler | None = None,
    folder: Path | None = None,
    restart: bool = False,
    reduced: str = "auto",
    tolerance: float = 0.01,
    progress: Tick | None = None,
) -> Sweep:
    """Answer every variant that is not finished yet.

    Parameters
    ----------
    scheduler : where to; by default this process. folder : where finished variants are kept; None: nowhere.
    restart : forget what the folder has. progress : called with (what is done, finished, of how many).
    reduced : ``never``: full runs only; ``auto``: a reduced model where many variants are left and it is certified,
        full runs otherwise; ``always``: refuse where it is not certified. tolerance : K, of the certificate.

    Ctrl-C, or a cluster that is lost, ends the sweep with what is finished; `Sweep.interrupted` says why.

    Raises
    ------
    InputError : the folder holds another sweep; ``always``, and no reduced model could be certified.
    """
    began = time.perf_counter()
    scheduler, tick = scheduler or Here(), progress or (lambda what, done, total: None)
    store = None if folder is None else Store(folder, f"{plan.digest}-{reduced}-{tolerance:g}")
    outcomes: dict[int, dict[str, Any]] = {}
    certificate: Certificate | None = None
    why, taken, interrupted = "", 0, ""
    try:
        if store is not None:
            taken = store.open(restart=restart)
            outcomes |= {n: {k: v for k, v in one.items() if k != "variant"} for n, one in store.done.items()}
            certificate = _certificate(store.notes.get(CERTIFICATE))
        keep = _Keep(outcomes, store, lambda: tick("variants", len(outcomes), len(plan.variants)))
        left = [number for number in range(len(plan.variants)) if number not in outcomes]
        if reduced != "never" and left:
            found, why = _reduced(plan, left, scheduler, reduced, tolerance, keep, tick)
            certificate = found or certificate
            left = [number for number in left if number not in outcomes]
        _full(plan, left, scheduler, keep)
    except KeyboardInterrupt:
        interrupted = "interrupted"
    except ClusterLostError as error:
        interrupted = str(error)
    finally:
        if store is not None:
            store.close()
    return Sweep(plan, outcomes, certificate, why, time.perf_counter() - began, taken, interrupted)


class _Keep:
    """Takes outcomes into memory and onto disk."""

    def __init__(self, outcomes: dict[int, dict[str, Any]], store: Store | None, tick: Callable[[], None]) -> None:
        self.outcomes, self.store, self.tick = outcomes, store, tick
        tick()

    def note(self, name: str, value: Any) -> None:
        if self.store is not None:
            self.store.note(name, value)

    def __call__(self, found: Mapping[int, dict[str, Any]]) -> None:
        self.outcomes.update(found)
        if self.store is not None:
            self.store.add(found)
        self.tick()


def _full(plan: Plan, left: Sequence[int], scheduler: Scheduler, keep: _Keep, most: int = PIECE) -> None:
    """Run variants in full, so many together that a scheduler is not kept busy by counting them."""
    size = min(max(len(left) // SINGLE, 1), most)
    if size == 1:
        for place, outcome in scheduler.outcomes(perform, [plan.task(number) for number in left]):
            keep({left[place]: _by(outcome, "full")})
        return
    pieces = [left[first : first + size] for first in range(0, len(left), size)]
    lost: list[int] = []
    for place, outcome in scheduler.outcomes(perform_all, [[plan.task(n) for n in piece] for piece in pieces]):
        piece = pieces[place]
        if "outcomes" in outcome:
            keep({n: _by(one, "full") for n, one in zip(piece, outcome["outcomes"], strict=True)})
        else:
            lost += piece
    if lost:
        # One of them took its worker down: the others are not to suffer for it.
        _full(plan, lost, scheduler, keep, 1)


def _by(outcome: dict[str, Any], how: str) -> dict[str, Any]:
    return outcome if "failure" in outcome else {**outcome, "by": how}


def _certificate(noted: Mapping[str, Any] | None) -> Certificate | None:
    from tyrefem.reduced.surrogate import Certificate

    return None if noted is None else Certificate(**noted)


def _reduced(
    plan: Plan, left: list[int], scheduler: Scheduler, how: str, tolerance: float, keep: _Keep, tick: Tick
) -> tuple[Certificate | None, str]:
    """Answer what a certified reduced model can; its certificate, or why there is none."""
    from tyrefem.reduced.model import NotReducibleError
    from tyrefem.reduced.surrogate import surrogate

    if how == "auto" and len(left) < WORTH_TRAINING * max(len(plan.varied), 1):
        return None, f"{len(left)} variants are too few to train for"
    try:
        trained = surrogate(plan, tolerance=tolerance, scheduler=scheduler, progress=tick)
    except NotReducibleError as error:
        if how == "always":
            raise
        return None, str(error)
    keep.note(CERTIFICATE, asdict(trained.certificate))
    for found in by_model(trained, plan, [plan.variants[n] for n in left], scheduler):
        keep({left[place]: outcome for place, outcome in found.items()})
    return trained.certificate, ""


def by_model(
    trained: Surrogate, plan: Plan, variants: Sequence[Mapping[str, Any]], scheduler: Scheduler
) -> Iterator[dict[int, dict[str, Any]]]:
    """Outcomes of variants, by place, as pieces are finished; what could not be reduced is left out, for full runs."""
    from tyrefem.reduced.work import ReducedTask, perform_reduced

    packed = trained.packed(plan.packed)
    firsts = range(0, len(variants), PIECE)
    tasks = [ReducedTask(list(variants[first : first + PIECE]), plan.time_to) for first in firsts]
    for number, outcome in scheduler.outcomes(perform_reduced, tasks, packed):
        found = enumerate(outcome.get("outcomes", ()), firsts[number])
        yield {place: _by(one, "reduced") for place, one in found if "not_reducible" not in one}
