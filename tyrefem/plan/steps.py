"""A test plan: runs and sensors in their order, with what each is expected to tell and its cost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from tyrefem.brief import Brief, counted
from tyrefem.diagnose.numbers import percent

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.plan.batch import ExperimentChoice
    from tyrefem.plan.beliefs import Beliefs
    from tyrefem.plan.drives import CandidateDrive
    from tyrefem.plan.places import CandidatePlace


@dataclass(frozen=True, eq=False)
class PlanStep(Brief):
    """A step of a plan.

    Parameters
    ----------
    number : from 1 on. drive : of the run, None for a further sensor only. place : of the further sensor, if any.
    run : number of the run, from 1 on. cost, total_cost : of this step, and of all steps so far.
    gain : expected information that this step adds, nats. total_gain, sd : of all steps so far, and its standard error.
    right : expected probability of the true set after all steps so far. named : share of cases in which it has 95 %.
    between : the most probable set, and the most probable one of those that lack a member of it.
    pair_probability : expected probability of the true one of the two, if one is true.
    """

    number: int
    drive: CandidateDrive | None
    place: CandidatePlace | None
    run: int | None
    cost: float
    total_cost: float
    gain: float
    total_gain: float
    sd: float
    right: float
    named: float
    between: tuple[str, str]
    pair_probability: float

    @property
    def kind(self) -> str:
        """run, sensor, or run + sensor."""
        return " + ".join(name for name, part in (("run", self.drive), ("sensor", self.place)) if part is not None)

    def to_dict(self) -> dict[str, Any]:
        """A row of the table: SI units, gains in nats."""
        return {
            "step": self.number,
            "kind": self.kind,
            "run": self.run,
            "drive": None if self.drive is None else self.drive.name,
            "changes": None if self.drive is None else {f"drive.{key}": x for key, x in self.drive.changes.items()},
            "duration_s": None if self.drive is None else self.drive.duration,
            "sensor": None if self.place is None else self.place.name,
            "place": None if self.place is None else self.place.words,
            "cost": self.cost,
            "total_cost": self.total_cost,
            "gain_nats": self.gain,
            "total_gain_nats": self.total_gain,
            "total_gain_sd_nats": self.sd,
            "gain_per_cost": self.gain / self.cost,
            "expected_probability": self.right,
            "named_share": self.named,
            "between": list(self.between),
            "pair_probability": self.pair_probability,
        }


@dataclass(frozen=True, eq=False)
class PlanData(Brief):
    """A plan of the next runs and sensors.

    Parameters
    ----------
    study : name of the study. beliefs : the sets before the plan. steps : of the plan, the best first.
    drives, places : all that were compared. compared : experiments compared for the first step. notes : sentences.
    runs_left : further runs that the plan may have, but that are not expected to tell more.
    """

    study: str
    beliefs: Beliefs
    steps: tuple[PlanStep, ...]
    drives: tuple[CandidateDrive, ...]
    places: tuple[CandidatePlace, ...]
    compared: tuple[ExperimentChoice, ...] = ()
    notes: tuple[str, ...] = ()
    seconds: float = 0.0
    runs_left: int = 0

    def _title(self) -> str:
        return f"of {self.study}: {counted(len(self.steps), 'step')}"

    def _facts(self) -> Mapping[str, Any]:
        sets = [f"{entry.key} ({percent(entry.probability)})" for entry in self.beliefs.sets[:3]]
        steps = {
            f"step {step.number}": f"{step.kind}: {step.drive.name if step.drive else step.place and step.place.name}, "
            f"gain {step.gain:.2f} nats, cost {step.cost:.3g}"
            for step in self.steps
        }
        return {"most probable": ", ".join(sets), **steps}

    @property
    def doubt(self) -> float:
        """Entropy of the sets before the plan, nats: the most that any experiment can tell."""
        from tyrefem.plan.information import entropy

        return entropy(self.beliefs.probabilities)

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per step; a column for each quantity of the drive."""
        import pandas as pd

        rows = []
        for step in self.steps:
            row = step.to_dict()
            changes = row.pop("changes") or {}
            row["between"] = " | ".join(row["between"])
            rows.append(row | changes)
        columns = [*_COLUMNS, *dict.fromkeys(key for drive in self.drives for key in _keys(drive))]
        return pd.DataFrame(rows, columns=columns)

    @cached_property
    def candidates(self) -> pd.DataFrame:
        """The experiments that were compared for the first step, the best per cost first."""
        import pandas as pd

        words = {place.name: place.words for place in self.places}
        rows = [
            {
                "drive": None if entry.drive is None else self.drives[entry.drive].name,
                "sensor": entry.sensor,
                "place": None if entry.sensor is None else words[entry.sensor],
                "cost": entry.cost,
                "gain_nats": entry.gain,
                "gain_sd_nats": entry.information.sd,
                "gain_per_cost": entry.per_cost,
                "expected_probability": entry.information.right,
            }
            for entry in sorted(self.compared, key=lambda entry: -entry.per_cost)
        ]
        names = ("drive", "sensor", "place", "cost", "gain_nats", "gain_sd_nats", "gain_per_cost")
        return pd.DataFrame(rows, columns=[*names, "expected_probability"])


_COLUMNS = (
    "step", "kind", "run", "drive", "duration_s", "sensor", "place", "cost", "total_cost", "gain_nats",
    "total_gain_nats", "total_gain_sd_nats", "gain_per_cost", "expected_probability", "named_share", "between",
    "pair_probability",
)  # fmt: skip


def _keys(drive: CandidateDrive) -> list[str]:
    return [f"drive.{key}" for key in drive.changes]
