"""The next runs and sensors: which of them are expected to tell the remaining sets of effects apart, at what cost.

This package does not import reports.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tyrefem.plan.steps import PlanData
    from tyrefem.plan.workflow import plan

__all__ = ["PlanData", "plan"]
_MODULES = {"PlanData": "steps", "plan": "workflow"}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'tyrefem.plan' has no attribute '{name}'")
    return getattr(importlib.import_module(f"tyrefem.plan.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
