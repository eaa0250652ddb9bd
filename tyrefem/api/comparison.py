"""Deviations of a study from measurements."""

from __future__ import annotations

from pathlib import Path

from tyrefem.api.verbs import shown
from tyrefem.compare import comparison


class Comparison(comparison.ComparisonData):
    """Deviations of a study from measurements, with `save`."""

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import comparison_page

        return shown(lambda: comparison_page(self))

    def save(self, folder: str | Path) -> Path:
        """Write tables, pictures and a self-contained page into a folder; return the page's path.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.comparison import save

        return save(self, folder)
