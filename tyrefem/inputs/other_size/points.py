"""A section drawn by hand on points for another size: its line stretched to the size's width and height."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry import Section, SectionCard, build
from tyrefem.inputs.changes import scaled
from tyrefem.inputs.other_size.arcs import DIGITS, MISS, height, ratio, scale_gauges, scale_rating
from tyrefem.sizes import Drawn

Array = NDArray[np.float64]
#: Places of the line whose ways carry lengths along the meridian.
SAMPLES = 400


def scaled_points(data: Mapping[str, Any], old: Section, before: Drawn, after: Drawn) -> dict[str, Any]:
    """The section's file for another size.

    The line is stretched, in width by the ratio of the sizes' section widths, in height above the rim by the ratio of
    their heights. From the widest place to the bead the stretch in width goes over to the ratio of the rims' widths;
    the bead keeps its height on the rim. Tables along the meridian go with the places of the line. Gauges: carcass and
    bead by the number of plies, tread by the rules' tread; others stay.

    Raises
    ------
    InputError : the stretched line makes no section of this width on this rim.
    """
    from scipy.optimize import least_squares

    card = SectionCard.check(data)
    wanted = {name: ratio(before.rules, after.rules, name) for name in ("section_width", "outer_diameter", "rim_width")}
    rims = [size.rules["rim_diameter"].value / 2 for size in (before, after)]
    bead = old.line.position(np.array([old.line.length]))[0][0] - rims[0] + rims[1]
    width = wanted["section_width"] * old.overall_width
    # The built line may be shifted along r: its diameter decides.
    places = np.linspace(0, old.line.length, SAMPLES)
    line = old.line.position(places)
    drawn = np.array(card.line.points)
    points = drawn + np.array([line[0, 0] - drawn[0, 0], 0.0])
    start = _parts(data, before, after, wanted["outer_diameter"] * old.outer_diameter)

    def trial(x: Array) -> dict[str, Any]:
        laid, lengthened = (stretched(each, rims[0], x[0], x[1], wanted["rim_width"]) for each in (points, line))
        new = copy.deepcopy(start)
        _move_along(new, card, places, np.append(0.0, np.cumsum(np.hypot(*np.diff(lengthened, axis=0).T))))
        new["line"]["points"] = _table(1e3 * (laid + np.array([rims[1] - rims[0], 0.0])))
        return new

    def misses(x: Array) -> Array:
        try:
            section = build(SectionCard.check(trial(x)))
        except InputError:
            return np.full(2, 1e3)
        reached = section.line.position(np.array([section.line.length]))[0][0]
        return np.array([section.overall_width - width, reached - bead]) / MISS

    guess = np.array([wanted["section_width"], height(after.rules) / height(before.rules)])
    fit = least_squares(misses, guess, diff_step=1e-3)
    if np.abs(fit.fun).max() > 1:
        raise InputError(
            f"the line of '{data['title']}' does not stretch to {1e3 * width:.1f} mm on the rim of {after.size.text}; "
            f"try a size nearer to {before.size.text}, or tyrefem new study '{after.size.text}'",
            field="size",
        )
    return trial(fit.x)


def stretched(points: Array, rim: float, width: float, high: float, rim_width: float) -> Array:
    """Points (n, 2) of a line, r and z, stretched above the rim's radius.

    >>> line = np.array([[0.3, 0.0], [0.25, 0.1], [0.2, 0.08]])
    >>> stretched(line, 0.2, 1.1, 0.9, 1.0).round(3).tolist()
    [[0.29, 0.0], [0.245, 0.11], [0.2, 0.08]]
    """
    r, z = points.T
    widest = int(np.argmax(z))
    share = np.clip((r[widest] - r) / (r[widest] - r[-1]), 0, 1) if widest < len(r) - 1 else np.zeros(len(r))
    # Above the widest place r is larger: no share.
    return np.column_stack([rim + high * (r - rim), z * (width + (rim_width - width) * share)])


def _move_along(new: dict[str, Any], card: SectionCard, before: Array, after: Array) -> None:
    """Lengths along the meridian, carried from the places ``before`` of the old line to those of the new, ``after``."""
    ends = before[-1], after[-1]

    def moved(s: Array | float) -> Array:
        # Tables may end behind the bead.
        return np.interp(s, before, after) + np.maximum(np.asarray(s) - ends[0], 0.0)

    def from_bead(s: float) -> float:
        return float(ends[1] - moved(ends[0] - s))

    parameters = card.parameters
    new["parameters"]["shoulder_s"] = _mm(float(moved(parameters.shoulder_s or 0.0)))
    for name in ("bead_length", "rim_length"):
        if (value := getattr(parameters, name)) is not None:
            new["parameters"][name] = _mm(from_bead(value))
    parts = [(new["boundaries"], card.boundaries)]
    for layer, built in zip(new["layers"], card.layers, strict=True):
        s = np.array(built.s)
        layer["s"] = _table(1e3 * moved(s * (ends[0] / s[-1]) if built.stretch and s[-1] > 0 else s))
        parts.append((layer["regions"], built.regions))
    for written, olds in parts:
        for part, old in zip(written, olds, strict=True):
            if isinstance(old.to, float):
                part["to"] = _mm(float(moved(old.to)) if old.to > 0 else -from_bead(-old.to))
    if card.grooves is not None:
        at, half = np.array(card.grooves.at), card.grooves.width / 2
        new["grooves"]["at"] = _table(1e3 * moved(at))
        widths = moved(at + half) - moved(np.abs(at - half)) * np.sign(at - half)
        new["grooves"]["width"] = _mm(float(np.mean(widths)))


def _table(values: Array) -> dict[str, Any]:
    return {"unit": "mm", "values": np.round(values, 3).tolist()}


def _mm(length: float) -> str:
    return f"{1e3 * length:.3f} mm"


def _parts(data: Mapping[str, Any], before: Drawn, after: Drawn, diameter: float) -> dict[str, Any]:
    """The file with all that the line does not decide; ``diameter``: the new outer diameter, m."""
    new = copy.deepcopy(dict(data))
    parameters = new["parameters"]
    for name in [name for name in parameters if name.startswith("flange_") or name == "inner_volume"]:
        parameters.pop(name)
    parameters["outer_diameter"] = f"{1e3 * diameter:.2f} mm"
    parameters["nominal_width"] = scaled(parameters["nominal_width"], after.size.width / before.size.width, DIGITS)
    scale_gauges(new, data, before, after)
    if new.get("rating") is not None:
        scale_rating(new["rating"], before, after)
    new["title"] = f"{after.size.text} scaled from: {data['title']}"
    for table in ("parameters", "line"):
        new[table]["source"] = f"scaled to {after.size.text}; before: {new[table]['source']}"
    return new
