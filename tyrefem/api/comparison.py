"""Deviations of a study from measurements."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from tyrefem.api.verbs import shown
from tyrefem.compare import comparison
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(comparison.ComparisonData):
    """Deviations of a study from measurements, with `save`. ``original``: the study, if it is known."""

    original: StudyData | None = field(default=None, kw_only=True)

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import comparison_page

        return shown(lambda: comparison_page(self))

    def save(self, folder: str | Path, *, force: bool = False) -> Path:
        """Write the files of `tyrefem compare`: tables, pictures, ``study.toml``, ``summary.json`` and a
        self-contained page, whose path it returns.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of this command.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.comparison import FILES, save

        origin = None if self.original is None else StudyOrigin(self.original, simulated=True)
        with saving(folder, "compare", FILES, origin, force=force) as place:
            return save(self, place)
