"""Sentences on the parameters that the readings determine, and on those that they do not."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.heating_test.noise import ASTRAY, highest_rise, missed
from tyrefem.heating_test.parameters import PROPERTY, RIG, SLOPE
from tyrefem.heating_test.selection import POOR, ParameterEstimate

if TYPE_CHECKING:
    from tyrefem.heating_test.identification import IdentificationData

#: Correlation above which two properties are reported as dependent.
BOUND = 0.95
#: Temperature at which rubber changes, degC.
HOT = 200.0
#: What a verdict between "determined" and "not determined" means.
REMARK = {"poor": "poorly determined by the readings", "doubtful": "doubtful: the model does not describe the readings"}
#: Standard deviations of the card from which on an identified number is reported as unusual.
UNUSUAL = 3.0
#: Time beside a switch of the laser in which a wrong clock shows most, s.
SOON = 60.0


def name_in_words(name: str) -> str:
    """A parameter's name in words.

    >>> name_in_words("tread.specific_heat_slope"), name_in_words("outer_film")
    ('specific heat slope of tread', 'outer film')
    """
    owner, _, key = name.rpartition(".")
    return f"{key.replace('_', ' ')} of {owner}" if owner else key.replace("_", " ")


def shown(estimate: ParameterEstimate, digits: int = 3) -> str:
    """Text of value and interval, e.g. ``0.282 (0.272 to 0.293) W/m/K``."""
    unit = "" if estimate.unit == "1" else f" {estimate.unit}"
    return f"{estimate.value:.{digits}g} ({estimate.low:.{digits}g} to {estimate.high:.{digits}g}){unit}"


def sentences(identification: IdentificationData) -> tuple[str, ...]:
    """Sentences of the verdict, most important first."""
    astray = list(_misfit(identification))
    doubtful = [estimate for estimate in identification.properties if estimate.verdict == "doubtful"]
    unknown = [estimate for estimate in identification.properties if estimate.verdict == "not determined"]
    poor = [estimate for estimate in identification.properties if estimate.verdict == "poor"]
    out = [*_doubt(identification), *astray] if doubtful else []
    out += [f"NOT DETERMINED: {name_in_words(estimate.name)}. {_left_words(estimate)}" for estimate in unknown]
    out += [
        f"POORLY DETERMINED: {name_in_words(estimate.name)}, {shown(estimate)}: "
        f"relative standard deviation above {POOR:.0%}."
        for estimate in poor
    ]
    if unknown or poor:
        out += _reasons(identification)
    elif not doubtful:
        out.append("The readings determine all conductivities and specific heats.")
    out += _bound(identification)
    out += _unusual(identification)
    left = [
        name_in_words(estimate.name)
        for estimate in identification.estimates
        if estimate.group == RIG and estimate.share_left > 0.7
    ]
    if left:
        out.append(
            f"Taken from the card, because the readings hardly change them: {', '.join(left)}. "
            "The intervals include their uncertainty."
        )
    out += _linear(identification)
    return tuple(out if doubtful else [*out, *astray])


def _doubt(identification: IdentificationData) -> Iterator[str]:
    """That the model misses the readings of a sensor, and what to look for."""
    phases, sensors = identification.card.phases, missed(identification.fit.noise, identification.fit.blocks)
    yield (
        f"DOUBTFUL: the model does not describe the readings of {' and '.join(sensors)}; conductivities and specific "
        "heats may be wrong by more than their intervals. Look at the residuals first. Usual reasons: spot diameter or "
        "profile, moving air, a camera's emissivity, layers left out or in another order, gaps between layers."
    )
    switches = np.array([phases.idle, phases.idle + phases.heating])
    for block in identification.fit.blocks:
        if block.series.sensor in sensors and phases.clock_sd == 0:
            worst = float(block.series.times[np.argmax(np.abs(block.residual))])
            if np.abs(worst - switches).min() < SOON:
                yield (
                    f"Run '{block.series.test}': the largest residual, at {worst:.0f} s, is beside a switch of the "
                    'laser. Is the clock right? With phases.clock_sd = "10 s" it is fitted, too.'
                )


def _left_words(estimate: ParameterEstimate) -> str:
    """What the readings leave of the prior uncertainty; a misfit widens the interval, even beyond that of the card."""
    if estimate.share_left > 1:
        return (
            f"By these readings it is {shown(estimate)}: less certain than on the card, because they contradict the "
            "model or one another."
        )
    left = f"{estimate.share_left:.0%} of the prior uncertainty remains"
    return f"{left}; the value {shown(estimate)} is mostly the prior value."


def _reasons(identification: IdentificationData) -> Iterator[str]:
    """Reasons in the test why a property is not determined."""
    sensors = {series.sensor for test in identification.tests for series in test.series}
    faces = {identification.card.sensors[name].face for name in sensors}
    for face in ("inner", "outer"):
        if face not in faces:
            yield f"No sensor measures the {face} face."
    phases = identification.card.phases
    heated = max(min(test.clock.end - phases.idle, phases.heating) for test in identification.tests)
    crossing = 0.0
    for layer in identification.card.layers:
        k, c = (identification.fit.values[f"{layer.name}.{key}"] for key in ("conductivity", "specific_heat"))
        crossing += layer.thickness / np.sqrt(k / (layer.density.value * c))
    if heated < crossing**2:
        yield (
            f"The test is short: the readings have {heated:.0f} s of heating, but heat needs about {crossing**2:.0f} s "
            "(thickness squared over diffusivity) to pass through the layers."
        )
    if all(test.clock.end <= phases.idle + phases.heating for test in identification.tests) and phases.cooling > 0:
        yield "The readings do not include the cooling phase."


def _unusual(identification: IdentificationData) -> Iterator[str]:
    """Numbers that the readings move far from the card."""
    fit = identification.fit
    for parameter, x in zip(fit.parameters.free, fit.x, strict=True):
        if abs(x) > UNUSUAL:
            yield (
                f"Unusual: by these readings {name_in_words(parameter.name)} is "
                f"{shown(identification.by_name[parameter.name])}, {abs(x):.1f} standard deviations from the card's "
                f"{parameter.value(0.0):.3g}. Check it, or the card's standard deviation."
            )


def _bound(identification: IdentificationData) -> Iterator[str]:
    properties = [i for i, estimate in enumerate(identification.estimates) if estimate.group == PROPERTY]
    for a in properties:
        for b in properties:
            r = identification.correlation[a, b]
            if a < b and abs(r) > BOUND:
                pair = " and ".join(name_in_words(identification.estimates[i].name) for i in (a, b))
                known = "ratio" if r > 0 else "product"
                yield f"{pair} are correlated ({r:+.2f}): their {known} is determined better than each of them."


def _linear(identification: IdentificationData) -> Iterator[str]:
    chosen = identification.selection.chosen
    for estimate in identification.estimates:
        if estimate.group == SLOPE:
            key = name_in_words(estimate.name).replace(" slope", "")
            p = identification.selection.probability.get(estimate.name, 1.0)
            yield (
                f"Linear in temperature: {key} changes by {100 * estimate.value:+.3f} %/K "
                f"({100 * estimate.low:+.3f} to {100 * estimate.high:+.3f}; probability {p:.2f})."
            )
    if not chosen and identification.selection.probability:
        yield "No property needs to be linear in temperature: constant properties have the greater evidence."
    for name, p in identification.selection.probability.items():
        if name not in chosen and p > 0.25:
            key = name_in_words(name).replace(" slope", "")
            yield f"Undecided: {key} may be linear in temperature (probability {p:.2f}); the intervals include this."


def _misfit(identification: IdentificationData) -> Iterator[str]:
    for name, error in identification.fit.noise.model.items():
        rise = highest_rise(identification.fit.blocks, name)
        # Less than the noise of a reading is no sign of a missing effect, however small the rise.
        if error > ASTRAY and error * rise > identification.card.sensors[name].noise:
            yield (
                f"The model deviates by about {error:.1%} of the rise at '{name}', varying slowly: an effect is "
                "missing or a number of the card is wrong. The intervals are wider because of it."
            )
    for block in identification.fit.blocks:
        series = block.series
        noise = identification.card.sensors[series.sensor].noise
        ratio = float(np.sqrt(np.mean(block.residual**2 * series.counts))) / noise
        if ratio > 1.5:
            yield f"Run '{series.test}', sensor '{series.sensor}': residuals are {ratio:.1f} times the stated noise."
    hottest = max(float(block.computed.max()) for block in identification.fit.blocks)
    if hottest > HOT:
        yield f"A sensor reads {hottest:.0f} degC: rubber and its properties change at such temperatures."
