"""Identifiability before any data: which effects the sensors and runs can distinguish, and from what amplitude."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.evaluations import ProgressStore
from tyrefem.diagnose.forward.worker_queues import Workers
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.inference.set_evidences import SetEvidences
from tyrefem.diagnose.layout.planned_runs import NEEDS, candidates_of, layout_notes, planned_sensitivities
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, SetPrior
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.quantity import convert

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
#: Lead m (nats, without noise) of the true set over every other set. With it, noise brings the probability of the true
#: set below 90 % in one case of twenty: m - 1.645 sqrt(2 m) > ln 9.
MARGIN = 9.3
#: Largest number of sets of runs that are tried for the fewest runs: some minutes.
MOST_SETS = 5000


@dataclass(frozen=True, eq=False)
class Isolability:
    """Effects that a layout of sensors and runs can identify.

    Parameters
    ----------
    study : name of the study. candidates : the n effects.
    smallest : (n,) amplitude, in the effect's unit, from which the effect is distinguished from all others; infinite
        if no amplitude within its bounds is enough. seen : the same for the effect against no effect.
    scale : (n,) prior sd of the amplitude. competitors : (n,) the set that needs the largest amplitude to rule out.
    separation : (n, n) nats by which effect i at its scale is ahead of effect j fitted to the same data.
    runs : smallest sufficient sets of runs. notes : sentences on sensors and runs that the study lacks.
    plugins : the user's own effects and laws that take part, as in a ``summary.json``.
    """

    study: str
    candidates: tuple[Candidate, ...]
    smallest: Array
    seen: Array
    scale: Array
    competitors: tuple[str, ...]
    separation: Array
    runs: tuple[tuple[str, ...], ...]
    weights: Array
    notes: tuple[str, ...] = ()
    plugins: tuple[dict[str, str], ...] = ()

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per effect: amplitudes from which it is seen, and distinguished from all other effects."""
        import pandas as pd

        units = [candidate.unknowns[0].unit for candidate in self.candidates]
        return pd.DataFrame(
            {
                "effect": [candidate.key for candidate in self.candidates],
                "unit": units,
                "usual": self.scale,
                "seen_from": self.seen,
                "told_from": self.smallest,
                "last_rival": self.competitors,
                "identifiable_at_usual": self.smallest <= self.scale * (1 + 1e-9),
            }
        )

    def _as_written(self) -> pd.DataFrame:
        """The table with amplitudes in the units of study files: mm, kPa/min, delta_degC/hour."""
        table = self.table.copy()
        for row, candidate in enumerate(self.candidates):
            parameter = candidate.unknowns[0].parameter
            unit = parameter.prior.written if parameter else None
            if parameter is None or unit is None:
                continue
            table.loc[row, "unit"] = unit
            for column in ("usual", "seen_from", "told_from"):
                value = float(self.table[column].iloc[row])
                table.loc[row, column] = convert(value, parameter.prior.unit, unit) if math.isfinite(value) else value
        return table

    @cached_property
    def groups(self) -> tuple[tuple[str, ...], ...]:
        """Groups of effects that are not distinguished at their usual amplitude, connected by pairs."""
        n = len(self.candidates)
        close = (self.separation < MARGIN) & (self.separation.T < MARGIN)
        left, groups = set(range(n)), []
        while left:
            group, queue = set(), [min(left)]
            while queue:
                i = queue.pop()
                if i in group:
                    continue
                group.add(i)
                queue += [j for j in left if close[i, j] and j not in group]
            left -= group
            groups.append(tuple(self.candidates[i].key for i in sorted(group)))
        return tuple(sorted(groups, key=len, reverse=True))

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "study": self.study,
            "margin_nats": MARGIN,
            "effects": self.table.to_dict(orient="records"),
            "groups": [list(group) for group in self.groups],
            "fewest_runs": [list(runs) for runs in self.runs],
            "apart_nats": self.separation.round(2).tolist(),
            "notes": list(self.notes),
            "plugins": list(self.plugins),
        }

    def words(self) -> list[str]:
        """The results as lines of text: table, effects that are not seen, groups, fewest runs, notes."""
        table = self.table
        shown = self._as_written()[["effect", "unit", "usual", "seen_from", "told_from", "last_rival"]]
        can = int(table["identifiable_at_usual"].sum())
        at = "is identifiable at its" if can == 1 else "are identifiable at their"
        lines = [shown.to_string(index=False, float_format="%.3g")]
        lines.append(f"{can} of {len(table)} effects {at} usual amplitude.")
        never = table.loc[~np.isfinite(table["seen_from"]), "effect"]
        if len(never):
            lines.append("Not seen by these sensors and runs at any amplitude: " + ", ".join(never) + ".")
        together = [", ".join(group) for group in self.groups if len(group) > 1]
        lines += [f"Not distinguished, or not seen, at the usual amplitude: {names}." for names in together]
        if self.runs:
            sets = "; ".join(" + ".join(runs) for runs in self.runs)
            lines.append(f"Fewest runs that identify the same effects: {sets}.")
        return [*lines, *self.notes]


def margins(
    linear: LinearModel, signal: Array, true: Members, competitors: Sequence[Members], prior: SetPrior
) -> list[float]:
    """Lead (nats) of the set ``true`` over each competitor for the data ``signal``, without noise."""
    given = linear.with_data(signal)
    of_true = prior(true) + given.log_evidence(true)
    return [of_true - prior(members) - given.log_evidence(members) for members in competitors]


def competitors_of(true: Members, candidates: Sequence[Candidate]) -> list[Members]:
    """The sets that compete with the true set: no effect, every other single effect, every subset of the true set."""
    sets: list[Members] = [()]
    sets += [(candidate,) for candidate in candidates if candidate not in true]
    for size in range(1, len(true)):
        sets += list(itertools.combinations(true, size))
    return sets


def isolability(
    study: StudyData,
    *,
    workers: Workers = 1,
    progress: Callable[[str, int, int], None] | None = None,
    known: Sensitivities | None = None,
    store: ProgressStore | None = None,
) -> Isolability:
    """Effects that the sensors and runs of a study can distinguish, by the linear model about x = 0.

    ``known``: sensitivities of the planned runs, if they are available. ``store``: keeps finished simulations for the
    next call after an interruption.

    Raises
    ------
    InputError : a campaign; every run held out; every effect excluded; a drive that is impossible for the tyre.
    """
    NEEDS.check(study)
    candidates = candidates_of(study)
    if known is None:
        known = planned_sensitivities(study, workers=workers, progress=progress, store=store)
    prior = SetPrior(candidates, study.card.diagnosis.effects_expected)
    design = known.design(known.fitted)
    singles = _SingleEffects(design, candidates, prior)
    n = len(candidates)
    smallest, seen, last = np.full(n, np.inf), np.full(n, np.inf), [""] * n
    separation = np.zeros((n, n))
    for i, candidate in enumerate(candidates):
        separation[i] = singles.leads(i, 1.0)[1:]
        smallest[i], last[i] = singles.threshold(i)
        seen[i], _ = _SingleEffects(design, (candidate,), prior).threshold(0)
        if progress is not None:
            progress("effects", i + 1, n)
    runs, untried = fewest_runs(known, candidates, prior, smallest)
    scale = np.array([abs(_usual_amplitude(each.amplitudes[0])) if each.amplitudes else 1.0 for each in candidates])
    shares = np.array([1 / sum(other.name == candidate.name for other in candidates) for candidate in candidates])
    return Isolability(
        study.name,
        candidates,
        smallest * scale,
        seen * scale,
        scale,
        tuple(last),
        separation,
        runs,
        shares,
        (*layout_notes(study), *untried),
        tuple(plugin_summary(study, [candidate.name for candidate in candidates])["plugins"]),
    )


def _usual_amplitude(unknown: Unknown) -> float:
    """x at one prior standard deviation, or at a nearer bound; on the side of positive values if they are allowed."""
    return min(unknown.sd, unknown.high) if unknown.high > 0 else max(-unknown.sd, unknown.low)


class _SingleEffects:
    """Every single effect at some amplitude, and its lead over no effect and every other single effect."""

    def __init__(self, design: DesignMatrix, candidates: Sequence[Candidate], prior: SetPrior) -> None:
        self._design, self._candidates = design, candidates
        sets: list[Members] = [(), *((candidate,) for candidate in candidates)]
        self._evidences = SetEvidences(design, sets)
        self._log_prior = np.array([prior(members) for members in sets])
        self._overlaps = np.array([design.gram @ self._usual(candidate) for candidate in candidates])

    def _usual(self, candidate: Candidate) -> Array:
        """(k,) unknowns of an effect at its usual amplitude: all amplitudes at one prior sd, on the allowed side."""
        values = np.zeros(len(self._design.unknowns))
        values[self._design.columns(candidate.presence)] = 1.0
        for unknown in candidate.amplitudes:
            values[self._design.place[unknown]] = _usual_amplitude(unknown)
        return values

    def leads(self, number: int, amplitude: float) -> Array:
        """(1 + n,) lead (nats) over no effect and over every single effect, for readings without noise.

        ``amplitude``: in usual amplitudes.
        """
        scores = self._log_prior + self._evidences.log_evidence(amplitude * self._overlaps[number])
        return np.asarray(scores[1 + number] - scores)

    def _closest(self, number: int, amplitude: float) -> tuple[int, float]:
        """The competitor with the smallest lead (0: no effect), and the lead."""
        ahead = self.leads(number, amplitude)
        ahead[1 + number] = np.inf
        closest = int(np.argmin(ahead))
        return closest, float(ahead[closest])

    def is_ahead(self, number: int, amplitude: float) -> bool:
        """Whether the effect leads over all competitors by the margin."""
        return self._closest(number, amplitude)[1] >= MARGIN

    def threshold(self, number: int) -> tuple[float, str]:
        """Amplitude (prior sd) from which the effect is ahead of all competitors, and the last competitor ruled out."""
        candidate = self._candidates[number]
        names = ["no effect", *(each.key for each in self._candidates)]
        if not candidate.amplitudes:
            closest, lead = self._closest(number, 1.0)
            return 1.0 if lead >= MARGIN else math.inf, names[closest]
        unknown = candidate.amplitudes[0]
        bound = unknown.high if unknown.high > 0 else -unknown.low
        largest = min(bound / abs(_usual_amplitude(unknown)), 20.0)
        values = np.geomspace(0.02, largest, 40) if largest > 0.02 else np.array([largest])

        def remaining(value: float) -> str | None:
            """The competitor that is not ruled out, or the closest of them; None if all are."""
            closest, lead = self._closest(number, value)
            return None if lead >= MARGIN else names[closest]

        # A lead grows with the square of the amplitude, so bisection finds where it reaches the margin.
        first, competitor = bisect_left(values, True, key=lambda value: remaining(value) is None), ""
        if first > 0:
            competitor = remaining(values[first - 1]) or ""
        return (float(values[first]) if first < len(values) else math.inf), competitor


def fewest_runs(
    known: Sensitivities, candidates: Sequence[Candidate], prior: SetPrior, smallest: Array
) -> tuple[tuple[tuple[str, ...], ...], tuple[str, ...]]:
    """The smallest sets of fitted runs that identify the same effects as all runs, at twice their usual amplitude.

    And a note, if some sizes were not tried because there are more than `MOST_SETS` sets.
    """
    names = [drive.name for drive in known.drives]
    # The effect that is hardest to identify fails first.
    wanted = sorted((i for i in range(len(candidates)) if smallest[i] <= 2.0), key=lambda i: -smallest[i])
    if not wanted:
        return (), ()
    tried = 0
    for size in range(1, len(known.fitted) + 1):
        enough = []
        tried += math.comb(len(known.fitted), size)
        if tried > MOST_SETS:
            runs = f"{size} and more of the {len(known.fitted)} fitted runs"
            return (), (f"The fewest runs are not known: there are too many sets of {runs}.",)
        for chosen in itertools.combinations(known.fitted, size):
            singles = _SingleEffects(known.design(chosen), candidates, prior)
            ok = all(singles.is_ahead(i, 2.0) for i in wanted)
            if ok:
                enough.append(tuple(names[i] for i in chosen))
        if enough:
            return tuple(enough), ()
    return (), ()
