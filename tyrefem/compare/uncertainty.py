"""The validation uncertainty of a mean deviation by ASME V&V 20, and the rows of a comparison."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.history import Array, SensorHistory


def effective_number(errors: Array) -> float:
    """The effective number of independent readings of a correlated series.

    n_eff = n (1 - r1) / (1 + r1), 1 <= n_eff <= n, with r1 the lag-1 autocorrelation about the mean. A drift of the
    deviation also raises r1, so n_eff is a low estimate.

    Parameters
    ----------
    errors : (n,) K, in the order of time.

    Source: Zwiers & von Storch, J. Climate 8 (1995) 336-351.

    >>> effective_number(np.array([1.0, -1.0, 1.0, -1.0]))
    4.0
    >>> round(effective_number(np.array([1.0, 1.0, -1.0, -1.0])), 3)    # r1 = 1/4
    2.4
    """
    number = len(errors)
    centred = errors - errors.mean()
    variance = float(centred @ centred)
    # A scatter below rounding has no information on correlation.
    if number < 2 or variance <= number * (1e-12 * (1.0 + float(np.abs(errors).max()))) ** 2:
        return float(number)
    correlation = float(centred[:-1] @ centred[1:]) / variance
    return float(np.clip(number * (1.0 - correlation) / (1.0 + correlation), 1.0, number))


@dataclass(frozen=True)
class Uncertainty:
    """Standard uncertainties (K) of the mean deviation over n readings.

    u_val^2 = u_num^2 + u_input^2 + u_D^2

    Parameters
    ----------
    n_effective : independent readings.
    numerical : u_num, time steps and mesh together.
    inputs : dotted key -> change of the mean (K) when that input is one sd higher.
    noise, accuracy, position : the parts of u_D.

    Source: ASME V&V 20-2009, Standard for Verification and Validation in Computational Fluid Dynamics and
    Heat Transfer.

    >>> u = Uncertainty(4.0, numerical=0.3, inputs={"k": 0.4, "h": -1.2}, noise=1.0, accuracy=0.0, position=0.0)
    >>> round(u.input, 4), u.data, round(u.validation, 4)     # sqrt(0.09 + 1.6 + 0.25)
    (1.2649, 0.5, 1.3928)
    """

    n_effective: float
    numerical: float
    inputs: dict[str, float]
    noise: float
    accuracy: float
    position: float

    @property
    def input(self) -> float:
        """u_input, root sum of squares over the inputs."""
        return math.hypot(*self.inputs.values())

    @property
    def data(self) -> float:
        """u_D; only the noise decreases with the number of independent readings."""
        return math.hypot(self.noise / math.sqrt(self.n_effective), self.accuracy, self.position)

    @property
    def validation(self) -> float:
        """u_val."""
        return math.hypot(self.numerical, self.input, self.data)


def uncertainty(history: SensorHistory, mask: NDArray[np.bool_]) -> Uncertainty:
    """The uncertainties of the mean deviation over the masked readings of a history."""
    return Uncertainty(
        n_effective=effective_number(history.error[mask]),
        numerical=history.numerical,
        inputs={key: float(change[mask].mean()) for key, change in history.changes.items()},
        noise=history.noise,
        accuracy=history.accuracy,
        position=history.position_sd * float(history.gradient[mask].mean()),
    )


WITHIN = "within validation uncertainty: model error not resolved"
COLUMNS = (
    "run", "sensor", "phase", "hold_out", "n", "n_effective", "bias_K", "rms_K", "largest_K", "at_s",
    "u_num_K", "u_input_K", "u_data_K", "u_val_K", "u_reading_K", "beyond", "verdict",
)  # fmt: skip


def row(
    history: SensorHistory, phase: str, mask: NDArray[np.bool_], k: float
) -> tuple[dict[str, Any], dict[str, float]]:
    """The row of one sensor, run and phase, and the change (K) of its mean with each uncertain input.

    The mean deviation is compared with k u_val. A deviation that changes sign within the phase has a small mean, so the
    rms is compared too, with k times the uncertainty of single readings.
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
    """Whether the deviation is beyond the uncertainty, and the verdict as text.

    |E| <= k u_val: the uncertainty hides the model error. Otherwise the model error lies in E +/- k u_val.

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
