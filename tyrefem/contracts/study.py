"""The quick study in which plugins are tried."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tyrefem.effects.signature import SENSORS
from tyrefem.inputs.study import StudyData, study

#: Rolling for minutes and cooling at rest; a coarse mesh: a run takes a tenth of a second.
STUDY = "example-validation"
COARSE: Mapping[str, Any] = {
    "mesh.size": "10 mm",
    "mesh.element": "P1",
    "numerics.tolerance": "0.2 delta_degC",
    "drive.phases.rolling.duration": "120 s",
    "drive.phases.cooling.duration": "30 s",
    "output": {"every": "30 s", "fields": 2},
    **SENSORS,
}


def quick_study(name: str | None = None, changes: Mapping[str, Any] | None = None) -> StudyData:
    """The study for trials; ``name``: another study, coarser only in its mesh."""
    if name is None:
        return study(STUDY).replace({**COARSE, **(changes or {})})
    return study(name).replace({"mesh.element": "P1", **(changes or {})})
