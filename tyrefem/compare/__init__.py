"""Computed against measured temperatures: deviations in kelvin, judged against their uncertainty."""

from tyrefem.compare.comparison import Comparison
from tyrefem.compare.validation import compare

__all__ = ["Comparison", "compare"]
