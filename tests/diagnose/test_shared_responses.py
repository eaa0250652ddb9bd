"""Diagnoses of one layout share the responses to heat over time: they depend on no readings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.diagnose.forward import source_responses as responses
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.unknowns.unknown import Unknown


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[list[Unknown]]:
    """The sources of each computation of histories, which is otherwise unchanged."""
    asked: list[list[Unknown]] = []
    original = responses._histories

    def histories(
        base: object, sensors: Sequence[str], sources: Sequence[Unknown], knots: object
    ) -> dict[Unknown, NDArray[np.float64]]:
        asked.append(list(sources))
        return original(base, sensors, sources, knots)  # type: ignore[arg-type]

    monkeypatch.setattr(responses, "_histories", histories)
    responses._HISTORIES.clear()
    return asked


def test_a_second_model_of_the_layout_computes_only_what_is_new(computed: list[list[Unknown]]) -> None:
    study = tf.study("example-validation")
    settings = DiagnosisSettings(mesh_size="8 mm")
    sources = patches(study, settings)[:3]
    knots = tuple(np.linspace(0.0, 600.0, 4))

    def model() -> ForwardModel:
        return ForwardModel(study, planned(study)[:1], settings=settings)

    first = model().source_responses(0, sources[:2], knots)
    again = model().source_responses(0, sources[:2], knots)
    more = model().source_responses(0, sources, knots)
    assert [len(each) for each in computed] == [2, 0, 1]
    assert np.array_equal(first, again)
    assert np.array_equal(more[:, :2], first)
    responses._HISTORIES.clear()
    assert model().source_responses(0, sources, knots) == pytest.approx(more, rel=1e-9, abs=1e-15)


def test_other_drives_and_knots_have_other_responses(computed: list[list[Unknown]]) -> None:
    study = tf.study("example-validation")
    settings = DiagnosisSettings(mesh_size="8 mm")
    sources = patches(study, settings)[:1]

    def response(speed: str, last: float) -> NDArray[np.float64]:
        driven = study.replace({"drive.phases.0.speed": speed})
        model = ForwardModel(driven, planned(driven)[:1], settings=settings)
        return model.source_responses(0, sources, tuple(np.linspace(0.0, last, 4)))

    slow, fast, short = response("5 m/s", 600.0), response("20 m/s", 600.0), response("5 m/s", 500.0)
    assert [len(each) for each in computed] == [1, 1, 1]
    scale = np.abs(slow).max()
    assert np.abs(fast - slow).max() > 1e-3 * scale
    assert np.abs(short - slow).max() > 1e-2 * scale
