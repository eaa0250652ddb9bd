"""Effects that begin or end within a phase: readings of a fit have a kink there, as those of a full run."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.diagnose.forward.fixed_step import fixed_step_run, on_grid

Array = NDArray[np.float64]
ENDS = 250.0
TIMES = np.array([150.0, 200.0, 240.0, 260.0, 300.0, 380.0])


def study(*effects: dict[str, Any]) -> tf.Study:
    """One sensor near the surface of the tread; a run of 400 s, mesh and elements of a fit."""
    changes = {
        "drive": {
            "speed": "20 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": "400 s",
        },
        "sensors": {"crown-outer": {"s": "0.60 in", "depth": "0.68 in"}},
        "mesh.size": "5 mm", "mesh.element": "P1", "numerics.tolerance": "0.02 delta_degC", "effects": list(effects),
    }  # fmt: skip
    return tf.study("example-validation").replace(changes)


def test_a_kink_within_a_phase_is_no_part_of_a_spline() -> None:
    times = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0])
    kinked = np.where(times < 4.0, times, 8.0 - times)
    grid = np.linspace(0.0, 7.0, 29)
    split = on_grid(times, kinked, (0.0, 4.0), grid, ends_only=True)
    np.testing.assert_allclose(split, np.where(grid < 4.0, grid, 8.0 - grid), atol=1e-12)
    assert np.abs(on_grid(times, kinked, (0.0,), grid, ends_only=True) - split).max() > 0.1


def test_a_flux_that_ends_cools_a_fit_as_much_as_a_full_run() -> None:
    cooled = {"name": "missing-flux", "surface": "tread", "into": "-8000 W/m**2", "ends": f"{ENDS} s"}
    changes = []
    for simulated in (False, True):
        histories = []
        for effects in ((), (cooled,)):
            if simulated:
                fit = fixed_step_run(study(*effects))
                assert fit.starts == ((0.0, ENDS) if effects else (0.0,))
                histories.append(np.interp(TIMES, fit.grid, fit.readings["crown-outer"]))
            else:
                readings = study(*effects).run().readings
                histories.append(np.interp(TIMES, readings["time_s"], readings["crown-outer"]))
        changes.append(histories[1] - histories[0])
    full, fixed = changes
    assert full.min() < -3.0
    assert np.abs(fixed - full).max() < 0.03 * np.abs(full).max()
