"""How the sensors of every run respond to every unknown: the dear part of a diagnosis, the same for any data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from tyrefem.diagnose.evaluations import Laboratory
from tyrefem.diagnose.forward_model import Response
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.missing_heat import patches
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.reduced_forward import Modes
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown, base_unknowns, candidates, sensor_unknowns
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

Tick = Callable[[str, int, int], None]


def unknowns_of(
    study: StudyData, measured: Iterable[str], settings: DiagnosisSettings = DEFAULT
) -> tuple[tuple[Unknown, ...], int]:
    """Everything that a diagnosis with these sensors may fit, and how many of it, the first, are in every model."""
    nuisance = (*base_unknowns(study), *sensor_unknowns(study, set(measured)))
    found = [one for each in candidates(study) for one in (*each.amplitudes, *each.presence)]
    return (*nuisance, *found, *patches(study, settings)), len(nuisance)


def responses(lab: Laboratory, unknowns: tuple[Unknown, ...], tick: Tick | None = None) -> tuple[Response, ...]:
    """The response of every trial's drive: the dear part of a diagnosis, and the same for any data."""
    count = len(lab.bench.trials)
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if tick:
            tick("sensitivities", done, count)

    sensors, near = lab.bench.sensors, lab.bench.nearby(lab.bench.coarse)
    if tick and near is not None:
        tick(f"solving the strain cycle of every drive again for {len(near.numbers)} numbers", 0, 0)
    found = []
    for times, readings, correction, slopes, V in lab.ask("response", [(i, unknowns) for i in range(count)], step):
        by_sensor = [dict(zip(sensors, each, strict=True)) for each in (readings, correction, slopes)]
        found.append(Response(unknowns, times, by_sensor[0], by_sensor[1], by_sensor[2], Modes(V)))
    return tuple(found)


def gap_of(
    lab: Laboratory, tick: Tick | None = None, known: Sequence[Response] | None = None, *, reduced: bool = True
) -> Gap:
    """Data against study for the trials of a laboratory; ``known``: their responses, if at hand.

    ``reduced``: whether the drives' reduced models may predict.
    """
    trials = lab.bench.trials
    unknowns, nuisance = unknowns_of(
        lab.bench.study, {one.sensor for each in trials for one in each.series}, lab.bench.settings
    )
    if known is not None and any(one.unknowns != unknowns for one in known):
        raise InputError("the responses at hand are of another study, or of other sensors")
    found = known or responses(lab, unknowns, tick)
    computed, correction, jacobians = zip(
        *(one.blocks(each) for one, each in zip(found, trials, strict=True)), strict=True
    )
    predictions = Predictions(lab, [one.modes for one in found] if reduced else ())
    return Gap(lab, unknowns, nuisance, correction, computed, jacobians, tuple(found), predictions, lab.bench.settings)
