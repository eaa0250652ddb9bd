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


def shown(one: ParameterEstimate, digits: int = 3) -> str:
    """Value and interval, e.g. ``0.282 (0.272 to 0.293) W/m/K``."""
    unit = "" if one.unit == "1" else f" {one.unit}"
    return f"{one.value:.{digits}g} ({one.low:.{digits}g} to {one.high:.{digits}g}){unit}"


def sentences(found: IdentificationData) -> tuple[str, ...]:
    """The verdict, most important first; empty of complaints where everything is determined."""
    unknown = [one for one in found.properties if one.verdict == "not determined"]
    poor = [one for one in found.properties if one.verdict == "poor"]
    out = [
        f"NOT DETERMINED: {spoken(one.name)}. {one.share_left:.0%} of the first guess's uncertainty is left; "
        f"the value {shown(one)} is mostly that guess."
        for one in unknown
    ]
    out += [
        f"POORLY DETERMINED: {spoken(one.name)}, {shown(one)}: relative standard deviation above {POOR:.0%}."
        for one in poor
    ]
    if unknown or poor:
        out += _reasons(found)
    else:
        out.append("All conductivities and specific heats are determined by the readings.")
    out += _bound(found)
    left = [spoken(one.name) for one in found.estimates if one.group == RIG and one.share_left > 0.7]
    if left:
        out.append(
            f"Taken from the card, as the readings say little about them: {', '.join(left)}. "
            "Their uncertainty is inside the intervals."
        )
    out += _linear(found)
    out += _misfit(found)
    return tuple(out)


def _reasons(found: IdentificationData) -> Iterator[str]:
    """Why something is not determined, as far as the test itself tells."""
    sensors = {one.sensor for test in found.tests for one in test.series}
    faces = {found.card.sensors[name].face for name in sensors}
    for face in ("inner", "outer"):
        if face not in faces:
            yield f"There is no view of the {face} face."
    phases = found.card.phases
    heated = max(min(test.clock.end - phases.idle, phases.heating) for test in found.tests)
    crossing = 0.0
    for layer in found.card.layers:
        k, c = (found.fit.values[f"{layer.name}.{key}"] for key in ("conductivity", "specific_heat"))
        crossing += layer.thickness / np.sqrt(k / (layer.density.value * c))
    if heated < crossing**2:
        yield (
            f"The test is short: {heated:.0f} s of heating were read, while heat takes about {crossing**2:.0f} s "
            "(thickness squared over diffusivity) to come through the layers."
        )
    if all(test.clock.end <= phases.idle + phases.heating for test in found.tests) and phases.cooling > 0:
        yield "The cooling phase was not read."


def _bound(found: IdentificationData) -> Iterator[str]:
    own = [i for i, one in enumerate(found.estimates) if one.group == PROPERTY]
    for a in own:
        for b in own:
            r = found.correlation[a, b]
            if a < b and abs(r) > BOUND:
                pair = f"{spoken(found.estimates[a].name)} and {spoken(found.estimates[b].name)}"
                known = "ratio" if r > 0 else "product"
                yield f"{pair} are known better together (correlation {r:+.2f}): their {known} is the firmer."


def _linear(found: IdentificationData) -> Iterator[str]:
    chosen = found.selection.chosen
    for one in found.estimates:
        if one.group == SLOPE:
            key = spoken(one.name).replace(" slope", "")
            p = found.selection.probability.get(one.name, 1.0)
            yield (
                f"Linear in temperature: {key} changes by {100 * one.value:+.3f} %/K "
                f"({100 * one.low:+.3f} to {100 * one.high:+.3f}; probability {p:.2f})."
            )
    if not chosen and found.selection.probability:
        yield "No property needs to be linear in temperature: constants have the better evidence."
    for name, p in found.selection.probability.items():
        if name not in chosen and p > 0.25:
            key = spoken(name).replace(" slope", "")
            yield f"Undecided: {key} may be linear in temperature (probability {p:.2f}); the intervals allow for it."


def _misfit(found: IdentificationData) -> Iterator[str]:
    for name, error in found.fit.noise.model.items():
        if error > ASTRAY:
            yield (
                f"The model misses about {error:.1%} of the rise at '{name}', slowly varying: something it lacks "
                "or a wrong number in the card. The intervals are widened for it."
            )
    for block in found.fit.blocks:
        one = block.series
        noise = found.card.sensors[one.sensor].noise
        ratio = float(np.sqrt(np.mean(block.residual**2 * one.counts))) / noise
        if ratio > 1.5:
            yield f"Run '{one.test}', sensor '{one.sensor}': residuals are {ratio:.1f} times the stated noise."
    hottest = max(float(block.computed.max()) for block in found.fit.blocks)
    if hottest > HOT:
        yield f"A sensor reads {hottest:.0f} degC: rubber changes at such temperatures, and the properties with it."
