"""A section of two arcs for another size: its arcs stretched to the size's width and height, gauges by its rules."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry import Section, SectionCard, TwoArcs, build
from tyrefem.inputs.changes import scaled
from tyrefem.sizes import Drawn
from tyrefem.sizes.rules import Rules

Array = NDArray[np.float64]
#: Digits of scaled quantities.
DIGITS = 6
#: Furthest miss of the bead's radius and the width, m.
MISS = 2e-4
#: Weight of changes of radii and lengths beside a miss: a tenth counts as MISS.
CHANGES = np.array([0.1, 0.1, 0.3, 0.3])


def scaled_arcs(data: Mapping[str, Any], old: Section, before: Drawn, after: Drawn) -> dict[str, Any]:
    """The section's file for another size.

    Width times a, the ratio of the sizes' section widths; height above the rim times b. The crown's arc becomes
    a^2/b times as large, the sidewall's b^2/a (as in a stretched drawing). Radii, shoulder and the length of the
    meridian then change as little as the width, and the bead, which keeps its place on the rim, allow. Gauges: carcass
    and bead by the number of plies, tread by the rules' tread; others stay.

    Raises
    ------
    InputError : no two arcs have this width and reach this rim.
    """
    from scipy.optimize import least_squares

    assert isinstance(old.line, TwoArcs)
    a, b = ratio(before.rules, after.rules, "section_width"), height(after.rules) / height(before.rules)
    rim = after.rules["rim_diameter"].value / 2
    bead = rim + old.line.bead[1] - before.rules["rim_diameter"].value / 2
    width = a * old.overall_width
    start = _parts(data, before, after, a, b)
    # Logarithms plus 1, for steps of differences in proportion.
    guess = 1 + np.log([b * b / a, np.sqrt(a * b), 1.0, 1.0])

    def trial(x: Array) -> dict[str, Any]:
        return _with_arcs(start, data, np.exp(x - 1))

    def misses(x: Array) -> Array:
        try:
            section = build(SectionCard.check(trial(x)))
        except InputError:
            return np.full(6, 1e3)
        assert isinstance(section.line, TwoArcs)
        reached = np.array([section.overall_width - width, section.line.bead[1] - bead])
        return np.concatenate([reached / MISS, CHANGES * (x - guess)])

    fit = least_squares(misses, guess, diff_step=1e-4)
    if np.abs(fit.fun[:2]).max() > 1:
        raise InputError(
            f"no two arcs are {1e3 * width:.1f} mm wide and reach the rim of {after.size.text}; try a size nearer to "
            f"{before.size.text}, or tyrefem new study '{after.size.text}'",
            field="size",
        )
    return trial(fit.x)


def ratio(before: Rules, after: Rules, name: str) -> float:
    return after[name].value / before[name].value


def height(rules: Rules) -> float:
    """Height of the section above the rim, m."""
    return (rules["outer_diameter"].value - rules["rim_diameter"].value) / 2


def _parts(data: Mapping[str, Any], before: Drawn, after: Drawn, a: float, b: float) -> dict[str, Any]:
    """The file with all that the arcs do not decide."""
    new = copy.deepcopy(dict(data))
    parameters, rating = new["parameters"], new.get("rating")
    parameters.pop("crown_midline_radius", None)
    parameters.pop("inner_volume", None)
    if "outer_diameter" not in parameters:
        raise InputError("missing; a section of two arcs scales by it", field="parameters.outer_diameter")
    parameters["outer_diameter"] = scaled(
        parameters["outer_diameter"], ratio(before.rules, after.rules, "outer_diameter"), DIGITS
    )
    nominal = after.size.width / before.size.width
    parameters["nominal_width"] = scaled(parameters["nominal_width"], nominal, DIGITS)
    parameters["crown_radius"] = scaled(parameters["crown_radius"], a * a / b, DIGITS)
    if "shoulder_fraction" in parameters:
        parameters["shoulder_fraction"] = scaled(parameters["shoulder_fraction"], a / nominal, DIGITS)
    if "overall_width" in parameters:
        parameters["overall_width"] = scaled(parameters["overall_width"], a, DIGITS)
    for name in [name for name in parameters if name.startswith("flange_")]:
        parameters.pop(name)
    scale_gauges(new, data, before, after)
    if rating is not None:
        scale_rating(rating, before, after)
    new["title"] = f"{after.size.text} scaled from: {data['title']}"
    parameters["source"] = f"scaled to {after.size.text}; before: {parameters['source']}"
    return new


def scale_gauges(new: dict[str, Any], data: Mapping[str, Any], before: Drawn, after: Drawn) -> None:
    """Thickness of the layers: carcass and bead by the number of plies, tread by the rules' tread; others stay."""
    plies, tread = (ratio(before.rules, after.rules, name) for name in ("plies", "tread_gauge"))
    factors = {"carcass": plies, "bead": plies, "tread": tread}
    # The file keeps its factors on thickness, so its own rows are scaled; below a groove they are the tread's.
    card = SectionCard.check({key: value for key, value in data.items() if key != "grooves"})
    for layer, rows, built in zip(new["layers"], card.layers, build(card).layers, strict=True):
        regions = built.regions.at(np.array(built.thickness.s))
        layer["thickness"] = {
            "unit": "mm",
            "values": [
                round(1e3 * value * factors.get(str(region), 1.0), 3)
                for value, region in zip(rows.thickness, regions, strict=True)
            ],
        }
        layer["source"] = f"scaled to {after.size.text}; before: {layer['source']}"


def scale_rating(rating: dict[str, Any], before: Drawn, after: Drawn) -> None:
    """Load and pressure of the new size; its width and diameter, and the bead wires by the rules."""
    nominal = after.size.width / before.size.width
    rating |= {
        "width": scaled(rating["width"], nominal, DIGITS),
        "diameter": scaled(rating["diameter"], ratio(before.rules, after.rules, "outer_diameter"), DIGITS),
        "load": after.rules["rated_load"].text,
        "pressure": after.rules["rated_pressure"].text,
        "bead_wire_area": scaled(rating["bead_wire_area"], ratio(before.rules, after.rules, "bead_wire_area"), DIGITS),
        "source": after.rules.sources("rated_load", "rated_pressure")
        + f"; scaled from {before.size.text}: bead_wire_area by the rules, cord_angle as it was",
    }


def scale_along(new: dict[str, Any], data: Mapping[str, Any], along: float) -> None:
    """Lengths along the meridian times a factor: tables of the layers, ends of parts, grooves."""
    for name in ("meridian_length", "bead_length", "rim_length", "shoulder_s"):
        if name in data["parameters"]:
            new["parameters"][name] = scaled(data["parameters"][name], along, DIGITS)
    for layer, before in zip(new["layers"], data["layers"], strict=True):
        layer["s"] = scaled(before["s"], along, DIGITS)
        for region, old in zip(layer["regions"], before["regions"], strict=True):
            _scale_end(region, old, along)
    for boundary, old in zip(new["boundaries"], data["boundaries"], strict=True):
        _scale_end(boundary, old, along)
    if "grooves" in new:
        new["grooves"]["at"] = scaled(data["grooves"]["at"], along, DIGITS)
        new["grooves"]["width"] = scaled(data["grooves"]["width"], along, DIGITS)


def _with_arcs(start: Mapping[str, Any], data: Mapping[str, Any], factors: Array) -> dict[str, Any]:
    """The file with factors on the sidewall's radius, lengths along the meridian, the crown's radius, the shoulder."""
    sidewall, along, crown, shoulder = map(float, factors)
    new = copy.deepcopy(dict(start))
    parameters = new["parameters"]
    parameters["crown_radius"] = scaled(parameters["crown_radius"], crown, DIGITS)
    if "shoulder_fraction" in parameters:
        parameters["shoulder_fraction"] = scaled(parameters["shoulder_fraction"], shoulder, DIGITS)
    parameters["sidewall_radius"] = scaled(data["parameters"]["sidewall_radius"], sidewall, DIGITS)
    scale_along(new, data, along)
    return new


def _scale_end(part: dict[str, Any], before: Mapping[str, Any], along: float) -> None:
    """A length of a part's end; the name of a mark stays."""
    end = before.get("to")
    if isinstance(end, str) and not end.replace("_", "").isalpha():
        part["to"] = scaled(end, along, DIGITS)
