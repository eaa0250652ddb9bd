"""What the readings could and could not determine, in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.heating_test.parameters import PROPERTY, RIG, SLOPE
from tyrefem.heating_test.selection import POOR, ParameterEstimate

if TYPE_CHECKING:
    from tyrefem.heating_test.identification import IdentificationData

#: Correlations beyond this bind two properties together.
BOUND = 0.95
#: A model error (relative to the rise) beyond this is worth a warning, and a temperature at which rubber changes, degC.
ASTRAY, HOT = 0.01, 200.0


def spoken(name: str) -> str:
    """A parameter's name in words.

    >>> spoken("tread.specific_heat_slope"), spoken("outer_film")
    ('specific heat slope of tread', 'outer film')
    """
    owner, _, key = name.rpartition(".")
    return f"{key.replace('_', ' ')} of {owner}" if owner else key.replace("_", " ")


def shown(estimate: ParameterEstimate, digits: int = 3) -> str:
    """Value and interval, e.g. ``0.282 (0.272 to 0.293) W/m/K``."""
    unit = "" if estimate.unit == "1" else f" {estimate.unit}"
    return f"{estimate.value:.{digits}g} ({estimate.low:.{digits}g} to {estimate.high:.{digits}g}){unit}"


def sentences(identification: IdentificationData) -> tuple[str, ...]:
    """The verdict, most important first; empty of complaints where everything is determined."""
    unknown = [estimate for estimate in identification.properties if estimate.verdict == "not determined"]
    poor = [estimate for estimate in identification.properties if estimate.verdict == "poor"]
    out = [
        f"NOT DETERMINED: {spoken(estimate.name)}. {estimate.share_left:.0%} of the first guess's uncertainty is left; "
        f"the value {shown(estimate)} is mostly that guess."
        for estimate in unknown
    ]
    out += [
        f"POORLY DETERMINED: {spoken(estimate.name)}, {shown(estimate)}: relative standard deviation above {POOR:.0%}."
        for estimate in poor
    ]
    if unknown or poor:
        out += _reasons(identification)
    else:
        out.append("All conductivities and specific heats are determined by the readings.")
    out += _bound(identification)
    left = [
        spoken(estimate.name)
        for estimate in identification.estimates
        if estimate.group == RIG and estimate.share_left > 0.7
    ]
    if left:
        out.append(
            f"Taken from the card, as the readings say little about them: {', '.join(left)}. "
            "Their uncertainty is inside the intervals."
        )
    out += _linear(identification)
    out += _misfit(identification)
    return tuple(out)


def _reasons(identification: IdentificationData) -> Iterator[str]:
    """Why something is not determined, as far as the test itself tells."""
    sensors = {series.sensor for test in identification.tests for series in test.series}
    faces = {identification.card.sensors[name].face for name in sensors}
    for face in ("inner", "outer"):
        if face not in faces:
            yield f"There is no view of the {face} face."
    phases = identification.card.phases
    heated = max(min(test.clock.end - phases.idle, phases.heating) for test in identification.tests)
    crossing = 0.0
    for layer in identification.card.layers:
        k, c = (identification.fit.values[f"{layer.name}.{key}"] for key in ("conductivity", "specific_heat"))
        crossing += layer.thickness / np.sqrt(k / (layer.density.value * c))
    if heated < crossing**2:
        yield (
            f"The test is short: {heated:.0f} s of heating were read, while heat takes about {crossing**2:.0f} s "
            "(thickness squared over diffusivity) to come through the layers."
        )
    if all(test.clock.end <= phases.idle + phases.heating for test in identification.tests) and phases.cooling > 0:
        yield "The cooling phase was not read."


def _bound(identification: IdentificationData) -> Iterator[str]:
    properties = [i for i, estimate in enumerate(identification.estimates) if estimate.group == PROPERTY]
    for a in properties:
        for b in properties:
            r = identification.correlation[a, b]
            if a < b and abs(r) > BOUND:
                pair = f"{spoken(identification.estimates[a].name)} and {spoken(identification.estimates[b].name)}"
                known = "ratio" if r > 0 else "product"
                yield f"{pair} are known better together (correlation {r:+.2f}): their {known} is the firmer."


def _linear(identification: IdentificationData) -> Iterator[str]:
    chosen = identification.selection.chosen
    for estimate in identification.estimates:
        if estimate.group == SLOPE:
            key = spoken(estimate.name).replace(" slope", "")
            p = identification.selection.probability.get(estimate.name, 1.0)
            yield (
                f"Linear in temperature: {key} changes by {100 * estimate.value:+.3f} %/K "
                f"({100 * estimate.low:+.3f} to {100 * estimate.high:+.3f}; probability {p:.2f})."
            )
    if not chosen and identification.selection.probability:
        yield "No property needs to be linear in temperature: constants have the better evidence."
    for name, p in identification.selection.probability.items():
        if name not in chosen and p > 0.25:
            key = spoken(name).replace(" slope", "")
            yield f"Undecided: {key} may be linear in temperature (probability {p:.2f}); the intervals allow for it."


def _misfit(identification: IdentificationData) -> Iterator[str]:
    for name, error in identification.fit.noise.model.items():
        if error > ASTRAY:
            yield (
                f"The model misses about {error:.1%} of the rise at '{name}', slowly varying: something it lacks "
                "or a wrong number in the card. The intervals are widened for it."
            )
    for block in identification.fit.blocks:
        series = block.series
        noise = identification.card.sensors[series.sensor].noise
        ratio = float(np.sqrt(np.mean(block.residual**2 * series.counts))) / noise
        if ratio > 1.5:
            yield f"Run '{series.test}', sensor '{series.sensor}': residuals are {ratio:.1f} times the stated noise."
    hottest = max(float(block.computed.max()) for block in identification.fit.blocks)
    if hottest > HOT:
        yield f"A sensor reads {hottest:.0f} degC: rubber changes at such temperatures, and the properties with it."
