"""Conformal sets: the sets of effects that hold the true one in 95 % of the cases of a layout."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem.brief import Brief, counted
from tyrefem.diagnose.verdicts.verdict import RankedSet
from tyrefem.errors import InputError

#: Wanted share of conformal sets that hold the true set.
COVERAGE = 0.95
#: File of a calibration in the folder of `tyrefem isolability --calibrate`.
CALIBRATION = "calibration.json"
#: Groups of cases with a threshold each: what the most probable set is.
LEADS = {True: "an effect leads", False: "no effect leads"}
#: Largest number of sets in a sentence; small numbers in words.
MOST = 6
COUNTS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six"}


def conformal_threshold(before: Sequence[float], coverage: float = COVERAGE) -> float:
    """The threshold q of split conformal prediction: the ceil((n + 1) coverage)-th smallest of n scores.

    Score of a case: posterior probability of all sets that are more probable than the true one. Of a new case, the sets
    with a score of at most q hold the true one with at least this probability, if the cases are exchangeable. 1 (all
    sets) if there are too few cases. Source: Vovk, Gammerman & Shafer, Algorithmic Learning in a Random World, 2005.

    >>> conformal_threshold([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8], 0.9), conformal_threshold([0.1], 0.9)
    (0.8, 1.0)
    """
    rank = math.ceil((len(before) + 1) * coverage - 1e-9)
    return float(np.sort(before)[rank - 1]) if rank <= len(before) else 1.0


def conformal_sets(ranking: Sequence[RankedSet], threshold: float) -> tuple[RankedSet, ...]:
    """The most probable sets, until the probability of the sets before is more than the threshold."""
    chosen: list[RankedSet] = []
    before = 0.0
    for entry in sorted(ranking, key=lambda each: -each.score):
        if before > threshold or (chosen and entry.probability == 0.0):
            break
        chosen.append(entry)
        before += entry.probability
    return tuple(chosen)


@dataclass(frozen=True)
class ConformalCalibration(Brief):
    """Thresholds of a layout, with their check on fresh cases.

    Parameters
    ----------
    study, sensors, runs : the layout. coverage : wanted share. thresholds : "an effect leads" and "no effect leads" ->
        threshold. checks : group -> ``held`` of ``of`` fresh cases whose conformal set holds the true set.
    """

    study: str
    sensors: tuple[str, ...]
    runs: tuple[str, ...]
    coverage: float
    thresholds: Mapping[str, float]
    checks: Mapping[str, Mapping[str, float]]

    def of(self, ranking: Sequence[RankedSet]) -> tuple[RankedSet, ...]:
        """The conformal set of a diagnosis on this layout."""
        best = max(ranking, key=lambda entry: entry.score)
        return conformal_sets(ranking, self.thresholds[LEADS[bool(best.members) or best.outside]])

    def in_all(self, ranking: Sequence[RankedSet]) -> tuple[str, ...]:
        """Keys of the effects that every set of the conformal set has."""
        first, *others = [{member.key for member in entry.members} for entry in self.of(ranking)]
        return tuple(sorted(first.intersection(*others)))

    def to_dict(self, ranking: Sequence[RankedSet]) -> dict[str, Any]:
        """The conformal set of a diagnosis as plain data, with the check of its coverage."""
        best = max(ranking, key=lambda entry: entry.score)
        group = LEADS[bool(best.members) or best.outside]
        return {
            "sentence": self.words(ranking),
            "sets": [entry.key for entry in self.of(ranking)],
            "effects_in_all": list(self.in_all(ranking)),
            "coverage_wanted": self.coverage,
            "threshold": self.thresholds[group],
            "fresh_cases": dict(self.checks[group]),
        }

    def words(self, ranking: Sequence[RankedSet]) -> str:
        """The conformal set as a sentence, with the checked coverage."""
        best, sets = max(ranking, key=lambda entry: entry.score), self.of(ranking)
        check = self.checks[LEADS[bool(best.members) or best.outside]]
        names = "; ".join(entry.key for entry in sets[:MOST])
        more = f"; and {len(sets) - MOST} more" if len(sets) > MOST else ""
        first = "It is this set" if len(sets) == 1 else f"It is one of these {COUNTS.get(len(sets), len(sets))} sets"
        held = f"{check['held']:.0f} of {check['of']:.0f} fresh cases"
        common = self.in_all(ranking) if len(sets) > 1 else ()
        all_have = f" All of them have {' and '.join(common)}." if common else ""
        wanted = f"{100 * self.coverage:g} % wanted; such sets held the true one in {held}"
        return f"{first}: {names}{more} ({wanted}).{all_have}"


def read_calibration(path: Path, study: str, sensors: Sequence[str], runs: Sequence[str]) -> ConformalCalibration:
    """The conformal thresholds of a ``calibration.json``, or of the folder that holds it.

    Raises
    ------
    InputError : there is no such file, it is no calibration, or it belongs to another layout.
    """
    file = path / CALIBRATION if path.is_dir() else path
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
        layout, conformal = record["layout"], record["conformal"]
        known = ConformalCalibration(
            record["study"],
            tuple(layout["sensors"]),
            tuple(layout["runs"]),
            float(conformal["coverage_wanted"]),
            {name: float(conformal["thresholds"][name]) for name in LEADS.values()},
            {name: dict(conformal["fresh_cases"][name]) for name in LEADS.values()},
        )
    except FileNotFoundError:
        message = f"there is no {CALIBRATION}; tyrefem isolability STUDY --calibrate 1000 writes it"
        raise InputError(message, file=file) from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        message = "is no calibration; tyrefem isolability STUDY --calibrate 1000 writes one"
        raise InputError(message, file=file) from None
    if sorted(known.sensors) != sorted(sensors):
        message = f"belongs to another layout: its sensors are {', '.join(known.sensors)}; those of {study} are"
        raise InputError(f"{message} {', '.join(sensors)}", file=file)
    if len(known.runs) != len(runs):
        message = f"belongs to another layout: it has {counted(len(known.runs), 'run')}, {study} has {len(runs)}"
        raise InputError(message, file=file)
    return known
