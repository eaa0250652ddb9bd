"""The signature of an effect: a study that shows it, and the signs of its changes of readings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

#: Base study of all signatures.
STUDY = "example-validation"
#: Additional thermocouples near the surface and in the bead, which signs may name.
SENSORS: Mapping[str, Any] = {
    "sensors.bead": {"s": "5.6 in", "depth": "0.3 in"},
    "sensors.surface": {"s": "0.30 in", "depth": "0.79 in"},
    "sensors.shoulder-edge": {"s": "1.80 in", "depth": "0.64 in"},
}


@dataclass(frozen=True)
class Signature:
    """Changes of the study `STUDY` that show an effect, and the signs of its changes of readings.

    Default: the unchanged study, the effect's first variant, any sign. The picture has the study's drive, 600 s and
    600 s at rest; tests/effects have 200 s and 40 s, `tyrefem check` 120 s and 30 s, in which it must show too.

    Parameters
    ----------
    changes : dotted name -> value. words : the changes, for a caption: "at 30 m/s".
    choice : variant of the effect; empty: the first.
    signs : reading -> physical sign of its mean change when every amplitude is one prior scale from null.
    """

    changes: Mapping[str, Any] = field(default_factory=dict)
    words: str = ""
    choice: Mapping[str, str] = field(default_factory=dict)
    signs: Mapping[str, int] = field(default_factory=dict)
