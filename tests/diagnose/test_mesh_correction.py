"""What a study's own mesh adds to the mesh of the fit, at points where it was not simulated."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.data.runs import MeasuredDrive
from tyrefem.diagnose.data.sensitivities import Sensitivities

START = 25.0
#: A sensor near the surface that hardly warms, in a steep gradient; two inside. Rise, and what the mesh adds, K.
OWN, ADDED = np.array([3.0, 20.0, 30.0]), np.array([1.4, -0.2, 0.3])


@pytest.fixture
def residuals() -> Residuals:
    study = cast(Any, SimpleNamespace(card=SimpleNamespace(drive=SimpleNamespace(initial=START))))
    study.at_run = lambda run, drive: study
    known = Sensitivities((), (), 0, (START + OWN,), (ADDED,), (np.zeros((3, 0)),))
    return Residuals(study, (MeasuredDrive("run", {}, False, ()),), known)


def added(residuals: Residuals, rise: np.ndarray) -> np.ndarray:
    return residuals.corrected(0, START + rise) - (START + rise)


def test_it_is_what_it_was_where_nothing_changed(residuals: Residuals) -> None:
    np.testing.assert_allclose(added(residuals, OWN), ADDED, rtol=1e-12)


def test_it_grows_with_the_heat(residuals: Residuals) -> None:
    np.testing.assert_allclose(added(residuals, 1.5 * OWN), 1.5 * ADDED, rtol=1e-12)


def test_a_warmer_surface_alone_does_not_make_it_larger(residuals: Residuals) -> None:
    # A hot road warms the surface fivefold: the gradient there, and with it what the mesh adds, stays about the same.
    result = added(residuals, OWN + np.array([12.0, 5.0, 3.0]))
    assert (np.abs(result - ADDED) < 0.3 * np.abs(ADDED)).all()


def test_a_tyre_that_cannot_be_stays_one(residuals: Residuals) -> None:
    assert np.isnan(residuals.corrected(0, np.full(3, np.nan))).all()
