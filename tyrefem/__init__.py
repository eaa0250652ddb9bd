"""Thermo-mechanical finite elements of a rolling tyre's cross-section.

>>> import tyrefem as tf
>>> tf.study("nasa-22x5.5-8pr").title
'22x5.5 8PR aircraft tyre, 2700 lbf at 83 psi, 20 mph'
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

_WHERE = {
    "study": "api",
    "load": "api",
    "section_from_size": "api",
    "Study": "api",
    "Result": "api",
    "Campaign": "api",
    "Comparison": "api",
    "InputError": "errors",
    "Conduction": "conduction",
    "Material": "conduction",
    "Film": "conduction",
    "Flux": "conduction",
    "Radiation": "conduction",
    "Fixed": "conduction",
    "Reservoir": "conduction",
}
__all__ = [*_WHERE, "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module 'tyrefem' has no attribute '{name}'")
    return getattr(importlib.import_module(f"tyrefem.{_WHERE[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
