"""Certificate of a model of settings: its differences to full runs that were not used in training."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tyrefem.brief import Brief
from tyrefem.realtime.box_runs import FullHistory
from tyrefem.realtime.setting_solution import Solution
from tyrefem.reduced.model import ReducedModel

#: Outputs and answers that are powers, pressures or forces.
_OTHERS = re.compile(
    r"(generated|lost): .*|generated|stored|lost and stored|gas_pressure(_Pa)?|rolling_resistance(_N|_coefficient)?"
)


@dataclass(frozen=True, eq=False)
class BoxCertificate(Brief):
    """Largest differences between a model of settings and full runs that were not used in training.

    Parameters
    ----------
    errors : output or answer -> K, Pa, N, W or 1. field : at any node and reading, K. worst : of all temperatures, K.
    tolerance : allowed, K. cases : full runs. trained_on : runs and corrections. products : part -> largest relative
        error of its product of factors.
    """

    errors: Mapping[str, float]
    field: float
    worst: float
    tolerance: float
    cases: int
    trained_on: int
    products: Mapping[str, float]


def certified(
    model: ReducedModel,
    pairs: Sequence[tuple[Solution, FullHistory]],
    tolerance: float,
    trained_on: int,
    products: Mapping[str, float],
) -> BoxCertificate:
    """The certificate from pairs (model, full run)."""
    errors: dict[str, float] = {}
    field = 0.0
    for solution, full in pairs:
        for name, error in differences(solution, full).items():
            errors[name] = max(errors.get(name, 0.0), error)
        field = max(field, field_difference(model, solution, full))
    worst = max([field, *(error for name, error in errors.items() if is_temperature(name))])
    return BoxCertificate(errors, field, worst, tolerance, len(pairs), trained_on, dict(products))


def is_temperature(name: str) -> bool:
    """Is an output or answer a temperature?

    >>> [is_temperature(name) for name in ("crown-inner_degC", "lost-1", "lost: rim", "rolling_resistance_N")]
    [True, True, False, False]
    """
    return _OTHERS.fullmatch(name) is None


def field_difference(model: ReducedModel, solution: Solution, full: FullHistory) -> float:
    """Largest difference at any node at the readings, K."""
    size, T = model.size, solution.tyre.arrays["turn"]
    states = np.array([solution.state(float(t)) for t in full.times])
    fields = states[:, :size] @ (model.V @ T[:size, :size]).T
    return float(np.abs(fields - full.values).max())


def differences(solution: Solution, full: FullHistory) -> dict[str, float]:
    """Output or answer -> largest difference to a full run over its readings.

    At the start of a phase a full run states the power before the jump; there powers are left out.
    """
    shown = [solution.at(float(t)) for t in full.times]
    errors = {}
    for name, series in full.series.items():
        if name not in shown[0]:
            continue
        off = np.abs(np.array([values[name] for values in shown]) - series)
        first = 0 if is_temperature(name) else 1
        errors[name] = float(off[first:].max(initial=0.0))
    # Highest values of a rim and of the contained air are no answers of a full run, but in its readings.
    answers = {f"{name}_max_degC": float(series.max()) for name, series in full.series.items()} | dict(full.answers)
    # The rolling resistance coefficient is an output and an answer.
    return errors | {
        name: max(abs(value - float(answers[name])), errors.get(name, 0.0))
        for name, value in solution.answers.items()
        if name in answers
    }
