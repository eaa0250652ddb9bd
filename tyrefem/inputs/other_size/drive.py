"""Loads, pressures, load law and rim of a study for another size."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tyrefem.errors import InputError
from tyrefem.geometry import Section
from tyrefem.inputs.changes import scaled
from tyrefem.inputs.other_size.notes import Notes
from tyrefem.sizes import Drawn

#: Digits of scaled quantities.
DIGITS = 4


@dataclass(frozen=True)
class Ratios:
    """New over old: rated load and pressure, width, outer diameter, height of the section, rim diameter and width."""

    load: float
    pressure: float
    width: float
    diameter: float
    height: float
    rim_diameter: float
    rim_width: float

    @classmethod
    def of(cls, before: Drawn, after: Drawn, old: Section, new: Section) -> Ratios:
        """The ratios of two tyres; load and pressure of their ratings."""

        def ratio(name: str) -> float:
            return after.rules[name].value / before.rules[name].value

        rated = old.rating is not None and new.rating is not None
        heights = [
            (section.outer_diameter - drawn.rules["rim_diameter"].value) / 2
            for section, drawn in ((new, after), (old, before))
        ]
        return cls(
            new.rating.load / old.rating.load if rated and new.rating and old.rating else ratio("rated_load"),
            new.rating.pressure / old.rating.pressure
            if rated and new.rating and old.rating
            else ratio("rated_pressure"),
            ratio("section_width"),
            new.outer_diameter / old.outer_diameter,
            heights[0] / heights[1],
            ratio("rim_diameter"),
            ratio("rim_width"),
        )

    @property
    def stiffness(self) -> float:
        """Of the vertical stiffness, p sqrt(w d), the scale of NASA TR R-64 (Smiley & Horne 1958)."""
        return self.pressure * math.sqrt(self.width * self.diameter)

    @property
    def footprint_length(self) -> float:
        """Of a footprint's length, sqrt(D d) with the deflection D = load over stiffness."""
        return math.sqrt(self.load / self.stiffness * self.diameter)


def scaled_drive(drive: Mapping[str, Any], ratios: Ratios, notes: Notes) -> dict[str, Any]:
    """``[drive]``: loads and pressures keep their share of the rating, deflections that of the section's height."""
    factors = {
        "load": ratios.load,
        "pressure": ratios.pressure,
        "deflection": ratios.height,
        "torque": ratios.load * ratios.diameter,
    }
    changed: dict[str, str] = {}
    new = _table(drive, factors, changed)
    if "phases" in drive:
        new["phases"] = [_table(phase, factors, changed) for phase in drive["phases"]]
    reasons = {
        "load": f"by the rated load, x {ratios.load:.4g}",
        "pressure": f"by the rated pressure, x {ratios.pressure:.4g}",
        "deflection": f"by the section's height, x {ratios.height:.4g}",
        "torque": "by load and radius",
    }
    for name, words in changed.items():
        notes.scale(f"drive.{name} {words}, {reasons[name]}")
    notes.keep("speeds, durations, temperatures and road of the drive")
    return new


def _table(table: Mapping[str, Any], factors: Mapping[str, float], changed: dict[str, str]) -> dict[str, Any]:
    new = dict(table)
    for name, factor in factors.items():
        if name in table:
            new[name] = _times(table[name], factor)
            if new[name] != table[name]:
                changed.setdefault(name, f"{_words(table[name])} -> {_words(new[name])}")
    return new


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, Mapping):
        return {key: _times(entry, factor) for key, entry in value.items()}
    return rounded(value, factor)


def rounded(value: Any, factor: float) -> Any:
    """A written quantity times a factor, with four digits and no exponent.

    >>> rounded("29592 N", 0.9436)
    '27920 N'
    """
    return scaled(scaled(value, factor, DIGITS), 1.0, 12)


def _words(value: Any) -> str:
    return " to ".join(map(str, value.values())) if isinstance(value, Mapping) else str(value)


def scaled_mechanics(mechanics: Mapping[str, Any], ratios: Ratios, notes: Notes) -> dict[str, Any]:
    """``[mechanics]``: load law and footprint scaled; given energies dropped."""
    new = dict(mechanics)
    if new.pop("energy", None) is not None:
        notes.drop("mechanics.energy: strain energies of the first tyre")
        if new.get("strain") == "given":
            new["strain"] = "fem"
            notes.scale('mechanics.strain "given" -> "fem", which computes the energies')
    law = new.get("load_law", {})
    if law.get("law") == "vertical-stiffness":
        stiffness = rounded(law["stiffness"], ratios.stiffness)
        source = f"estimate: scaled from {law['stiffness']} by pressure x sqrt(width x diameter)"
        new["load_law"] = {**law, "stiffness": stiffness, "source": f"{source}; before: {law['source']}"}
        words = f"{law['stiffness']} -> {stiffness}, by pressure x sqrt(width x diameter), x {ratios.stiffness:.4g}"
        notes.scale(f"mechanics.load_law {words}")
    footprint = new.get("footprint", {})
    if footprint.get("law") == "given":
        length = rounded(footprint["length"], ratios.footprint_length)
        new["footprint"] = {**footprint, "length": length}
        notes.scale(f"mechanics.footprint {footprint['length']} -> {length}, by sqrt(deflection x diameter)")
    return new


def scaled_rim(rim: Mapping[str, Any], ratios: Ratios, notes: Notes) -> dict[str, Any]:
    """A lumped rim: mass and conductances by rim diameter times rim width."""
    factor, new = ratios.rim_diameter * ratios.rim_width, dict(rim)
    for name in ("mass", "cooling", "air"):
        if name in rim:
            try:
                new[name] = rounded(rim[name], factor)
            except InputError as error:
                raise error.within(field=f"boundaries.rim.{name}") from None
    words = ", ".join(f"{name} {rim[name]} -> {new[name]}" for name in ("mass", "cooling", "air") if name in rim)
    notes.scale(f"boundaries.rim {words}, by rim diameter x rim width, x {factor:.4g}")
    return new
