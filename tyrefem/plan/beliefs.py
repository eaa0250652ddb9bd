"""What is known before the next run: sets of effects with their probabilities, and the posterior of every set."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.compare.sensors import OUTSIDE_THE_RUBBER
from tyrefem.diagnose.forward.strain_law_study import by_law
from tyrefem.diagnose.layout.planned_runs import candidates_of
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior, possible
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns, sensor_unknowns
from tyrefem.diagnose.verdicts.verdict import NO_GAP
from tyrefem.diagnose.words.looks import AGAIN
from tyrefem.diagnose.words.record import AMENDED
from tyrefem.diagnose.words.set_posteriors import (
    POSTERIOR,
    SetPosterior,
    noise_by_sensor,
    part_of_cause,
    read_posteriors,
    set_posteriors,
    tables,
)
from tyrefem.errors import InputError, quoted
from tyrefem.inputs.study import StudyData
from tyrefem.simulation.surroundings import GAS

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

Array = NDArray[np.float64]
#: Noise of a sensor without a card, K.
NOISE = 0.5


@dataclass(frozen=True, eq=False)
class Beliefs(Brief):
    """The remaining sets of effects.

    Parameters
    ----------
    study : the study that the data were compared with, by the strain law of the diagnosis.
    sets : with probabilities that sum to 1, most probable first.
    noise : installed sensor -> noise of a reading, K. runs : names of the measured runs.
    verdict : of the earlier diagnosis; empty before a test. part : effects that are "partly identified".
    """

    study: StudyData
    sets: tuple[SetPosterior, ...]
    noise: dict[str, float]
    runs: tuple[str, ...] = ()
    verdict: str = ""
    part: tuple[str, ...] = ()

    @property
    def probabilities(self) -> Array:
        """(K,) of the sets."""
        return np.array([entry.probability for entry in self.sets])

    def without(self, failed: tuple[Unknown, ...]) -> Beliefs:
        """The beliefs without the sets of effects that no drive of the plan can have."""
        if not failed:
            return self
        sets = tuple(
            entry
            for entry in self.sets
            if set(failed).isdisjoint(unknown for member in entry.members for unknown in member.unknowns)
        )
        return replace(self, sets=_normalised(sets))


def _normalised(sets: tuple[SetPosterior, ...]) -> tuple[SetPosterior, ...]:
    total = sum(entry.probability for entry in sets)
    ordered = sorted(sets, key=lambda entry: -entry.probability)
    return tuple(replace(entry, probability=entry.probability / total) for entry in ordered)


def prior_beliefs(study: StudyData) -> Beliefs:
    """Before a test: no effect and every single effect of the catalogue, by their prior probabilities.

    An amplitude has the mean and the variance of its prior, N(0, sd^2) cut to its bounds.

    Raises
    ------
    InputError : no effect of the catalogue is left that the study may lack.
    """
    candidates, _ = possible(study, candidates_of(study))
    prior = SetPrior(candidates, study.card.diagnosis.effects_expected)
    noise = {name: sensor.noise for name, sensor in study.sensors.items()} | {GAS: NOISE}
    nuisance = (*base_unknowns(study), *sensor_unknowns(study, set(study.sensors)))
    members: list[Members] = [(), *((candidate,) for candidate in candidates)]
    sets = tuple(_prior_set(each, float(np.exp(prior(each))), nuisance) for each in members)
    return Beliefs(study, _normalised(sets), noise)


def _prior_set(members: Members, probability: float, nuisance: tuple[Unknown, ...]) -> SetPosterior:
    amplitudes = tuple(unknown for member in members for unknown in member.amplitudes)
    moments = [cut_moments(unknown.sd, unknown.low, unknown.high) for unknown in amplitudes]
    mean = np.array([0.0] * len(nuisance) + [first for first, _ in moments])
    variance = np.array([unknown.sd**2 for unknown in nuisance] + [second for _, second in moments])
    return SetPosterior(members, probability, (*nuisance, *amplitudes), mean, np.diag(variance))


def cut_moments(sd: float, low: float, high: float) -> tuple[float, float]:
    """Mean and variance of N(0, sd^2) cut to [low, high].

    >>> mean, variance = cut_moments(1.0, 0.0, np.inf)
    >>> round(mean, 4), round(variance, 4)      # sqrt(2/pi), 1 - 2/pi
    (0.7979, 0.3634)
    """
    from scipy.stats import truncnorm

    mean, variance = truncnorm.stats(low / sd, high / sd, scale=sd, moments="mv")
    return float(mean), float(variance)


def diagnosed_beliefs(diagnosis: DiagnosisData) -> Beliefs:
    """After a verdict: the sets that the latest look leaves; of the look before it, if that found no gap."""
    looks = [look for look in diagnosis.looks if look.verdict != NO_GAP] or [diagnosis]
    d = looks[-1]
    runs, part = tuple(run.name for run in d.gap.runs), tuple(part_of_cause(d))
    return Beliefs(d.gap.study, _normalised(set_posteriors(d)), noise_by_sensor(d), runs, d.verdict, part)


def _check_tables(study: StudyData, diagnosed: Mapping[str, Any]) -> None:
    """Refuse the posteriors of a study that has changed since its diagnosis."""
    now = tables(study)
    changed = [name for name in now if now[name] != diagnosed[name]]
    if changed:
        raise InputError(f"belongs to another study: [{changed[0]}] differs from the one that was diagnosed")


def _stored(folder: Path) -> Any:
    """The contents of a folder's ``posterior.json``."""
    file = folder / POSTERIOR
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        message = f"holds no {POSTERIOR}: name the output folder of 'tyrefem diagnose', or a table of readings"
        raise InputError(message, file=folder) from None
    except ValueError:
        raise InputError("is damaged: diagnose again", file=file) from None


def stored_beliefs(study: StudyData, folder: Path) -> Beliefs:
    """After a verdict: the sets in the folder of an earlier diagnosis, see `diagnosed_beliefs`.

    Raises
    ------
    InputError : the folder holds no diagnosis of this study.
    """
    record, file = _stored(folder), folder / POSTERIOR
    try:
        # The first look is that at the study; a further one is at the study that the look before has amended.
        _check_tables(study, record["tables"])
    except InputError as error:
        raise error.within(file=file) from None
    except (KeyError, TypeError):
        raise InputError("is damaged: diagnose again", file=file) from None
    while (folder / AGAIN / POSTERIOR).is_file():
        study = type(study).load(folder / AMENDED)
        folder = folder / AGAIN
        record, file = _stored(folder), folder / POSTERIOR
    try:
        if (law := record.get("strain_law")) is not None:
            study = by_law(study, str(law["name"]), float(law["level"]))
        sets = read_posteriors(record, study, DiagnosisSettings())
        noise = {str(name): float(value) for name, value in record["noise_K"].items()}
        runs, verdict = tuple(map(str, record["runs"])), str(record["verdict"])
        part = tuple(map(str, record.get("part", ())))
        absent = [name for name in noise if name not in (*study.sensors, *OUTSIDE_THE_RUBBER)]
        if absent:
            raise InputError(f"belongs to another study: {quoted(absent, study.sensors)} is no sensor of this one")
    except InputError as error:
        raise error.within(file=file) from None
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError("is damaged: diagnose again", file=file) from None
    return Beliefs(study, _normalised(sets), noise, runs, verdict, part)
