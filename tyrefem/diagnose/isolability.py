"""Before any data: which effects a study's sensors and runs can tell apart, and how strong they must be to be seen."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.experiment import OUTSIDE_THE_RUBBER
from tyrefem.diagnose.candidates import Candidate, Members, SetPrior, catalogue_candidates
from tyrefem.diagnose.effort import SENSITIVITIES, check_effort
from tyrefem.diagnose.evaluations import Evaluations, ProgressStore, evaluating
from tyrefem.diagnose.forward_model import DriveResponse, ForwardModel
from tyrefem.diagnose.linear_model import LinearModel
from tyrefem.diagnose.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.sensitivities import Sensitivities, responses, sensitivities, unknowns_of
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
#: What isolability needs of a study.
NEEDS = Requirements("isolability", fitted=True)
#: Nats by which the true explanation must be ahead of every other without noise, so that noise turns the order round,
#: or leaves it undecided (less than 90 %), in one case of twenty: m - 1.645 sqrt(2 m) > ln 9.
MARGIN = 9.3
#: Readings are supposed this often, s.
EVERY = 10.0


def planned(study: StudyData, sensors: Sequence[str] = ()) -> tuple[DriveSampling, ...]:
    """The runs of a study's ``[[measured]]`` entries (or its own drive) with all its sensors read every 10 s.

    Raises
    ------
    InputError : a drive that is shorter than the time between two readings.
    """
    entries = study.measured
    plans = [(entry.run or f"run {n + 1}", dict(entry.drive), entry.hold_out) for n, entry in enumerate(entries)]
    samplings = []
    for name, drive, hold_out in plans or [("the study's own drive", {}, False)]:
        driven = study.with_drive(drive) if drive else study
        if driven.card.drive.end < EVERY:
            message = f"{name} lasts {driven.card.drive.end:g} s; sensors are supposed to be read every {EVERY:g} s"
            raise InputError(message, field="drive", file=study.file)
        times = np.arange(0.0, driven.card.drive.end + EVERY / 2, EVERY)
        choice = study.card.diagnosis
        names = list(sensors) or [*study.sensors, OUTSIDE_THE_RUBBER[0]]
        sampled = tuple(
            SensorSampling(
                sensor,
                times,
                study.sensors[sensor].noise if sensor in study.sensors else 0.5,
                choice.discrepancy,
                choice.correlation_time,
            )
            for sensor in names
        )
        samplings.append(DriveSampling(name, drive, hold_out, sampled))
    return tuple(samplings)


def layout_notes(study: StudyData) -> tuple[str, ...]:
    """What a study has not, and what `planned` takes instead, in sentences."""
    notes = []
    if not study.sensors:
        notes.append("The study has no [sensors]: the contained air is all that is read.")
    if not study.measured:
        notes.append("The study has no [[measured]] runs: its own drive is the only run.")
    return tuple(notes)


@dataclass(frozen=True, eq=False)
class Isolability:
    """What a layout of sensors and runs can tell.

    Parameters
    ----------
    study : its name. candidates : the effects. smallest : amplitude (own unit) from which each is told from all
        others, infinite if never within its bounds; ``seen`` : from which it is told from no effect.
    scale : prior sd of the amplitude. competitors : the last other explanation to be ruled out.
    apart : (n, n) nats by which effect i at its scale is ahead of effect j fitted to it. runs : smallest sets of runs.
    notes : what the study has not, in sentences.
    """

    study: str
    candidates: tuple[Candidate, ...]
    smallest: Array
    seen: Array
    scale: Array
    competitors: tuple[str, ...]
    apart: Array
    runs: tuple[tuple[str, ...], ...]
    weights: Array
    notes: tuple[str, ...] = ()

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per effect: from what amplitude it is seen, and told from all others."""
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

    @cached_property
    def groups(self) -> tuple[tuple[str, ...], ...]:
        """Effects that are not told apart at their usual strength: connected by pairs that are too close."""
        n = len(self.candidates)
        close = (self.apart < MARGIN) & (self.apart.T < MARGIN)
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
            "apart_nats": self.apart.round(2).tolist(),
            "notes": list(self.notes),
        }

    def words(self) -> list[str]:
        """What an engineer who plans a test wants to know."""
        table = self.table
        shown = table[["effect", "unit", "usual", "seen_from", "told_from", "last_rival"]]
        can = table["identifiable_at_usual"]
        lines = [shown.to_string(index=False, float_format="%.3g")]
        lines.append(f"{int(can.sum())} of {len(table)} effects are identifiable at their usual strength.")
        never = table.loc[~np.isfinite(table["seen_from"]), "effect"]
        if len(never):
            lines.append("These sensors and runs cannot see, at any strength: " + ", ".join(never) + ".")
        together = [", ".join(group) for group in self.groups if len(group) > 1]
        lines += [f"Not told apart, or not seen, at usual strength: {names}." for names in together]
        if self.runs:
            sets = "; ".join(" + ".join(runs) for runs in self.runs)
            lines.append(f"Fewest runs that identify as much: {sets}.")
        return [*lines, *self.notes]


def margins(
    linear: LinearModel, signal: Array, true: Members, competitors: Sequence[Members], prior: SetPrior
) -> list[float]:
    """Nats by which ``true`` is ahead of each competitor for data that are ``signal`` without noise."""
    given = linear.with_data(signal)
    of_true = prior(true) + given.log_evidence(true)
    return [of_true - prior(members) - given.log_evidence(members) for members in competitors]


def competitors_of(true: Members, candidates: Sequence[Candidate]) -> list[Members]:
    """No effect, every other single effect, and every part of the true set; sets that hold it are no competitors."""
    sets: list[Members] = [()]
    sets += [(candidate,) for candidate in candidates if candidate not in true]
    for size in range(1, len(true)):
        sets += list(itertools.combinations(true, size))
    return sets


def candidates_of(study: StudyData) -> tuple[Candidate, ...]:
    """The effects that a study may lack.

    Raises
    ------
    InputError : there is none, so that there is nothing to tell apart.
    """
    candidates = catalogue_candidates(study)
    if not candidates:
        message = "no effect of the catalogue is left that the study may lack: exclude fewer"
        raise InputError(message, field="diagnosis.exclude", file=study.file)
    return candidates


def isolability(
    study: StudyData,
    *,
    workers: int = 1,
    progress: Callable[[str, int, int], None] | None = None,
    known: Sensitivities | None = None,
    store: ProgressStore | None = None,
) -> Isolability:
    """What the sensors and runs of a study can tell apart, by the linear model about the study as it is.

    ``known``: sensitivities of the planned runs, where they are at hand. ``store``: keeps finished simulations, which
    an interrupted call takes up again.

    Raises
    ------
    InputError : a campaign; every run held out; every effect excluded; a run's drive that the tyre cannot take.
    """
    NEEDS.check(study)
    candidates = candidates_of(study)
    if known is None:
        model = ForwardModel(study, planned(study))
        check_effort(model, f"the sensitivities of {study.name}", SENSITIVITIES, workers)
        if store is not None:
            store.open(model)
        with evaluating(model, workers, store) as evaluations:
            known = layout_sensitivities(evaluations, progress=progress)
    prior = SetPrior(candidates, study.card.diagnosis.effects_expected)
    linear = _noiseless(known, known.fitted)
    n = len(candidates)
    smallest, seen, last = np.full(n, np.inf), np.full(n, np.inf), [""] * n
    apart = np.zeros((n, n))
    for i, candidate in enumerate(candidates):
        response = _response(linear, candidate)
        at_scale = margins(linear, response, (candidate,), [(other,) for other in candidates], prior)
        apart[i] = at_scale
        smallest[i], last[i] = _threshold(linear, response, candidate, candidates, prior)
        seen[i], _ = _threshold(linear, response, candidate, (), prior)
    runs = _fewest_runs(known, candidates, prior, smallest)
    scale = np.array([candidate.amplitudes[0].sd if candidate.amplitudes else 1.0 for candidate in candidates])
    shares = np.array([1 / sum(other.name == candidate.name for other in candidates) for candidate in candidates])
    return Isolability(
        study.name,
        candidates,
        smallest * scale,
        seen * scale,
        scale,
        tuple(last),
        apart,
        runs,
        shares,
        layout_notes(study),
    )


def layout_sensitivities(
    evaluations: Evaluations,
    responses_at_hand: Sequence[DriveResponse] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> Sensitivities:
    """How the sensors of planned runs respond to everything that a diagnosis of them may fit."""
    model = evaluations.model
    read = {name for drive in model.drives for name in drive.parts()}
    unknowns, nuisance = unknowns_of(model.study, read, catalogue_candidates(model.study), model.settings)
    known = responses_at_hand or responses(evaluations, unknowns, progress)
    return sensitivities(model.drives, unknowns, nuisance, known)


def _noiseless(known: Sensitivities, numbers: Sequence[int]) -> LinearModel:
    """The linear model of some runs, to be given data."""
    design = known.design(numbers)
    return LinearModel(design, np.zeros(len(design.jacobian)))


def _response(linear: LinearModel, candidate: Candidate) -> Array:
    """Signal of an effect at its usual strength: all its amplitudes one prior sd from null, on the allowed side."""
    signal = np.zeros(len(linear.data))
    for unknown in candidate.presence:
        signal = signal + linear.jacobian[:, linear.design.place[unknown]]
    for unknown in candidate.amplitudes:
        side = 1.0 if unknown.high > 0 else -1.0
        signal = signal + linear.jacobian[:, linear.design.place[unknown]] * side * min(
            unknown.sd, abs(side * unknown.high)
        )
    return signal


def _threshold(
    linear: LinearModel, response: Array, candidate: Candidate, candidates: Sequence[Candidate], prior: SetPrior
) -> tuple[float, str]:
    """Amplitude, in prior sds, from which the effect is ahead of all others; and which of these holds out longest."""
    sets = competitors_of((candidate,), candidates)
    if not candidate.amplitudes:
        ahead = margins(linear, response, (candidate,), sets, prior)
        worst = int(np.argmin(ahead))
        return 1.0 if ahead[worst] >= MARGIN else math.inf, " + ".join(each.key for each in sets[worst]) or "no effect"
    unknown = candidate.amplitudes[0]
    largest = max(abs(unknown.low), abs(unknown.high)) / unknown.sd
    largest = min(largest, 20.0)
    values = np.geomspace(0.02, largest, 40) if largest > 0.02 else np.array([largest])
    competitor = ""
    for value in values:
        ahead = margins(linear, value * response, (candidate,), sets, prior)
        worst = int(np.argmin(ahead))
        if ahead[worst] >= MARGIN:
            return float(value), competitor
        competitor = " + ".join(member.key for member in sets[worst]) or "no effect"
    return math.inf, competitor


def _fewest_runs(
    known: Sensitivities, candidates: Sequence[Candidate], prior: SetPrior, smallest: Array
) -> tuple[tuple[str, ...], ...]:
    """The smallest sets of fitted runs that identify at twice their usual strength all that all runs together do."""
    names = [drive.name for drive in known.drives]
    wanted = [i for i in range(len(candidates)) if smallest[i] <= 2.0]
    if not wanted:
        return ()
    for size in range(1, len(known.fitted) + 1):
        enough = []
        for chosen in itertools.combinations(known.fitted, size):
            linear = _noiseless(known, chosen)
            ok = all(
                min(
                    margins(
                        linear,
                        2 * _response(linear, candidates[i]),
                        (candidates[i],),
                        competitors_of((candidates[i],), candidates),
                        prior,
                    )
                )
                >= MARGIN
                for i in wanted
            )
            if ok:
                enough.append(tuple(names[i] for i in chosen))
        if enough:
            return tuple(enough)
    return ()
