"""Computed against measured temperatures: deviations in kelvin, judged against their uncertainty.

This package does not import diagnoses or reports.
"""

from tyrefem.compare.comparison import ComparisonData
from tyrefem.compare.validation import compare

__all__ = ["ComparisonData", "compare"]
