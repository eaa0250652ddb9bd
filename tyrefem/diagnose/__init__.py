"""The diagnosis: where data and study disagree, which effect is missing, and the amended study.

This package does not import reports.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.workflow import diagnose

__all__ = ["DiagnosisData", "diagnose"]
_MODULES = {"DiagnosisData": "diagnosis", "diagnose": "workflow"}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'tyrefem.diagnose' has no attribute '{name}'")
    return getattr(importlib.import_module(f"tyrefem.diagnose.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
