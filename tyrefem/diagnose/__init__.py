"""The diagnosis: where data and study disagree, which effect is missing, and the study that has it."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import Diagnosis, diagnose

__all__ = ["Diagnosis", "diagnose"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'tyrefem.diagnose' has no attribute '{name}'")
    return getattr(importlib.import_module("tyrefem.diagnose.diagnosis"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
