"""The sets of effects that a diagnosis leaves, each with the posterior of its unknowns: `posterior.json`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.fits import linear_about
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.unknowns.candidates import Members, catalogue_candidates, in_single_runs
from tyrefem.diagnose.unknowns.computed_wave import WithWave, recorded_wave, stored_wave
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns, sensor_unknowns
from tyrefem.diagnose.verdicts.verdict import PARTLY
from tyrefem.errors import InputError
from tyrefem.output import jsonable

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.verdicts.verdict import RankedSet
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: File of the posteriors in a diagnosis's folder.
POSTERIOR = "posterior.json"
#: Largest number of sets, and the smallest probability of one beyond the credible sets.
MOST, LEAST = 12, 1e-3
#: Tables of a study on which the posteriors depend.
TABLES = ("section", "materials", "drive", "boundaries", "mechanics", "effects", "uncertainty")


@dataclass(frozen=True, eq=False)
class SetPosterior(Brief):
    """A set of effects with its probability, and the Gaussian of its unknowns: ``mean`` (n,), ``covariance`` (n, n).

    ``outside``: a cause outside the catalogue, whose unknowns are patches of heat and flux.
    """

    members: Members
    probability: float
    unknowns: tuple[Unknown, ...]
    mean: Array
    covariance: Array
    outside: bool = False

    @property
    def key(self) -> str:
        """The keys of the members, or "no effect", or "not in the catalogue"."""
        if self.outside:
            return "not in the catalogue"
        return " + ".join(sorted(member.key for member in self.members)) or "no effect"

    @property
    def values(self) -> dict[Unknown, float]:
        """Unknown -> x; 1 for effects without amplitude."""
        fitted = dict(zip(self.unknowns, map(float, self.mean), strict=True))
        return fitted | {unknown: 1.0 for member in self.members for unknown in member.presence}

    def to_dict(self) -> dict[str, Any]:
        """Plain data; the covariance as its lower triangle, row by row."""
        triangle = self.covariance[np.tril_indices(len(self.mean))]
        return {
            "effects": [
                {"name": member.name, "variant": dict(member.choice), "runs": list(member.runs) or None}
                for member in self.members
            ],
            "outside": self.outside,
            "probability": self.probability,
            "unknowns": [{"key": unknown.key, "sd": unknown.sd} for unknown in self.unknowns],
            "mean": [float(f"{x:.8g}") for x in self.mean],
            "covariance": [float(f"{x:.8g}") for x in triangle],
        }


def set_posteriors(d: DiagnosisData) -> tuple[SetPosterior, ...]:
    """The credible sets of a diagnosis and the sets above 0.1 %, at most 12, most probable first."""
    entries = [entry for entry in d.judgement.ranking if entry in d.judgement.credible or entry.probability >= LEAST][
        :MOST
    ]
    return tuple(_posterior(d, entry) for entry in entries)


def _posterior(d: DiagnosisData, entry: RankedSet) -> SetPosterior:
    """The fit's posterior; of a set that was not fitted, that of the linear model about the fit of no effect."""
    if entry.fit is not None and not entry.outside:
        fit = entry.fit
        return SetPosterior(
            entry.members, entry.probability, fit.unknowns, fit.posterior.mean, fit.posterior.covariance
        )
    amplitudes: Sequence[Unknown] = [unknown for member in entry.members for unknown in member.amplitudes]
    if entry.outside:
        amplitudes = patches(d.original, d.gap.settings)
    presence = [unknown for member in entry.members for unknown in member.presence]
    linear = linear_about(d.gap, d.null, (*amplitudes, *presence))
    free = (*d.null.unknowns, *amplitudes)
    J, present = linear.jacobian[:, : len(free)], linear.jacobian[:, len(free) :].sum(axis=1)
    sd, low, high = (np.array([getattr(unknown, name) for unknown in free]) for name in ("sd", "low", "high"))
    of_linear = posterior(J.T @ J, J.T @ (linear.data - present), sd, low, high)
    return SetPosterior(
        entry.members, entry.probability, free, of_linear.mean, of_linear.covariance, outside=entry.outside
    )


def noise_by_sensor(d: DiagnosisData) -> dict[str, float]:
    """Noise of a reading as the diagnosis uses it, by sensor: rms over the runs, K."""
    squares: dict[str, list[float]] = {}
    for run in d.gap.runs:
        for readings in run.sensors:
            squares.setdefault(readings.sensor, []).append(readings.noise**2)
    return {sensor: float(np.sqrt(np.mean(values))) for sensor, values in squares.items()}


def tables(study: StudyData) -> dict[str, Any]:
    """The tables of a study on which the posteriors depend, as plain data."""
    plain: dict[str, Any] = jsonable({name: study.data.get(name) for name in TABLES})
    return plain


def part_of_cause(d: DiagnosisData) -> list[str]:
    """Keys of the effects that act whatever else is wrong, if the verdict is "partly identified"; else empty."""
    return [member.key for member in d.best.members] if d.verdict == PARTLY else []


def posterior_record(d: DiagnosisData) -> dict[str, Any]:
    """Contents of ``posterior.json``: sets with the posteriors of their unknowns, noise of sensors, names of runs.

    ``part``: see `part_of_cause`. ``strain_law``: name and level of the strain law in place of the study's, null if
    this stands; see `by_law`.
    ``standing_wave``: computed numbers of the effect, null if those of the catalogue were taken.
    """
    better = d.better_law
    return {
        "study": d.original.name,
        "verdict": d.verdict,
        "part": part_of_cause(d),
        "tables": tables(d.original),
        "strain_law": None if better is None else {"name": better.trial.law, "level": better.trial.level},
        "standing_wave": recorded_wave(d.candidates),
        "runs": [run.name for run in d.gap.runs],
        "noise_K": noise_by_sensor(d),
        "sets": [entry.to_dict() for entry in set_posteriors(d)],
    }


def read_posteriors(record: Mapping[str, Any], study: StudyData, settings: Any) -> tuple[SetPosterior, ...]:
    """The sets of a record of `posterior_record`, for the study that was diagnosed.

    Raises
    ------
    InputError : the record belongs to another study.
    """
    everywhere = WithWave(catalogue_candidates, stored_wave(record.get("standing_wave")))(study)
    candidates = {
        (each.name, each.choice, each.runs): each
        for each in (*everywhere, *in_single_runs(study, everywhere, [*record["runs"], ""]))
    }
    known = [*base_unknowns(study), *sensor_unknowns(study, set(study.sensors)), *patches(study, settings)]
    known += [unknown for candidate in candidates.values() for unknown in candidate.unknowns]
    by_key = {(unknown.key, f"{unknown.sd:.6g}"): unknown for unknown in known}
    sets = []
    for entry in record["sets"]:
        try:
            members = tuple(
                candidates[each["name"], tuple(each["variant"].items()), tuple(each["runs"] or ())]
                for each in entry["effects"]
            )
            unknowns = tuple(by_key[each["key"], f"{each['sd']:.6g}"] for each in entry["unknowns"])
        except KeyError as error:
            message = f"belongs to another study, or to other cards: {error.args[0]} is not in this one"
            raise InputError(f"{message}; diagnose again") from None
        n = len(unknowns)
        lower = np.zeros((n, n))
        lower[np.tril_indices(n)] = entry["covariance"]
        covariance = lower + np.tril(lower, -1).T
        sets.append(
            SetPosterior(members, entry["probability"], unknowns, np.array(entry["mean"]), covariance, entry["outside"])
        )
    return tuple(sets)
