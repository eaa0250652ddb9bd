"""The public classes: a study and its results, with their methods.

Their base classes hold data; each method calls the package that does the work. Options of a method are named
parameters, so that completion shows them; None as a default leaves the choice to the function that is called.
Classes of answers are loaded with the first answer.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from tyrefem.api.field import SectionField
from tyrefem.api.load import load
from tyrefem.api.record import Record
from tyrefem.api.result import Campaign, Result
from tyrefem.api.section import section_from_size
from tyrefem.api.studies import Study, study
from tyrefem.api.verbs import with_verbs

if TYPE_CHECKING:
    from tyrefem.api.comparison import Comparison
    from tyrefem.api.design import Design
    from tyrefem.api.diagnosis import Diagnosis, ExperimentPlan
    from tyrefem.api.diagnosis_record import DiagnosisRecord
    from tyrefem.api.exploration import Exploration
    from tyrefem.api.identification import Identification, identify
    from tyrefem.api.life import Life
    from tyrefem.api.mechanics import ForcesOverSlip, ForceTable, LoadedTyre, NaturalModes, RollingWheel

__all__ = [
    "Campaign",
    "Comparison",
    "Design",
    "Diagnosis",
    "DiagnosisRecord",
    "ExperimentPlan",
    "Exploration",
    "ForceTable",
    "ForcesOverSlip",
    "Identification",
    "Life",
    "LoadedTyre",
    "NaturalModes",
    "Record",
    "Result",
    "RollingWheel",
    "SectionField",
    "Study",
    "identify",
    "load",
    "section_from_size",
    "study",
    "with_verbs",
]
_MODULES = {
    "Comparison": "comparison",
    "Design": "design",
    "Diagnosis": "diagnosis",
    "DiagnosisRecord": "diagnosis_record",
    "ExperimentPlan": "diagnosis",
    "Exploration": "exploration",
    "ForceTable": "mechanics",
    "ForcesOverSlip": "mechanics",
    "Identification": "identification",
    "Life": "life",
    "LoadedTyre": "mechanics",
    "NaturalModes": "mechanics",
    "RollingWheel": "mechanics",
    "identify": "identification",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'tyrefem.api' has no attribute '{name}'")
    return getattr(importlib.import_module(f"tyrefem.api.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
