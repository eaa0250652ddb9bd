"""Reduced models of measured drives: what they say is what simulations say, and where it is not, simulations speak."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from hidden import COARSE_MESH, FINER_MESH, WARMER, measure, study
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.compare.experiment import experiments
from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.data.runs import measured_drive
from tyrefem.diagnose.data.sensitivities import responses, unknowns_of
from tyrefem.diagnose.fitting.criterion import BIC
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import FOLLOWED, NO_ANSWER, NOT_FOLLOWED, ForwardModel
from tyrefem.diagnose.forward.multifidelity import DriveCertificate, Predictions
from tyrefem.diagnose.forward.reduced_drive import Modes, ReducedDrive
from tyrefem.diagnose.ranking import Ranking, allowed_error
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import Unknown, with_values
from tyrefem.diagnose.verdicts.verdict import NO_GAP, UNEXPLAINED, Judgement, RankedSet
from tyrefem.effects import catalogue

Array = NDArray[np.float64]
DRIVE = 1
#: A coarse mesh: reduced models stand for simulations on the same one. Each kind of discrepancy is tried in one size
#: and beside one set, and no effect in single runs.
FEWER = DiagnosisSettings(
    mesh_size=COARSE_MESH, largest=1, looks=1, heat_widths=(3.0,), discrepancy_sizes=(1.0,), odd_run_share=0.0,
    beside_sets=1, beside_steps=1, singles=2, most_sets=4, most_continuations=1,
)  # fmt: skip


@dataclass(frozen=True)
class Drives:
    """The study, its forward model, everything that may be unknown, and how every drive responds."""

    study: tf.Study
    model: ForwardModel
    unknowns: tuple[Unknown, ...]
    nuisance: int
    known: tuple[DriveResponse, ...]

    @property
    def modes(self) -> list[Modes]:
        return [item.modes for item in self.known]

    def candidate(self, name: str) -> Candidate:
        return next(candidate for candidate in catalogue_candidates(self.study) if candidate.name == name)

    def drawn(self, seed: int) -> dict[Unknown, float]:
        """Base numbers and sensors drawn from their priors."""
        rng = np.random.default_rng(seed)
        base = self.unknowns[: self.nuisance]
        return {item: float(np.clip(rng.normal(0.0, item.sd), 0.9 * item.low, 0.9 * item.high)) for item in base}


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Drives:
    owner = study(tmp_path_factory.mktemp("reduced"), COARSE_MESH)
    measure(owner, [{"name": "hot-road", "warmer_by": f"{WARMER} delta_degC"}], FINER_MESH)
    planned = experiments(owner, None, ignore=(), rename=None)
    model = ForwardModel(owner, tuple(measured_drive(run, owner).sampling for run in planned), settings=FEWER)
    unknowns, nuisance = unknowns_of(owner, set(owner.sensors), catalogue_candidates(owner))
    return Drives(owner, model, unknowns, nuisance, responses(Evaluations(model), unknowns))


def exact(drives: Drives, values: dict[Unknown, float]) -> Array:
    """Block means by a run on the mesh of the fit with a small time error."""
    model = drives.model
    close = with_values(model.driven(model.coarse, DRIVE), values).replace({"numerics.tolerance": "0.002 delta_degC"})
    return model.full(DRIVE, close)


@pytest.mark.parametrize("seed", [1, 2])
def test_base_numbers_and_sensors_change_what_full_runs_say(drives: Drives, seed: int) -> None:
    origin, values = exact(drives, {}), drives.drawn(seed)
    change = exact(drives, values) - origin
    status, result = drives.model.reduced(DRIVE, drives.modes[DRIVE], [{}, values])
    assert status.tolist() == [FOLLOWED, FOLLOWED]
    assert np.abs(change).max() > 1.0
    assert np.abs(result[1] - result[0] - change).max() < 0.02
    # As it is, the drive reads what the fixed-step simulation says.
    np.testing.assert_allclose(result[0], drives.model.predict(DRIVE, {}), atol=1e-12)


FOLLOWED_EFFECTS = ("hot-road", "cord-conduction", "gas-mixing", "loss-temperature-law", "pressure-rise", "wet-road")


@pytest.mark.parametrize("name", FOLLOWED_EFFECTS)
def test_effects_that_were_never_simulated_are_met(drives: Drives, name: str) -> None:
    open_study = drives.study.replace({"diagnosis.exclude": []})
    amplitude = next(candidate for candidate in catalogue_candidates(open_study) if candidate.name == name).amplitudes[
        0
    ]
    values = {amplitude: 2.0 * amplitude.sd * (1.0 if amplitude.high > 0 else -1.0)}
    base = drives.model.base(DRIVE)
    unknowns = (*drives.unknowns, amplitude)
    expected = Modes(drives.model.response(DRIVE, unknowns)[-1])
    change = exact(drives, values) - exact(drives, {})
    status, result = drives.model.reduced(DRIVE, expected, [values])
    assert status.tolist() == [FOLLOWED]
    fixed = drives.model.predict(DRIVE, values) - drives.model.blocks(DRIVE, base.grid, base.readings)
    reduced = result[0] - drives.model.blocks(DRIVE, base.grid, base.readings)
    assert np.abs(change).max() > 0.05
    # No further from the truth than what it stands for, or by a fiftieth of a kelvin.
    assert np.abs(reduced - change).max() < max(np.abs(fixed - change).max(), 0.02)


def test_tangents_are_those_of_simulations(drives: Drives) -> None:
    model, at = drives.model, drives.drawn(3)
    wanted = drives.unknowns[: drives.nuisance]
    status, derivatives = model.reduced_jacobian(DRIVE, drives.modes[DRIVE], wanted, at)
    assert status.tolist() == [FOLLOWED]
    full = model.jacobian(DRIVE, wanted, at)
    sd = np.array([item.sd for item in wanted])
    assert (np.abs(full * sd).max(axis=0) > 0.5).sum() > 5
    assert np.abs((derivatives - full) * sd).max() < 0.05


def test_what_no_model_can_follow_or_no_tyre_can_be_is_told_apart(drives: Drives) -> None:
    sun = drives.candidate("sun").amplitudes[0]
    load = next(unknown for unknown in drives.unknowns if unknown.key == "drive.load")
    status, result = drives.model.reduced(DRIVE, drives.modes[DRIVE], [{sun: 200.0}, {load: 3.0}, {load: 0.05}])
    assert status.tolist() == [NOT_FOLLOWED, NO_ANSWER, FOLLOWED]
    assert np.isfinite(result).all(axis=1).tolist() == [False, False, True]
    # A step too far says nothing against the model.
    predictions = Predictions(Evaluations(drives.model), drives.modes)
    assert np.isnan(predictions.predict([((), {load: 3.0})], [DRIVE])[0][0]).all()
    predictions.predict([((), {load: 0.05})], [DRIVE])
    assert predictions.certificates[(), DRIVE].good


def test_only_sensitivities_that_the_model_does_not_follow_are_simulated(drives: Drives) -> None:
    model, modes = drives.model, drives.modes
    load = next(unknown for unknown in drives.unknowns if unknown.key == "drive.load")
    sun, at = drives.candidate("sun").amplitudes[0], {load: 0.02}
    predictions = Predictions(Evaluations(model), modes)
    predictions.predict([((), at)], [DRIVE])
    ((jacobian,),) = predictions.jacobians([((), (sun, load), at)], [DRIVE])
    status, reduced = model.reduced_jacobian(DRIVE, modes[DRIVE], (sun, load), at)
    assert status.tolist() == [FOLLOWED]
    assert np.isfinite(reduced).all(axis=0).tolist() == [False, True]
    np.testing.assert_array_equal(jacobian[:, 1], reduced[:, 1])
    np.testing.assert_array_equal(jacobian[:, 0], model.jacobian(DRIVE, (sun,), at)[:, 0])


def test_a_set_is_simulated_once_and_then_left_to_the_model(drives: Drives) -> None:
    road = (drives.candidate("hot-road"),)
    predictions = Predictions(Evaluations(drives.model), drives.modes)
    points = [{road[0].amplitudes[0]: x} for x in (10.0, 20.0, 30.0)]
    for item in points:
        predictions.predict([(road, item)], [DRIVE])
    assert (predictions.reduced, predictions.simulated) == (3, 1)
    certificate = predictions.certificates[road, DRIVE]
    assert certificate.good
    assert 0 < certificate.error < 0.1
    assert certificate.cases == 1
    assert predictions.error_at(road, points[-1]) <= DEFAULT.reduced_allowed
    assert predictions.certificates[road, DRIVE].cases == 2


def test_an_effect_that_no_model_follows_stays_with_the_simulation(drives: Drives) -> None:
    sun = (drives.candidate("sun"),)
    predictions = Predictions(Evaluations(drives.model), drives.modes)
    point = {sun[0].amplitudes[0]: 300.0}
    both = [predictions.predict([(sun, point)], [DRIVE])[0][0] for _ in range(2)]
    for item in both:
        np.testing.assert_array_equal(item, drives.model.predict(DRIVE, point))
    assert (predictions.reduced, predictions.simulated) == (0, 2)


def spoiled(modes: Modes) -> Modes:
    """Too few modes."""
    return Modes(modes.V[:, :4])


def test_a_model_that_is_off_is_found_out_and_not_used(drives: Drives) -> None:
    predictions = Predictions(Evaluations(drives.model), [spoiled(item) for item in drives.modes])
    point = drives.drawn(4)
    result = predictions.predict([((), point)], [DRIVE])[0][0]
    assert predictions.certificates[(), DRIVE].whitened_norm > DEFAULT.reduced_allowed
    np.testing.assert_array_equal(result, drives.model.predict(DRIVE, point))
    wanted = drives.unknowns[:3]
    J = predictions.jacobians([((), wanted, point)], [DRIVE])[0][0]
    np.testing.assert_array_equal(J, drives.model.jacobian(DRIVE, wanted, point))


def test_the_error_at_the_best_fit_is_that_of_models_that_gave_its_readings(drives: Drives) -> None:
    predictions = Predictions(Evaluations(drives.model), [spoiled(item) for item in drives.modes])
    point = drives.drawn(4)
    assert predictions.error_at((), point) == 0.0
    predictions.certificates[(), DRIVE] = DriveCertificate((), DRIVE, DEFAULT.reduced_allowed)
    assert predictions.error_at((), point) > DEFAULT.reduced_allowed
    assert not predictions.certificates[(), DRIVE].good


@pytest.mark.parametrize(
    ("verdict", "lead", "misfit", "allowed"),
    [
        (UNEXPLAINED, 300.0, 100.0, DEFAULT.reduced_allowed_far),
        (UNEXPLAINED, 30.0, 100.0, 3.0),
        (UNEXPLAINED, 30.0, 400.0, 1.5),
        (UNEXPLAINED, 3.0, 100.0, DEFAULT.reduced_allowed),
        (NO_GAP, 300.0, 100.0, DEFAULT.reduced_allowed),
    ],
)
def test_the_error_that_cannot_change_a_verdict_grows_with_its_lead(
    verdict: str, lead: float, misfit: float, allowed: float
) -> None:
    ranking = tuple(
        RankedSet((), score, 0.5, None, outside=outside)
        for score, outside in ((0.0, verdict == UNEXPLAINED), (-lead, False))
    )
    judgement = Judgement(verdict, ranking, {}, ranking, ())
    best = SimpleNamespace(misfit=misfit, readings=100, members=())
    result = SimpleNamespace(judgement=judgement, robustness=None, best=best)
    assert allowed_error(cast(Ranking, result), DEFAULT) == pytest.approx(allowed)


def diagnosed(drives: Drives, **options: Any) -> DiagnosisData:
    return drives.study.diagnose(settings=FEWER, known=drives.known, rerun=False, **options)


@pytest.fixture(scope="module")
def never(drives: Drives) -> DiagnosisData:
    return diagnosed(drives, reduced="never")


def test_the_verdict_is_that_of_simulations_alone(drives: Drives, never: DiagnosisData) -> None:
    auto = diagnosed(drives)
    assert auto.verdict == never.verdict == "identified"
    assert (
        [unknown.key for unknown in auto.best.members]
        == [unknown.key for unknown in never.best.members]
        == ["hot-road"]
    )
    # A fit ends when the misfit falls by less than least_reduction: the root of that, in standard deviations.
    assert auto.best.misfit == pytest.approx(never.best.misfit, abs=2 * DEFAULT.least_reduction)
    for unknown, x in never.best.values.items():
        assert abs(auto.best.values[unknown] - x) < np.sqrt(DEFAULT.least_reduction) * max(never.best.sd[unknown], 1e-9)
    assert auto.judgement.probability == pytest.approx(never.judgement.probability, abs=0.02)
    account = auto.to_dict()["reduced"]
    assert account["used"]
    # Beside what else may be wrong all points are simulated.
    assert account["points_by_reduced_models"] > account["points_by_lean_simulations"] / 3
    assert account["worst_whitened"] <= DEFAULT.reduced_allowed
    assert {unknown["run"] for unknown in account["certificates"]} == {"slow", "loaded", "fast"}
    assert never.to_dict()["reduced"]["points_by_reduced_models"] == 0


def test_where_the_best_fit_is_not_confirmed_everything_is_simulated(
    drives: Drives, never: DiagnosisData, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Predictions, "error_at", lambda *_: 2 * DEFAULT.reduced_allowed_far)
    result = diagnosed(drives)
    assert result.to_dict()["reduced"]["used"] is False
    assert result.best.log_evidence == pytest.approx(never.best.log_evidence, abs=1e-6)


PARTS: dict[str, dict[str, Any]] = {
    "exhaustive": {"strategy": Exhaustive()},
    "bic": {"criterion": BIC()},
    "few candidates": {"candidates": lambda study: catalogue_candidates(study)[:2]},
    "settings": {"settings": replace(FEWER, batch=1, singles=1)},
}


@pytest.mark.parametrize("parts", PARTS)
def test_the_parts_of_a_diagnosis_are_replaced_one_by_one(drives: Drives, never: DiagnosisData, parts: str) -> None:
    known = {} if parts == "few candidates" else {"known": drives.known}
    result = drives.study.diagnose(rerun=False, **known, **{"settings": FEWER, **PARTS[parts]})
    assert result.verdict == "identified"
    assert [unknown.key for unknown in result.best.members] == ["hot-road"]
    (amplitude,) = result.best.members[0].amplitudes
    assert result.best.values[amplitude] == pytest.approx(
        never.best.values[amplitude], abs=0.5 * never.best.sd[amplitude]
    )
    if parts == "exhaustive":
        assert all(unknown.fit is not None for unknown in result.judgement.ranking if not unknown.outside)
    if parts == "few candidates":
        assert len([candidate for candidate in result.candidates if not candidate.runs]) == 2


def test_a_keyword_that_is_none_is_refused(drives: Drives) -> None:
    with pytest.raises(TypeError, match="stratgy"):
        diagnosed(drives, stratgy=Exhaustive())


def test_a_word_that_is_no_choice_is_refused(drives: Drives) -> None:
    with pytest.raises(tf.InputError, match="reduced: must be 'auto' or 'never', not 'always'"):
        diagnosed(drives, reduced="always")


def test_no_modes_where_the_drive_itself_is_not_followed(drives: Drives) -> None:
    radiating = drives.study.replace({"effects": [{"name": "radiation", "emissivity": 0.9}]})
    assert "radiation" in catalogue()
    model = ForwardModel(radiating, drives.model.drives[:1], settings=FEWER)
    *_, V = model.response(0, drives.unknowns[:1])
    assert V.shape[1] == 0
    item = replace(drives.known[0], modes=Modes(V))
    predictions = Predictions(Evaluations(model), [item.modes])
    assert np.isfinite(predictions.predict([((), {})], [0])[0][0]).all()
    assert (predictions.reduced, predictions.simulated) == (0, 1)


def test_a_drive_that_its_model_cannot_march_is_left_to_simulations(
    drives: Drives, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ReducedDrive, "_integrated", lambda self, tyres: ([], []))
    model = ForwardModel(drives.study, drives.model.drives, settings=FEWER)
    predictions = Predictions(Evaluations(model), drives.modes)
    point = drives.drawn(5)
    result = predictions.predict([((), point)], [DRIVE])[0][0]
    np.testing.assert_array_equal(result, model.predict(DRIVE, point))
    assert not predictions.certificates[(), DRIVE].good
