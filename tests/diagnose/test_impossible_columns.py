"""Sensitivities at a fit leave out effects that cannot act beside those of the fit."""

from __future__ import annotations

import numpy as np

import tyrefem as tf
from tyrefem.diagnose.data.sensitivities import responses, unknowns_of
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import FOLLOWED, ForwardModel
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates


def test_a_second_swap_of_a_sensor_has_no_column_by_either_model() -> None:
    study = tf.study("hidden-effect", {"mesh.size": "12 mm"})
    model = ForwardModel(study, planned(study)[:1], settings=DiagnosisSettings(mesh_size="12 mm"))
    base = unknowns_of(study, list(study.sensors), ())[0][:4]
    (known,) = responses(Evaluations(model), base)
    swaps = [each.presence[0] for each in catalogue_candidates(study) if each.name == "swapped-channels"]
    first = swaps[0]
    shared = next(swap for swap in swaps[1:] if {*dict(first.choice).values()} & {*dict(swap.choice).values()})
    at = {first: 1.0, base[0]: 0.01}
    status, reduced = model.reduced_jacobian(0, known.modes, (*base, shared), at)
    simulated = model.jacobian(0, (*base, shared), at)
    assert status[0] == FOLLOWED
    for jacobian in (reduced, simulated):
        assert np.isnan(jacobian[:, -1]).all()
        assert np.isfinite(jacobian[:, :-1]).all()
    largest = np.abs(simulated[:, :-1]).max(axis=0)
    assert (np.abs(reduced - simulated)[:, :-1].max(axis=0) < 0.02 * largest.max()).all()


def test_a_number_at_its_limit_has_the_column_of_a_step_back() -> None:
    study = tf.study("hidden-effect", {"mesh.size": "12 mm", "materials.bead.loss_tangent.value": 9.95})
    model = ForwardModel(study, planned(study)[:1], settings=DiagnosisSettings(mesh_size="12 mm"))
    unknowns = unknowns_of(study, list(study.sensors), ())[0]
    loss = next(each for each in unknowns if each.key == "materials.bead.loss_tangent.value")
    (known,) = responses(Evaluations(model), [loss])
    # tan delta 9.99: a step of 1 % is beyond 10.
    status, reduced = model.reduced_jacobian(0, known.modes, [loss], {loss: 0.004})
    simulated = model.jacobian(0, [loss], {loss: 0.004})
    back = model.predict(0, {loss: 0.004}) - model.predict(0, {loss: 0.004 - loss.step})
    assert status[0] == FOLLOWED
    assert np.isnan(model.predict(0, {loss: 0.004 + loss.step})).all()
    for jacobian in (reduced, simulated):
        np.testing.assert_allclose(jacobian[:, 0], back / loss.step, rtol=0.02, atol=0.02 * np.abs(back).max() / 0.01)
