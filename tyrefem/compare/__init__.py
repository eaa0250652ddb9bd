"""Computed against measured temperatures: deviations in kelvin, judged against their uncertainty.

Knows nothing of diagnoses, pages and pictures.
"""

from tyrefem.compare.comparison import Comparison
from tyrefem.compare.validation import compare

__all__ = ["Comparison", "compare"]
