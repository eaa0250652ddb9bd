"""What shows an effect: the study in which it is tried and drawn, and what it does to the readings there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

#: The study that is changed.
STUDY = "example-validation"
#: Thermocouples near the surface and in the bead, beside the study's own: signs may name them.
SENSORS: Mapping[str, Any] = {
    "sensors.bead": {"s": "5.6 in", "depth": "0.3 in"},
    "sensors.surface": {"s": "0.30 in", "depth": "0.79 in"},
    "sensors.shoulder-edge": {"s": "1.80 in", "depth": "0.64 in"},
}


@dataclass(frozen=True)
class Signature:
    """What the study `STUDY` needs for an effect to show, and the sign of what the effect does.

    An effect that says nothing is tried all the same: in the study as it is, its first variant, whatever its sign.

    Parameters
    ----------
    changes : dotted name -> value. words : the changes, for a caption: "at 30 m/s".
    choice : the variant that is tried; empty: the first.
    signs : reading -> sign of its mean change with every amplitude one prior scale from null, as physics has it.
    """

    changes: Mapping[str, Any] = field(default_factory=dict)
    words: str = ""
    choice: Mapping[str, str] = field(default_factory=dict)
    signs: Mapping[str, int] = field(default_factory=dict)
