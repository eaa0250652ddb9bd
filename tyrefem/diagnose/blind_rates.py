"""Many blind cases in parallel, kept on disk, and the rates at which the diagnosis is right."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import tyrefem
from tyrefem.diagnose.blind import BlindOutcome, cases, run_case
from tyrefem.diagnose.effort import CASE, SENSITIVITIES, check_effort
from tyrefem.diagnose.evaluations import ProgressStore, evaluating
from tyrefem.diagnose.forward_model import DriveResponse, ForwardModel
from tyrefem.diagnose.isolability import candidates_of, layout_notes, planned
from tyrefem.diagnose.sensitivities import responses, unknowns_of
from tyrefem.diagnose.synthetic import synthetic_mesh
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.interruption import interruption_delayed, keeping
from tyrefem.output import atomic_path, jsonable
from tyrefem.processes import processes
from tyrefem.requirements import Requirements
from tyrefem.simulation.surroundings import GAS
from tyrefem.variants.answer_store import PROGRESS

Row = dict[str, Any]
#: What a study must have for a blind test.
NEEDS = Requirements("a blind test", fitted=True)
#: The place of an uncatalogued cause counts as right within this share of the half meridian.
NEAR = 1.5 / 7
#: Amplitude, in prior standard deviations, from which an effect counts as strong.
STRONG = 1.0
BINS = (0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)


@dataclass(frozen=True)
class Rate:
    """``right`` of ``of`` cases, with a 95 % Wilson interval.

    >>> rate = Rate(19, 20)
    >>> round(rate.value, 2), [round(x, 2) for x in rate.interval]
    (0.95, [0.76, 0.99])
    """

    right: int
    of: int

    @property
    def value(self) -> float:
        """Share of right cases; NaN without cases."""
        return self.right / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval (Wilson 1927)."""
        if not self.of:
            return 0.0, 1.0
        n, p, z = self.of, self.value, 1.96
        middle = (p + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return max(middle - half, 0.0), min(middle + half, 1.0)

    def to_dict(self) -> Row:
        """Plain data."""
        low, high = self.interval
        return {"right": self.right, "of": self.of, "rate": self.value, "low": low, "high": high}


@dataclass(frozen=True, eq=False)
class Blind:
    """Finished cases of a blind test and their rates.

    ``notes``: sentences on sensors and runs that the study lacks. ``mesh``: mesh of the synthetic data.
    """

    study: str
    seed: int
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()
    mesh: Mapping[str, Any] = field(default_factory=dict)

    def _of(self, kind: str) -> list[Row]:
        return [row for row in self.rows if row["kind"] == kind]

    @cached_property
    def rates(self) -> dict[str, Rate]:
        """Criterion -> rate of the cases that fulfil it."""
        single, two, none, outside = (self._of(kind) for kind in ("one", "two", "none", "outside"))
        identifiable = [row for row in single if row["identifiable"]]
        identifiable_pairs = [row for row in two if row["identifiable"]]
        named = [row for row in self.rows if row["verdict"] == "identified"]
        strong = [row for row in identifiable if min(map(abs, row["amplitude"].values()), default=1.0) >= STRONG]
        right = [row for row in identifiable if _right(row)]
        return {
            "one effect: identifiable": _rate(single, lambda row: row["identifiable"]),
            "identifiable: named correctly": _rate(identifiable, _right),
            "identifiable: true effect in the reported set": _rate(
                identifiable, lambda row: set(row["hidden"]) <= set(row["set"])
            ),
            "one effect: wrong name": _rate(single, _wrong),
            "no effect: no gap": _rate(none, lambda row: row["verdict"] == "no gap"),
            "outside the catalogue: confident wrong name": _rate(outside, lambda row: row["verdict"] == "identified"),
            "outside the catalogue: unexplained": _rate(outside, lambda row: row["verdict"] == "unexplained"),
            "outside the catalogue, unexplained: place right": _rate(
                [row for row in outside if row["verdict"] == "unexplained"],
                lambda row: abs(row["missing_station_m"] - row["station_m"]) <= NEAR * row["length_m"],
            ),
            "two effects: both named": _rate(two, _right),
            "two identifiable effects: both named": _rate(identifiable_pairs, _right),
            "named rightly: held-out rms at most 1.2 times the noise": _rate(
                [row for row in right if _held_out(row)],
                lambda row: row["held_out_rms_K"]["after"] <= 1.2 * row["noise_K"],
            ),
            "strong and identifiable: held-out gap shrunk 3 times": _rate(
                [row for row in strong if _held_out(row) and row["held_out_rms_K"]["before"] > 3 * row["noise_K"]],
                _shrunk,
            ),
            "verdicts 'identified': right": _rate(named, _right),
        }

    @cached_property
    def reliability(self) -> list[Row]:
        """Stated probability and observed share of right names, for verdicts "identified", by bins of probability."""
        rates = []
        for low, high in pairwise(BINS):
            identified = [
                row
                for row in self.rows
                if row["verdict"] == "identified" and low < min(row["probability"], 1.0) <= high
            ]
            if identified:
                mean = sum(row["probability"] for row in identified) / len(identified)
                held = _rate(identified, lambda row: bool(row["hidden"]) and set(row["named"]) <= set(row["hidden"]))
                rates.append({"stated": mean, **held.to_dict()})
        return rates

    @cached_property
    def by_effect(self) -> list[Row]:
        """One row per effect (all variants): cases, identifiable, named, and the results of the missed cases."""
        effects: dict[str, Row] = {}
        for row in self._of("one"):
            name = row["hidden"][0].split(" (")[0]
            counts = effects.setdefault(name, {"effect": name, "cases": 0, "identifiable": 0, "named": 0, "else": []})
            counts["cases"] += 1
            counts["identifiable"] += bool(row["identifiable"])
            counts["named"] += _right(row)
            if row["identifiable"] and not _right(row):
                counts["else"].append(f"{row['verdict']}: {row['best']}")
        return sorted(effects.values(), key=lambda row: row["effect"])

    def to_dict(self) -> Row:
        """Contents of ``blind.json``."""
        return {
            "study": self.study,
            "seed": self.seed,
            "mesh_of_the_truth": dict(self.mesh) or synthetic_mesh(),
            "cases": list(self.rows),
            "rates": {name: rate.to_dict() for name, rate in self.rates.items()},
            "reliability": self.reliability,
            "by_effect": self.by_effect,
            "notes": list(self.notes),
        }

    def words(self) -> list[str]:
        """The rates as lines of text, then the notes."""
        lines = []
        for name, rate in self.rates.items():
            low, high = rate.interval
            share = f"{100 * rate.value:5.1f} % ({100 * low:.0f} to {100 * high:.0f})" if rate.of else "    -"
            lines.append(f"{name:60s} {rate.right:4d} of {rate.of:4d}  {share}")
        return [*lines, *self.notes]


def _rate(rows: Sequence[Row], holds: Callable[[Row], bool]) -> Rate:
    return Rate(sum(1 for row in rows if holds(row)), len(rows))


def _right(row: Row) -> bool:
    return row["verdict"] == "identified" and set(row["named"]) == set(row["hidden"])


def _held_out(row: Row) -> bool:
    """Whether any run is held out; without one the root mean square is null."""
    return row["held_out_rms_K"]["before"] is not None


def _wrong(row: Row) -> bool:
    return row["verdict"] == "identified" and not set(row["named"]) & set(row["hidden"])


def _shrunk(row: Row) -> bool:
    """Whether the gap beyond noise on held-out runs becomes at least three times smaller."""
    noise = row["noise_K"]
    before, after = (max(row["held_out_rms_K"][when] ** 2 - noise**2, 0.0) ** 0.5 for when in ("before", "after"))
    return bool(before >= 3 * after)


#: The row of a case whose diagnosis fails.
FAILED: Row = {
    "verdict": "failed", "named": [], "set": [], "best": "", "probability": 0.0, "missing_station_m": math.nan,
    "rms_K": {}, "held_out_rms_K": {"before": 0.0, "after": math.inf}, "noise_K": 0.0,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class BlindTest:
    """The inputs that all cases share: study, number of cases, seed, responses, ``reduced`` and the data's mesh."""

    study: StudyData
    count: int
    seed: int
    known: tuple[DriveResponse, ...]
    reduced: str
    mesh: Mapping[str, Any]


#: The blind test of a worker process.
_TEST: list[BlindTest] = []


def _install(test: BlindTest) -> None:
    _TEST[:] = [test]


def _case_in_worker(number: int) -> Row:
    return _case(_TEST[0], number)


def _case(test: BlindTest, number: int) -> Row:
    study = test.study
    case = cases(study, test.count, test.seed)[number]
    try:
        row = run_case(study, case, test.known, test.reduced, test.mesh).to_dict()
    except InputError as error:
        # A diagnosis that fails counts as wrong.
        row = {**BlindOutcome(case, identifiable=True).to_dict(), **FAILED, "reason": str(error)}
    plain: Row = jsonable({**row, "station_m": case.station, "length_m": study.section.line.length})
    return plain


def run_blind(
    study: StudyData,
    count: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    tick: Callable[[int], None] | None = None,
    *,
    reduced: str = "auto",
    mesh: Mapping[str, Any] | None = None,
) -> Blind:
    """Run blind cases in parallel; finished cases are kept in ``folder``/cases.

    Cases in the folder with the same study, count, seed, ``reduced``, ``mesh`` and version are not run again.
    ``reduced``: see `tyrefem.diagnose.diagnose`; all cases share the modes of the reduced models. ``mesh``: mesh of
    the synthetic data, as changes of a study by dotted names; default: `synthetic_mesh`.

    Raises
    ------
    InputError : as `isolability`.
    """
    NEEDS.check(study)
    candidates = candidates_of(study)
    drives = planned(study)
    mesh = synthetic_mesh() if mesh is None else mesh
    decisive = [jsonable(dict(study.data)), count, seed, reduced, dict(mesh), tyrefem.__version__]
    text = json.dumps(decisive, sort_keys=True, default=str)
    tag = hashlib.sha256(text.encode()).hexdigest()[:12]
    store = folder / "cases"
    store.mkdir(parents=True, exist_ok=True)
    rows: dict[int, Row] = {}
    for path in store.glob(f"{tag}-*.json"):
        rows[int(path.stem.split("-")[1])] = json.loads(path.read_text(encoding="utf-8"))
    left = [number for number in range(count) if number not in rows]
    # The shared responses are kept until all cases are finished.
    progress = ProgressStore(folder / PROGRESS)

    def kept() -> str:
        return f"{len(rows)} of {count} cases are finished; the same command resumes from there"

    with keeping(kept):
        if left:
            model = ForwardModel(study, drives)
            check_effort(model, f"{len(left):,} blind cases", SENSITIVITIES + len(left) * CASE, workers)
            progress.open(model)
            with evaluating(model, workers, progress) as evaluations:
                unknowns, _ = unknowns_of(study, [*study.sensors, GAS], candidates)
                known = responses(evaluations, unknowns)
            test = BlindTest(study, count, seed, known, reduced, mesh)
            for number, row in _answers(test, left, workers):
                rows[number] = row
                with interruption_delayed(), atomic_path(store / f"{tag}-{number:05d}.json") as temporary:
                    temporary.write_text(json.dumps(row), encoding="utf-8")
                if tick:
                    tick(len(rows))
        notes = layout_notes(study)
        if not any(drive.hold_out for drive in drives):
            notes += ("No run is held out, so the rates do not cover runs that were not fitted.",)
    progress.clear()
    return Blind(study.name, seed, tuple(rows[number] for number in sorted(rows)), notes, mesh)


def _answers(test: BlindTest, numbers: Sequence[int], workers: int) -> Iterable[tuple[int, Row]]:
    if workers <= 1:
        for number in numbers:
            yield number, _case(test, number)
        return
    with processes(workers, _install, test) as pool:
        futures = {pool.submit(_case_in_worker, number): number for number in numbers}
        for future in as_completed(futures):
            yield futures[future], future.result()
