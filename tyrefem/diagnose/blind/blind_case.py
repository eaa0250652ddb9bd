"""Blind tests: effects are hidden in synthetic data of a study's sensors and runs, and the data are diagnosed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tyrefem.diagnose.beside.discrepancy import other_structure
from tyrefem.diagnose.blind.other_model import STRUCTURAL_MESH, STRUCTURAL_STEP, OtherModel, drawn_model
from tyrefem.diagnose.blind.synthetic import HotRing, Lamp, Logger, record, synthetic_mesh, theta_steps
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.evaluations import Evaluations, evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.layout.isolability import MARGIN, competitors_of, margins
from tyrefem.diagnose.layout.planned_runs import layout_sensitivities, planned
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, SetPrior, catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns, sensor_unknowns, with_values
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, PARTLY
from tyrefem.diagnose.words.discrepancy_record import possible_effects
from tyrefem.diagnose.workflow import diagnose
from tyrefem.effects import Effect
from tyrefem.inputs.study import StudyData
from tyrefem.measured import MeasuredRun

#: Kinds of cases and their shares.
KINDS = {"one": 0.55, "two": 0.15, "none": 0.15, "outside": 0.15}
#: Models of the synthetic data: the study's with hidden causes; one that differs in structure, too.
ORDINARY, STRUCTURAL = "ordinary", "structural"
DATA_MODELS = (ORDINARY, STRUCTURAL)
#: Most effects in a set: two are hidden, and in structural data speed laws of films differ besides.
LARGEST = {ORDINARY: 2, STRUCTURAL: 3}
#: Effects that came after the recorded cases: never hidden, so that a seed keeps its cases; every diagnosis tries them.
NEVER_HIDDEN = ("wind",)
#: Number of leading sets in a row of ``blind.json``.
LEADING = 4
#: Stream of random numbers of the structural differences: the hidden causes are those of the ordinary case.
_STRUCTURE = 17


@dataclass(frozen=True, eq=False)
class BlindCase:
    """The hidden cause of a blind case.

    Parameters
    ----------
    number, seed, kind : of the case. hidden : the hidden candidates. values : x of every unknown.
    uncatalogued : an effect outside the catalogue. station : where that effect heats, m.
    """

    number: int
    seed: int
    kind: str
    hidden: Members
    values: dict[Unknown, float]
    uncatalogued: Effect | None = None
    station: float = math.nan

    @property
    def names(self) -> list[str]:
        """Keys of the hidden effects."""
        return [member.key for member in self.hidden] or (
            [] if self.uncatalogued is None else [type(self.uncatalogued).name]
        )


def cases(study: StudyData, count: int, seed: int) -> list[BlindCase]:
    """``count`` blind cases; the kinds have the shares of `KINDS`, and the candidate effects take turns.

    Effects of `NEVER_HIDDEN` take none. The variant of an effect (a sensor) is drawn at random. Amplitudes are
    log-uniform from 0.25 to 3 prior standard deviations. If the study has fewer than two physical candidates, cases of
    kind "two" become cases of kind "one".
    """
    candidates = catalogue_candidates(study)
    names = sorted({candidate.name for candidate in candidates} - set(NEVER_HIDDEN))
    physical = [
        name for name in names if next(each for each in candidates if each.name == name).effect.family != "measurement"
    ]
    order = np.random.default_rng([seed, 0]).permutation(len(names))
    turn = itertools.cycle([names[i] for i in order])
    result = []
    for number in range(count):
        rng = np.random.default_rng([seed, number + 1])
        kind = _kind(number)
        if kind == "two" and len(physical) < 2:
            kind = "one"
        base = (*base_unknowns(study), *sensor_unknowns(study, set(study.sensors)))
        values = {unknown: _within(unknown, rng.normal(0.0, unknown.sd)) for unknown in base}
        hidden: list[Candidate] = []
        uncatalogued, station = None, math.nan
        if kind == "one":
            hidden = [_variant(candidates, next(turn), rng)]
        elif kind == "two":
            pair = rng.choice(len(physical), 2, replace=False)
            hidden = [_variant(candidates, physical[i], rng) for i in pair]
        elif kind == "outside":
            uncatalogued, station = _uncatalogued(study, rng)
        elif rng.random() < 0.5 and study.uncertainty:
            # No effect is hidden, but one base number is wrong by two and a half standard deviations.
            wrong = base[int(rng.integers(len(study.uncertainty)))]
            values[wrong] = 2.5 * wrong.sd * rng.choice([-1.0, 1.0])
        for member in hidden:
            values |= dict.fromkeys(member.presence, 1.0)
            for unknown in member.amplitudes:
                size = unknown.sd * math.exp(rng.uniform(math.log(0.25), math.log(3.0)))
                side = (
                    rng.choice([-1.0, 1.0]) if unknown.low < 0 < unknown.high else (1.0 if unknown.high > 0 else -1.0)
                )
                values[unknown] = _within(unknown, side * size)
        result.append(BlindCase(number, seed, kind, tuple(hidden), values, uncatalogued, station))
    return result


def _kind(number: int) -> str:
    """The kind of a case; the golden ratio spreads the kinds evenly over the numbers."""
    place, edge = (number * 0.6180339887) % 1.0, 0.0
    for kind, share in KINDS.items():
        edge += share
        if place < edge:
            return kind
    return "one"


def _within(unknown: Unknown, x: float) -> float:
    """x, limited to 95 % of the unknown's bounds."""
    return float(np.clip(x, 0.95 * unknown.low, 0.95 * unknown.high))


def _variant(candidates: Sequence[Candidate], name: str, rng: np.random.Generator) -> Candidate:
    variants = [candidate for candidate in candidates if candidate.name == name]
    return variants[int(rng.integers(len(variants)))]


def _uncatalogued(study: StudyData, rng: np.random.Generator) -> tuple[Effect, float]:
    length = study.section.line.length
    width = rng.uniform(0.12, 0.25) * length
    start = rng.uniform(0.0, length - width)
    size = math.exp(rng.uniform(math.log(0.5), math.log(4.0)))
    if rng.random() < 0.6:
        ring = HotRing.check(
            {
                "start": f"{start} m",
                "end": f"{start + width} m",
                "outer": bool(rng.random() < 0.5),
                "exponent": float(rng.uniform(0.3, 2.5)),
                "heat": f"{size * 1e5} W/m**3",
            }
        )
        return ring, start + width / 2
    start = rng.uniform(0.2 * length, length * 0.8 - width)
    lamp = Lamp.check(
        {
            "start": f"{start} m",
            "end": f"{start + width} m",
            "until": f"{rng.uniform(200.0, 900.0)} s",
            "shine": f"{size * 600.0} W/m**2",
        }
    )
    return lamp, start + width / 2


def mesh_of(data_model: str) -> dict[str, str]:
    """The mesh of synthetic data, as changes of a study by dotted names."""
    return dict(STRUCTURAL_MESH) if data_model == STRUCTURAL else synthetic_mesh()


def other_model(study: StudyData, case: BlindCase) -> OtherModel:
    """The structural differences of a case, from its seed and number."""
    rng = np.random.default_rng([case.seed, case.number + 1, 0, _STRUCTURE])
    return drawn_model(study, rng, tuple(member.name for member in case.hidden))


def measured(
    study: StudyData,
    case: BlindCase,
    logger: Logger | None = None,
    mesh: Mapping[str, Any] | None = None,
    model: OtherModel | None = None,
) -> list[MeasuredRun]:
    """The synthetic data of a case: every run simulated with the hidden cause and recorded.

    ``mesh``: changes of the study's mesh by dotted names; default: `mesh_of`. ``model``: structural differences.
    """
    logger = logger or Logger()
    mesh = mesh_of(ORDINARY if model is None else STRUCTURAL) if mesh is None else mesh
    extra = () if case.uncatalogued is None else (case.uncatalogued,)
    runs = []
    for number, drive in enumerate(planned(study)):
        rng = np.random.default_rng([case.seed, case.number + 1, number + 1])
        driven = study.at_run(drive.run, drive.drive)
        # The values are factors, so a load error of 2 % acts on the load of every run.
        hidden = with_values(driven, case.values)
        if model is None:
            runs.append(record(hidden.replace(mesh), drive.name, logger, rng, extra))
            continue
        hidden = model.changed(hidden, mesh)
        cycles, further = model.schedule(driven, hidden), (*extra, *model.effects)
        step = STRUCTURAL_STEP
        runs.append(record(hidden, drive.name, logger, rng, further, cycles=cycles, integrate=theta_steps, step=step))
    return runs


@dataclass(frozen=True, eq=False)
class BlindOutcome:
    """A blind case and the row of its diagnosis; ``other_model``: the recorded structural differences.

    ``identifiable_alone``: whether the hidden effects could be named if nothing else were wrong.
    """

    case: BlindCase
    identifiable: bool
    diagnosis: dict[str, Any] = field(default_factory=dict)
    other_model: dict[str, Any] | None = None
    identifiable_alone: bool = False

    def to_dict(self) -> dict[str, Any]:
        """A row of ``blind.json``."""
        return {
            "number": self.case.number,
            "kind": self.case.kind,
            "hidden": self.case.names,
            "amplitude": {
                unknown.key: self.case.values[unknown] / unknown.sd
                for member in self.case.hidden
                for unknown in member.amplitudes
            },
            "identifiable": self.identifiable,
            **({} if self.other_model is None else self._beside()),
            **self.diagnosis,
        }

    def _beside(self) -> dict[str, Any]:
        return {"identifiable_alone": self.identifiable_alone, "other_model": self.other_model}


def identifiable(
    evaluations: Evaluations, known: Sequence[DriveResponse], case: BlindCase, data_model: str = ORDINARY
) -> bool:
    """Whether the linear model ranks the hidden effects ahead of every other set by `MARGIN`, without noise.

    The signal is the difference of two simulations: with the hidden values, and without. It needs no diagnosis. For
    structural data the strain energy, gauges and speed laws of films are unknown besides (`other_structure`).
    """
    if not case.hidden:
        return False
    hidden = {
        unknown: case.values[unknown] for member in case.hidden for unknown in (*member.amplitudes, *member.presence)
    }
    model, sensitive = evaluations.model, layout_sensitivities(evaluations, known)
    signal = np.concatenate(
        [
            model.drives[number].whitened(model.predict(number, hidden) - model.predict(number, {}))
            for number in sensitive.fitted
        ]
    )
    candidates = catalogue_candidates(model.study)
    prior = SetPrior(candidates, model.study.card.diagnosis.effects_expected, model.settings.size_shares)
    design = sensitive.design(sensitive.fitted)
    if data_model == STRUCTURAL:
        beside = other_structure(sensitive, {unknown.key for unknown in hidden})
        design, signal = replace(design, jacobian=beside.whitened(design.jacobian)), beside.whitened(signal)
    leads = margins(LinearModel(design, signal), signal, case.hidden, competitors_of(case.hidden, candidates), prior)
    return min(leads) >= MARGIN


def run_case(
    study: StudyData,
    case: BlindCase,
    known: Sequence[DriveResponse],
    reduced: str = "auto",
    mesh: Mapping[str, Any] | None = None,
    data_model: str = ORDINARY,
) -> BlindOutcome:
    """Make the synthetic data of a case and diagnose them.

    ``known``: responses of the planned runs; ``reduced`` as of `diagnose`; ``mesh`` of the data, see `measured`;
    ``data_model``: one of `DATA_MODELS`.
    """
    with evaluating(ForwardModel(study, planned(study))) as evaluations:
        alone = identifiable(evaluations, known, case)
        beside = alone if data_model == ORDINARY else identifiable(evaluations, known, case, data_model)
    model = other_model(study, case) if data_model == STRUCTURAL else None
    data = measured(study, case, mesh=mesh, model=model)
    diagnosis = diagnose(
        study, data, largest=LARGEST[data_model], known=known, rerun=False, verdict_only=True, looks=1, reduced=reduced
    )
    parts = None if model is None else model.to_dict(mesh_of(data_model) if mesh is None else mesh)
    return BlindOutcome(case, beside, outcome_row(diagnosis), parts, alone)


def outcome_row(diagnosis: DiagnosisData) -> dict[str, Any]:
    """The results of a diagnosis for a row of ``blind.json``."""
    judgement = diagnosis.judgement
    best = judgement.best
    named = [member.key for member in diagnosis.best.members] if diagnosis.verdict in (IDENTIFIED, PARTLY) else []
    chosen: set[str] = set()
    for ranked in judgement.credible:
        chosen |= (
            {"not in the catalogue"} if ranked.outside else {member.key for member in ranked.members} or {"no effect"}
        )
    # "Unexplained" tells which effects may act beside what else is wrong.
    chosen |= set(possible_effects(diagnosis))
    return {
        "verdict": diagnosis.verdict,
        "named": named,
        "set": sorted(chosen),
        "best": best.key,
        "probability": judgement.probability,
        "leading": [[entry.key, entry.probability] for entry in judgement.ranking[:LEADING]],
        "reasons": list(judgement.reasons),
        "doubts": list(judgement.doubts),
        "inclusion": {key: value for key, value in judgement.named.items() if value > 0.01},
        "p_value": diagnosis.best.p_value,
        "held_out_p": diagnosis.best.held_out_p,
        "missing_station_m": diagnosis.missing.station,
        "rms_K": {
            "before": diagnosis.rms(after=False, held_out=False),
            "after": diagnosis.rms(after=True, held_out=False),
        },
        "held_out_rms_K": {
            "before": diagnosis.rms(after=False, held_out=True),
            "after": diagnosis.rms(after=True, held_out=True),
        },
        "noise_K": diagnosis.noise,
        "points": {
            "reduced": diagnosis.predictions["points_by_reduced_models"],
            "lean": diagnosis.predictions["points_by_lean_simulations"],
        },
        "seconds": diagnosis.seconds,
    }
