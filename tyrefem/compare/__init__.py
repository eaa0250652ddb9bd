"""Computed against measured temperatures: deviations in kelvin, judged against their uncertainty.

Knows nothing of diagnoses, pages and pictures.
"""

from tyrefem.compare.comparison import ComparisonData
from tyrefem.compare.validation import compare

__all__ = ["ComparisonData", "compare"]
