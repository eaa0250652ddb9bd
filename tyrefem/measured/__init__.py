"""Measured temperature histories in the formats of loggers.

The package is independent of tyres and studies.
"""

from tyrefem.measured.run import MeasuredRun
from tyrefem.measured.table import read_table

__all__ = ["MeasuredRun", "read_table"]
