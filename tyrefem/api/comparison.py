"""Deviations of a study from measurements."""

from __future__ import annotations

from pathlib import Path

from tyrefem.compare import comparison


class Comparison(comparison.ComparisonData):
    """Deviations of a study from measurements, with `save`."""

    def save(self, folder: str | Path) -> Path:
        """Write tables, pictures and a self-contained page into a folder; return the page's path.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.comparison import save

        return save(self, folder)
