"""Measured temperature histories, read as loggers write them.

Knows no tyre and no study.
"""

from tyrefem.measured.run import MeasuredRun
from tyrefem.measured.table import read_table

__all__ = ["MeasuredRun", "read_table"]
