"""Result of a run, and results of the cases of a study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.api.verbs import with_verbs
from tyrefem.simulation import result
from tyrefem.sweep import campaign

if TYPE_CHECKING:
    from tyrefem.measured.cases import Case


class Result(result.ResultData):
    """Result of a run, with methods to write and plot it."""

    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json`: inputs, versions, mesh, tolerance and main results."""
        from tyrefem.reports.run_files import summary

        return summary(self)

    def to_vtk(self, folder: str | Path, *, revolved: bool = False) -> Path:
        """Write ``<name>.pvd`` and a .vtu per saved time: regions, T, heat source, strain energy."""
        from tyrefem.reports.vtk import write_series

        return write_series(self, Path(folder), revolved=revolved)

    def plot(self, folder: str | Path) -> list[Path]:
        """Write the standard pictures as PNG files."""
        from tyrefem.reports.figures import write_pictures

        return write_pictures(self, Path(folder))

    def report(self, path: str | Path) -> Path:
        """Write one self-contained HTML report."""
        from tyrefem.reports.run import write_report

        return write_report(self, Path(path))

    def save(self, folder: str | Path) -> Path:
        """Write readings, extremes and heat budget as CSV, and ``summary.json``."""
        from tyrefem.reports.run_files import write_tables

        return write_tables(self, Path(folder))


class Campaign(campaign.CampaignData):
    """The cases of a study: each case is a study, whose result can be written and plotted."""

    def outcome(self, case: Case) -> Result | str:
        """The result of a case, or the reason why it failed."""
        outcome = super().outcome(case)
        return outcome if isinstance(outcome, str) else with_verbs(Result, outcome)
