"""Identification of every layer's conductivity and specific heat from measured tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.heating_test.card import RigCard
from tyrefem.heating_test.files import load
from tyrefem.heating_test.files import tables as beside
from tyrefem.heating_test.fit import Fitter, RigFit
from tyrefem.heating_test.grid import USUAL, Fineness
from tyrefem.heating_test.noise import Noise, estimated, missed, normal
from tyrefem.heating_test.parameters import PROPERTY, RIG, SLOPE, Parameters, parameters_of
from tyrefem.heating_test.readings import HeatingTest, read
from tyrefem.heating_test.selection import ParameterEstimate, Selection, estimate_of, select
from tyrefem.heating_test.twin import Twin
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class IdentificationData(Brief):
    """Properties of a rig's layers, identified from its tables.

    Attributes
    ----------
    card, file : the rig. tests : the measured tests.
    fit : the most probable parameters. selection : properties that are linear in temperature.
    estimates : one per free parameter, properties first, with 95 % intervals.
    correlation : (n, n) of the estimates' coordinates, in their order.
    """

    card: RigCard
    file: Path | None
    tests: tuple[HeatingTest, ...]
    fit: RigFit
    selection: Selection
    estimates: tuple[ParameterEstimate, ...]
    correlation: Array

    def _title(self) -> str:
        return self.card.title

    def _facts(self) -> Mapping[str, Any]:
        rows = {
            estimate.name: f"{estimate.value:.4g} {estimate.unit} ({estimate.low:.4g} to {estimate.high:.4g}), "
            f"{estimate.verdict}"
            for estimate in self.properties
        }
        return {"tests": [test.name for test in self.tests], **rows}

    @cached_property
    def by_name(self) -> dict[str, ParameterEstimate]:
        """Name -> estimate."""
        return {estimate.name: estimate for estimate in self.estimates}

    @property
    def properties(self) -> tuple[ParameterEstimate, ...]:
        """Conductivity and specific heat of every layer."""
        return tuple(estimate for estimate in self.estimates if estimate.group == PROPERTY)

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per parameter: value, 95 % interval, relative sd, prior, and posterior sd over prior sd."""
        import pandas as pd

        return pd.DataFrame([estimate.to_dict() for estimate in self.estimates])


def identify(
    rig: str | Path | RigCard,
    tables: Iterable[str | Path] = (),
    *,
    tests: Sequence[HeatingTest] = (),
    without: Sequence[str] = (),
    linear: bool = True,
    fineness: Fineness | None = None,
    progress: Callable[[], None] | None = None,
) -> IdentificationData:
    """Identify conductivity and specific heat of every layer of a rig from measured tables.

    Minimises |C^(-1/2) (measured - computed)|^2 + |x|^2 over the coordinates x of all uncertain numbers; C is the
    covariance of noise and model error (`tyrefem.heating_test.noise`), the priors of x are N(0, 1). Several tests are
    fitted together. Intervals are Laplace's, averaged over the models with constant and linear properties.

    Parameters
    ----------
    rig : name, path or card.
    tables : CSV files or workbooks whose runs have the card's names; default: CSV files beside the card.
    tests : tests already read, instead of tables.
    without : sensors that the tables need not have.
    linear : allow properties that are linear in temperature, if the evidence supports them.
    fineness : fineness of the mesh. progress : called after every computed test.

    Raises InputError if the card or a table cannot be used.
    """
    card, file = (rig, None) if isinstance(rig, RigCard) else load(rig)
    heating_tests = tuple(tests) or read(card, tables if file is None else beside(card, file, tables), without)
    # The matrices are too small for threads: on a busy machine, waiting for threads takes longer than the work.
    with one_thread():
        sensors = tuple(dict.fromkeys(series.sensor for test in heating_tests for series in test.series))
        fitter = Fitter(Twin(card, sensors, fineness or USUAL), heating_tests, progress)
        return _identified(card, file, fitter, linear)


def _identified(card: RigCard, file: Path | None, fitter: Fitter, linear: bool) -> IdentificationData:
    """Make a rough fit to find properties with a slope; then alternate fit and selection until both agree."""
    sensors = fitter.twin.sensors
    every = parameters_of(card, sensors, [test.name for test in fitter.tests])
    slopes = {parameter.name for parameter in every.free if parameter.group == SLOPE}
    if not linear:
        every, slopes = every.without(slopes), set()
    noise = Noise(
        {name: card.sensors[name].noise for name in sensors},
        dict.fromkeys(sensors, max(2 * card.model_error, 1e-4)),
    )
    chosen: tuple[str, ...] = ()
    x = np.zeros(len(every))
    tried: set[tuple[str, ...]] = set()
    rough = True
    while True:
        used = every.without(slopes - set(chosen))
        keep = np.array([name in used.names for name in every.names])
        fit = fitter.fit(used, x[keep], noise, card.model_error, rough=rough)
        x = np.zeros(len(every))
        x[keep] = fit.x
        noise, selection = _weighed(fitter, every, x, fit, card.model_error)
        if not rough:
            tried.add(chosen)
            if selection.chosen in tried or len(tried) == 3:
                break
        rough, chosen = False, selection.chosen
    # Fit and selection may alternate without end: the slopes are those of the fit.
    return _result(card, file, fitter.tests, fit, replace(selection, chosen=chosen), keep)


def _weighed(fitter: Fitter, every: Parameters, x: Array, fit: RigFit, floor: float) -> tuple[Noise, Selection]:
    """The noise with every slope free, and the selection of slopes with it."""
    predicted = fitter.predict(every, x)
    blocks = fitter.blocks(every, x, predicted)
    noise = estimated(blocks, x, fit.noise, floor)
    return noise, select(every, normal(blocks, noise), x)


def _result(
    card: RigCard,
    file: Path | None,
    tests: tuple[HeatingTest, ...],
    fit: RigFit,
    selection: Selection,
    keep: Array,
) -> IdentificationData:
    """The result, with intervals from the spread of the combinations and the fit's distance from their mean."""
    away = selection.mean[keep] - fit.x
    mixed = selection.covariance[np.ix_(keep, keep)] + np.outer(away, away)
    # The averaged spread may widen the fitted model's intervals, but not narrow them.
    widen = np.sqrt(np.maximum(np.diag(mixed) / np.diag(fit.covariance), 1.0))
    covariance = fit.covariance * np.outer(widen, widen)
    groups = (PROPERTY, SLOPE, RIG)
    order = sorted(range(len(fit.parameters)), key=lambda i: groups.index(fit.parameters.free[i].group))
    sd = np.sqrt(np.diag(covariance))
    correlation = (covariance / np.outer(sd, sd))[np.ix_(order, order)]
    estimates = tuple(estimate_of(fit.parameters.free[i], float(fit.x[i]), float(sd[i])) for i in order)
    if missed(fit.noise, fit.blocks):
        estimates = tuple(replace(each, doubtful=each.group == PROPERTY) for each in estimates)
    return IdentificationData(card, file, tests, fit, selection, estimates, correlation)
