"""What a row of a comparison says: deviation, uncertainty and a verdict in words."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.history import History
from tyrefem.compare.uncertainty import uncertainty

WITHIN = "within validation uncertainty: model error not resolved"
COLUMNS = (
    "run", "sensor", "phase", "hold_out", "n", "n_effective", "bias_K", "rms_K", "largest_K", "at_s",
    "u_num_K", "u_input_K", "u_data_K", "u_val_K", "u_reading_K", "beyond", "verdict",
)  # fmt: skip


def row(history: History, phase: str, mask: NDArray[np.bool_], k: float) -> tuple[dict[str, Any], dict[str, float]]:
    """The row of one sensor, run and phase, and the change (K) of its mean with each uncertain input.

    The mean deviation is judged against k u_val. A deviation that changes sign within the phase has a small mean,
    so the rms is judged too, against k times the uncertainty of single readings (noise not averaged).
    """
    error = history.error[mask]
    given = uncertainty(history, mask)
    bias, rms = float(error.mean()), math.sqrt(float((error**2).mean()))
    reading = math.sqrt(float((history.reading_uncertainty[mask] ** 2).mean()))
    worst = int(np.abs(error).argmax())
    values = (
        history.run, history.sensor, phase, history.hold_out, len(error), given.n_effective, bias, rms,
        float(error[worst]), float(history.times[mask][worst]), given.numerical, given.input, given.data,
        given.validation, reading, *verdict(bias, rms, given.validation, reading, k),
    )  # fmt: skip
    return dict(zip(COLUMNS, values, strict=True)), given.inputs


def verdict(bias: float, rms: float, u_val: float, u_reading: float, k: float) -> tuple[bool, str]:
    """Whether the model is in error beyond its uncertainty, and what can be said of that error.

    |E| <= k u_val: the model's error is hidden by the uncertainty. Else it lies in E +/- k u_val.

    Source: ASME V&V 20-2009; the test of the rms is an addition for histories.

    >>> verdict(0.4, 0.6, 0.3, 0.6, 2.0)
    (False, 'within validation uncertainty: model error not resolved')
    >>> verdict(5.0, 5.1, 0.3, 0.6, 2.0)
    (True, 'model error of about +5.00 ± 0.60 K')
    >>> verdict(0.1, 3.0, 0.3, 0.6, 2.0)
    (True, 'model error of about 3.00 K rms that changes sign: the mean is within validation uncertainty')
    """
    if abs(bias) > k * u_val:
        return True, f"model error of about {bias:+z.2f} ± {k * u_val:.2f} K"
    if rms > k * u_reading:
        changing = "that changes sign: the mean is within validation uncertainty"
        return True, f"model error of about {rms:.2f} K rms {changing}"
    return False, WITHIN
