"""The readings of a run without its heat budget: the same numbers."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.simulation.run import run, run_readings

pytestmark = pytest.mark.fast
COARSE = {"mesh.size": "12 mm", "drive.duration": "90 s"}
LUMPED = {"boundaries.rim": {"law": "lumped", "mass": "2 kg", "cooling": "1 W/K"}}
LATE = {"effects": [{"name": "clock-offset", "late": "7 s"}]}


@pytest.mark.parametrize("changes", [{}, LUMPED, LATE], ids=["plain", "lumped rim", "late clock"])
def test_readings_alone_are_those_of_the_run(changes: dict[str, object]) -> None:
    study = tf.study("nasa-22x5.5-8pr", {**COARSE, **changes})
    alone, whole = run_readings(study), run(study).reading_columns
    assert list(alone) == list(whole)
    assert len(alone) > 2
    for name, column in whole.items():
        np.testing.assert_array_equal(alone[name], column)


def test_temperatures_alone_check_their_numbers_as_a_transient_does() -> None:
    problem = run(tf.study("nasa-22x5.5-8pr", {**COARSE, "drive.duration": "10 s"})).tyre.problem
    with pytest.raises(InputError, match="strictly increasing"):
        problem.temperatures([0.0, 0.0])
    with pytest.raises(InputError, match="must be positive"):
        problem.temperatures([0.0, 1.0], tolerance=-1.0)
