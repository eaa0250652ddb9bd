"""The batch of next runs and sensors: chosen one by one, each by its gain per cost beside those chosen before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from tyrefem.brief import Brief
from tyrefem.inputs.plan_choice import PlanChoice
from tyrefem.plan.drives import CandidateDrive
from tyrefem.plan.information import Information, information
from tyrefem.plan.places import CandidatePlace
from tyrefem.plan.readings import PlannedReadings

#: Samples of an experiment while many are compared, and of the few best; at least `LEAST_DRAWS` of every set.
SAMPLES, FINAL_SAMPLES, LEAST_DRAWS = 1000, 4000, 8
#: Number of the best experiments that are compared with the larger sample.
FINALISTS = 4
#: The plan ends where nothing adds more than this, nats.
LEAST_GAIN = 0.05


@dataclass(frozen=True)
class Experiments:
    """Numbers of the drives of the planned runs, and names of the added sensors."""

    drives: tuple[int, ...] = ()
    sensors: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ExperimentChoice(Brief):
    """An experiment that may be the next one: a run, a further sensor in all planned runs, or a run with a sensor.

    ``batch``: all planned runs and sensors with this one. ``cost``: of this one. ``gain``: expected further
    information about the set, nats. ``information``: of the whole batch.
    """

    drive: int | None
    sensor: str | None
    batch: Experiments
    cost: float
    gain: float
    information: Information

    @property
    def per_cost(self) -> float:
        """Gain per cost, nats."""
        return self.gain / self.cost


@dataclass(frozen=True, eq=False)
class Search(Brief):
    """The chosen experiments in their order, and all that were compared for the first step."""

    chosen: tuple[ExperimentChoice, ...]
    compared: tuple[ExperimentChoice, ...] = field(default=())


@dataclass(frozen=True, eq=False)
class _Comparison:
    """Gains of experiments beside a batch."""

    readings: PlannedReadings
    drives: Sequence[CandidateDrive]
    choice: PlanChoice
    tick: Callable[[], None]

    def of(
        self, before: Experiments, known: float, drive: int | None, sensor: str | None, samples: int
    ) -> ExperimentChoice:
        """One experiment; ``known``: expected information of the batch before it."""
        drives = before.drives if drive is None else (*before.drives, drive)
        sensors = before.sensors if sensor is None else (*before.sensors, sensor)
        cost = (0.0 if drive is None else self.drives[drive].cost) + (
            0.0 if sensor is None else self.choice.sensor_cost
        )
        result = self.information(Experiments(drives, sensors), samples)
        self.tick()
        return ExperimentChoice(drive, sensor, Experiments(drives, sensors), cost, result.gain - known, result)

    def information(self, batch: Experiments, samples: int) -> Information:
        """Expected information of a batch."""
        draws = max(samples // len(self.readings.beliefs.sets), LEAST_DRAWS)
        return information(self.readings.expected(batch.drives, batch.sensors), draws)


def greedy_batch(
    readings: PlannedReadings,
    drives: Sequence[CandidateDrive],
    places: Sequence[CandidatePlace],
    choice: PlanChoice,
    progress: Callable[[str, int, int], None] | None = None,
) -> Search:
    """Choose runs and sensors one by one by their gain per cost, up to ``runs_most`` and ``sensors_most``.

    Information of several experiments together is at most the sum of their own, so that a greedy batch has at least
    63 % of the best one's where the gain is submodular (Nemhauser et al., Mathematical Programming 14 (1978) 265-294).
    """
    done = 0

    def tick() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress("comparing experiments", done, 0)

    comparison = _Comparison(readings, drives, choice, tick)
    batch, chosen, compared = Experiments(), list[ExperimentChoice](), tuple[ExperimentChoice, ...]()
    while len(readings.beliefs.sets) > 1:
        entries = _options(comparison, batch, places)
        compared = compared or tuple(entries)
        if not entries:
            break
        # A cheap experiment that tells nearly nothing must not end the plan before a dear one that tells much.
        telling = [entry for entry in entries if entry.gain + 2 * entry.information.sd >= LEAST_GAIN]
        finalists = sorted(telling, key=lambda entry: -entry.per_cost)[:FINALISTS]
        known = comparison.information(batch, FINAL_SAMPLES).gain if batch.drives else 0.0
        finals = [comparison.of(batch, known, entry.drive, entry.sensor, FINAL_SAMPLES) for entry in finalists]
        finals = [entry for entry in finals if entry.gain >= max(LEAST_GAIN, entry.information.sd)]
        if not finals:
            break
        best = max(finals, key=lambda entry: entry.per_cost)
        chosen.append(best)
        batch = best.batch
    return Search(tuple(chosen), compared)


def _options(comparison: _Comparison, batch: Experiments, places: Sequence[CandidatePlace]) -> list[ExperimentChoice]:
    """All runs; the best of them with each further sensor; each further sensor in the runs that are planned already."""
    choice = comparison.choice
    known = comparison.information(batch, SAMPLES).gain if batch.drives else 0.0
    sensors = [place.name for place in places if place.name not in batch.sensors]
    if len(batch.sensors) >= choice.sensors_most:
        sensors = []
    entries: list[ExperimentChoice] = []
    if batch.drives:
        entries += [comparison.of(batch, known, None, sensor, SAMPLES) for sensor in sensors]
    if len(batch.drives) < choice.runs_most:
        runs = [comparison.of(batch, known, drive, None, SAMPLES) for drive in range(len(comparison.drives))]
        best = max(runs, key=lambda entry: entry.per_cost).drive
        entries += runs
        entries += [comparison.of(batch, known, best, sensor, SAMPLES) for sensor in sensors]
    return entries
