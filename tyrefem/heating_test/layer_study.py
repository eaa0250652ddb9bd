"""Layer study: one set of readings, fitted with one layer, two, three ..."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import counted
from tyrefem.errors import InputError
from tyrefem.heating_test.card import RigCard
from tyrefem.heating_test.grid import Fineness
from tyrefem.heating_test.identification import IdentificationData, identify
from tyrefem.heating_test.readings import HeatingTest
from tyrefem.heating_test.verdict import REMARK

if TYPE_CHECKING:
    import pandas as pd

#: Duration of the transient after a switch of the laser, s.
TRANSIENT = 300.0


def merged(card: RigCard, count: int) -> RigCard:
    """Merge neighbouring layers of a card until `count` are left, the thinnest pair first.

    Thicknesses are added; the prior conductivity is of layers in series; density and specific heat preserve mass and
    heat capacity. The relative standard deviations are the larger ones. Raises InputError if the card has fewer layers.

    >>> from tyrefem.heating_test.files import load
    >>> layer = merged(load("trtlab")[0], 1).layers[0]
    >>> layer.name, round(layer.thickness, 4), round(layer.conductivity.value, 3)
    ('tread+carcass', 0.015, 0.271)
    """
    if not 1 <= count <= len(card.layers):
        raise InputError(f"the card has {len(card.layers)} layers; {count} is not possible", field="layers")
    layers = list(card.layers)
    while len(layers) > count:
        pairs = [a.thickness + b.thickness for a, b in pairwise(layers)]
        i = int(np.argmin(pairs))
        layers[i : i + 2] = [_merged(layers[i], layers[i + 1])]
    return card.model_copy(update={"layers": tuple(layers)})


def _merged(a: Any, b: Any) -> Any:
    total = a.thickness + b.thickness
    mass = a.thickness * a.density.value + b.thickness * b.density.value
    heat = sum(layer.thickness * layer.density.value * layer.specific_heat.value for layer in (a, b))
    k = total / sum(layer.thickness / layer.conductivity.value for layer in (a, b))

    source = f"mean of {a.name} and {b.name}"

    def changed(key: str, value: float) -> Any:
        sd = max(getattr(a, key).relative_sd, getattr(b, key).relative_sd)
        return getattr(a, key).model_copy(update={"value": value, "source": source, "relative_sd": sd})

    return a.model_copy(
        update={
            "name": f"{a.name}+{b.name}",
            "thickness": total,
            "thickness_sd": math.hypot(a.thickness_sd, b.thickness_sd),
            "density": a.density.model_copy(update={"value": mass / total, "source": source}),
            "conductivity": changed("conductivity", k),
            "specific_heat": changed("specific_heat", heat / mass),
        }
    )


@dataclass(frozen=True, eq=False)
class LayerStudy:
    """Fits of one set of readings with growing numbers of layers.

    Attributes
    ----------
    counts : number of layers of each fit. fits : results of the fits.
    """

    counts: tuple[int, ...]
    fits: tuple[IdentificationData, ...]

    def table(self) -> pd.DataFrame:
        """One row per fit: misfit without noise, K, in transients after a switch of the laser and later; rms; evidence.

        The misfit is the root of the mean product of neighbouring residuals, where independent noise cancels.
        """
        import pandas as pd

        rows = []
        for count, fit in zip(self.counts, self.fits, strict=True):
            early, late = _misfits(fit)
            rows.append(
                {
                    "layers": count,
                    "names": " | ".join(layer.name for layer in fit.card.layers),
                    "transient_misfit_K": early,
                    "steady_misfit_K": late,
                    "rms_K": float(np.sqrt(np.mean(np.concatenate([b.residual**2 for b in fit.fit.blocks])))),
                    "model_error": max(fit.fit.noise.model.values()),
                    "log_evidence": fit.fit.evidence - self.fits[0].fit.evidence,
                    "determined": _with_verdict(fit, "determined"),
                    "doubtful": _with_verdict(fit, "doubtful"),
                    "properties": len(fit.properties),
                }
            )
        return pd.DataFrame(rows)

    @property
    def words(self) -> tuple[str, ...]:
        """A line on each fit whose model misses the readings; empty without any."""
        return tuple(
            f"{counted(count, 'layer')}: {REMARK['doubtful']}"
            for count, fit in zip(self.counts, self.fits, strict=True)
            if _with_verdict(fit, "doubtful")
        )


def _with_verdict(fit: IdentificationData, verdict: str) -> int:
    """Number of conductivities and specific heats with this verdict."""
    return sum(estimate.verdict == verdict for estimate in fit.properties)


def _misfits(fit: IdentificationData) -> tuple[float, float]:
    """Root of the mean product of neighbouring residuals of all sensors, K: in transients, and in the rest.

    NaN for a part without readings: a short test is all transient.
    """
    phases = fit.card.phases
    switches = (phases.idle, phases.idle + phases.heating)
    early, late = [], []
    for block in fit.fit.blocks:
        t, r = block.series.times[1:], block.residual
        soon = np.any([(t > s) & (t <= s + TRANSIENT) for s in switches], axis=0)
        product = r[1:] * r[:-1]
        early.append(product[soon])
        late.append(product[~soon])
    first, second = (_root_of_mean(np.concatenate(part)) for part in (early, late))
    return first, second


def _root_of_mean(products: Any) -> float:
    """NaN without any."""
    return max(float(np.mean(products)), 0.0) ** 0.5 if products.size else math.nan


def study(
    card: RigCard,
    tests: Sequence[HeatingTest],
    counts: Sequence[int],
    fineness: Fineness | None = None,
    progress: Callable[[int], None] | None = None,
) -> LayerStudy:
    """Fit the tests with each number of layers, properties constant in temperature."""
    by_count: dict[int, IdentificationData] = {}
    for count, fit in fits(card, tests, counts, fineness):
        by_count[count] = fit
        if progress:
            progress(count)
    return LayerStudy(tuple(by_count), tuple(by_count.values()))


def fits(
    card: RigCard,
    tests: Sequence[HeatingTest],
    counts: Sequence[int],
    fineness: Fineness | None = None,
) -> Iterator[tuple[int, IdentificationData]]:
    """Yield the number of layers and its fit, as soon as each fit is finished."""
    for count in counts:
        yield count, identify(merged(card, count), tests=tests, linear=False, fineness=fineness)
