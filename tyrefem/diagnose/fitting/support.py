"""How far one sensor or one run alone speaks for an effect: probabilities with each of them left out."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, linear_about
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.inference.set_evidences import SetEvidences
from tyrefem.diagnose.inference.shared_error import SharedError
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, separate
from tyrefem.diagnose.unknowns.unknown import Unknown

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]
#: Below this probability without a sensor or run, this one alone asks for the effect.
ALONE = 0.5
SENSOR, RUN = "sensor", "run"


@dataclass(frozen=True)
class LeftOut(Brief):
    """Probability of an effect without the readings of one sensor in all fitted runs, or of one fitted run."""

    kind: str
    name: str
    probability: float

    def _title(self) -> str:
        return f"without {self.name}: {self.probability:.3g}"


@dataclass(frozen=True)
class Support(Brief):
    """Support of an effect by the sensors and runs; ``left_out``: the smallest probability first.

    ``only_at``: sensor or run of an effect that can show only there, such as a sensor's offset; it is never left out.
    """

    left_out: tuple[LeftOut, ...]
    only_at: str = ""

    @property
    def weakest(self) -> LeftOut | None:
        """What speaks most for the effect; None with a single sensor and run."""
        return self.left_out[0] if self.left_out else None

    @property
    def only(self) -> str:
        """The only sensor or run that asks for the effect; empty if there are more."""
        if self.only_at:
            return self.only_at
        return self.left_out[0].name if self.left_out and self.left_out[0].probability < ALONE else ""


def supports(
    residuals: Residuals,
    best: FittedSet,
    fits: Mapping[Members, FittedSet],
    candidates: Sequence[Candidate],
    prior: Callable[[Members], float],
) -> dict[Candidate, Support]:
    """The support of every effect of the best set.

    Sets are compared in linear models about their own fits and, with an effect less or another one in its place, about
    the best fit. Base numbers, sensors and amounts are fitted again without the left-out readings. The best fit does
    not tell what is left without an effect that has no amplitude, so that only the sets' own fits count there.
    """
    chances: dict[Candidate, list[LeftOut]] = {member: [] for member in best.members}
    places = {member: _place(member) for member in best.members}
    models = {members: (prior(members), _Rows.of(fit)) for members, fit in fits.items()}
    about = _Rows.of(best)
    unknowns = [unknown for each in candidates for unknown in (*each.amplitudes, *each.presence)]
    wide = linear_about(residuals, best, unknowns)
    further = _colored(best.shared_error, wide.jacobian[:, len(best.unknowns) :])
    for kind, name, rows_kept in _groups(residuals):
        kept = _Kept(rows_kept)
        sets = {frozenset(members): share + rows.evidence(kept) for members, (share, rows) in models.items()}
        sets.setdefault(frozenset(best.members), prior(best.members) + about.evidence(kept))
        for member in (each for each in best.members if not each.presence):
            part = tuple(each for each in best.members if each != member)
            less = about.without(member.unknowns)
            alone = prior(part) + less.evidence(kept)
            sets[frozenset(part)] = max(alone, sets.get(frozenset(part), -math.inf))
            design = DesignMatrix(
                (*less.unknowns, *unknowns), len(less.unknowns), less.whitened(kept, np.hstack([less.J, further]))
            )
            linear = LinearModel(design, less.whitened(kept, less.d))
            others = [other for other in candidates if other != member and separate(other, part)]
            evidences = SetEvidences(design, [(), *((other,) for other in others)]).log_evidence(linear.overlap)
            gains = evidences[1:] - evidences[0]
            of_part = less.evidence(kept)
            for other, gain in zip(others, gains.tolist(), strict=True):
                changed = frozenset((*part, other))
                value = prior((*part, other)) + of_part + gain
                sets[changed] = max(value, sets.get(changed, -math.inf))
        total = float(np.logaddexp.reduce(list(sets.values())))
        for member in best.members:
            if places[member] != name:
                share = math.fsum(math.exp(value - total) for members, value in sets.items() if member in members)
                chances[member].append(LeftOut(kind, name, min(share, 1.0)))
    return {
        member: Support(tuple(sorted(each, key=lambda entry: entry.probability)), places[member])
        for member, each in chances.items()
    }


def _place(member: Candidate) -> str:
    """The sensor or run that alone can show an effect; two swapped sensors both show it."""
    if [key for key, _ in member.choice] == ["sensor"]:
        return member.choice[0][1]
    return member.runs[0] if len(member.runs) == 1 else ""


def _groups(residuals: Residuals) -> list[tuple[str, str, Rows]]:
    """(kind, name, rows that are kept) of every sensor and of every fitted run; none if nothing else is left."""
    runs = [residuals.runs[number] for number in residuals.fitted]
    labels = [(run.run, readings.sensor) for run in runs for readings in run.sensors for _ in readings.starts]
    of_runs, of_sensors = (np.array(part) for part in zip(*labels, strict=True))
    groups = [(SENSOR, str(name), of_sensors != name) for name in dict.fromkeys(of_sensors)]
    groups += [(RUN, str(name), of_runs != name) for name in dict.fromkeys(of_runs)]
    return [group for group in groups if group[2].any()]


def _colored(shared: SharedError | None, rows: Array) -> Array:
    return rows if shared is None else shared.colored(rows)


@dataclass(eq=False)
class _Kept:
    """The readings that are kept, and the errors that they share, worked out once for all fits beside one model."""

    rows: Rows
    errors: dict[SharedError, SharedError] = field(default_factory=dict)

    def error(self, shared: SharedError) -> SharedError:
        """A shared error of the kept readings alone."""
        if shared not in self.errors:
            self.errors[shared] = SharedError(shared.fitted[self.rows], np.zeros((0, shared.fitted.shape[1])))
        return self.errors[shared]


@dataclass(frozen=True, eq=False)
class _Rows:
    """The linear model of a fit with its readings one by one: d = J x + C c + e; C: columns of a shared error."""

    unknowns: tuple[Unknown, ...]
    J: Array
    d: Array
    shared: SharedError | None

    @classmethod
    def of(cls, fit: FittedSet) -> _Rows:
        shared = fit.shared_error
        J, d = (_colored(shared, rows) for rows in (fit.linear.jacobian, fit.linear.data))
        return cls(fit.unknowns, J, d, shared)

    def without(self, unknowns: Sequence[Unknown]) -> _Rows:
        """With some unknowns at 0."""
        kept = [place for place, unknown in enumerate(self.unknowns) if unknown not in unknowns]
        return _Rows(tuple(self.unknowns[place] for place in kept), self.J[:, kept], self.d, self.shared)

    def whitened(self, kept: _Kept, rows: Array) -> Array:
        """The kept rows, whitened."""
        part = rows[kept.rows]
        return part if self.shared is None else kept.error(self.shared).whitened(part)

    def evidence(self, kept: _Kept) -> float:
        """ln evidence of the kept readings."""
        J, d = self.whitened(kept, self.J), self.whitened(kept, self.d)
        sd, low, high = np.array([(each.sd, each.low, each.high) for each in self.unknowns]).reshape(-1, 3).T
        log_det = 0.0 if self.shared is None else kept.error(self.shared).log_det
        return posterior(J.T @ J, J.T @ d, sd, low, high).log_evidence - float(d @ d) / 2 - log_det
