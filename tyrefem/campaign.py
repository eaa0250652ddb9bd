"""A campaign: one study, a table of cases, one table of answers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from tyrefem.brief import Brief
from tyrefem.cases import Case
from tyrefem.conduction import SolverError
from tyrefem.errors import InputError
from tyrefem.interruption import held_back
from tyrefem.output import write_json
from tyrefem.rolling import run
from tyrefem.studies import Study
from tyrefem.summary import run_files, versions, write_tables
from tyrefem.vtk import file_names

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.result import Result


@dataclass(frozen=True, eq=False)
class Campaign(Brief):
    """The cases of a study, each a study of its own. Made by `Study.campaign`."""

    study: Study
    cases: tuple[Case, ...]

    def _title(self) -> str:
        return self.study.name

    def _facts(self) -> Mapping[str, Any]:
        return {
            "title": self.study.title,
            "cases": [case.name for case in self.cases],
            "changed": list(dict.fromkeys(key for case in self.cases for key in case.changes)),
            "section": self.study.section.name,
        }

    @classmethod
    def of(cls, study: Study) -> Self:
        """The campaign of a study that names a table of cases.

        Raises
        ------
        InputError : the study names none, or the table or a case of it is wrong (file and line).
        """
        for case in study.cases:
            study.case_study(case)
        return cls(study, study.cases)

    def case_study(self, case: Case) -> Study:
        """The study of one case."""
        return self.study.case_study(case)

    def runs(self, progress: Callable[[int, int], None] | None = None) -> Iterator[tuple[Case, Result | str]]:
        """Run the cases in their order; a case that fails gives its reason in place of a result.

        An interruption (Ctrl-C) yields the part of the case that is finished, then raises ``KeyboardInterrupt``.
        """
        for number, case in enumerate(self.cases):
            outcome = self.outcome(case)
            if progress is not None:
                progress(number + 1, len(self.cases))
            yield case, outcome
            if not isinstance(outcome, str) and outcome.history.interrupted:
                raise KeyboardInterrupt

    def outcome(self, case: Case) -> Result | str:
        """The result of a case, or why there is none."""
        try:
            return run(self.case_study(case), partial=True)
        except (InputError, SolverError) as error:
            return str(error)
        except Exception as error:  # one case's defect must not cost the others; it is named as what it is
            return f"defect, please report: {type(error).__name__}: {error}"


def row(case: Case, outcome: Result | str) -> dict[str, Any]:
    """One case as a row of the campaign's table; a failed case has only its name and ``failure``."""
    if isinstance(outcome, str):
        return {"case": case.name, "note": case.note, "failure": outcome}
    phase, peak = outcome.phases[-1], outcome.extremes.iloc[0]
    resistance, readings = outcome.rolling_resistance, outcome.readings
    hottest_region = outcome.extremes.iloc[1:].set_index("region")["temperature_degC"].idxmax()
    regions = {f"{entry.region}_max_degC": entry.temperature_degC for entry in outcome.extremes.iloc[1:].itertuples()}
    return {
        "case": case.name,
        "note": case.note,
        "section": outcome.study.section.name,
        "load_N": phase.load,
        "pressure_Pa": phase.pressure,
        "speed_m_s": phase.speed,
        "deflection_m": phase.deflection,
        "road_fraction": phase.road_fraction,
        "hottest_degC": peak.temperature_degC,
        "hottest_region": hottest_region,
        "hottest_s_m": peak.s_m,
        "hottest_depth_m": peak.depth_m,
        "hottest_time_s": peak.time_s,
        **regions,
        "rolling_resistance_N": resistance.force,
        "rolling_resistance_coefficient": resistance.coefficient,
        **{f"{name}_degC": float(readings[name].iloc[-1]) for name in readings.columns if name != "time_s"},
        **({} if outcome.sliding is None else {"exit_edge_max_degC": outcome.sliding.hottest.exit_edge_highest}),
        "heat_budget_imbalance": outcome.heat_budget.imbalance,
        "failure": f"interrupted at {outcome.times[-1]:g} s" if outcome.history.interrupted else "",
    }


def campaign_files(campaign: Campaign) -> list[str]:
    """The files that `run_campaign` and its report may write, relative to their folder."""
    from glob import escape

    cases = [f"cases/{escape(case.name)}/{name}" for case in campaign.cases for name in run_files(campaign.study)]
    vtk = [f"cases/{escape(case.name)}/vtk/{name}" for case in campaign.cases for name in file_names(case.name)]
    return ["campaign.csv", "report.html", *(name for name in cases if "/vtk/" not in name), *vtk,
            *(f"cases/{escape(case.name)}/summary.json" for case in campaign.cases)]  # fmt: skip


def run_campaign(
    campaign: Campaign,
    folder: Path,
    progress: Callable[[int, int], None] | None = None,
    each: Callable[[Any, Path], None] | None = None,
) -> pd.DataFrame:
    """Run a campaign into a folder: a folder per case, ``campaign.csv`` and ``summary.json``.

    The table is written anew after every case, so that an interrupted campaign leaves what it finished.
    ``each`` may write more of a case (pictures, VTK) into its folder.
    """
    rows: list[dict[str, Any]] = []
    # From the start on: an older campaign's table in this folder must not pass for this one's.
    table = _write(campaign, rows, folder)
    for case, outcome in campaign.runs(progress):
        try:
            if not isinstance(outcome, str):
                with held_back():
                    write_tables(outcome, folder / "cases" / case.name)
                if each is not None:
                    each(outcome, folder / "cases" / case.name)
        finally:
            # A case whose pictures were interrupted is finished all the same.
            with held_back():
                rows.append(row(case, outcome))
                table = _write(campaign, rows, folder)
    return table


def write_campaign_report(campaign: Campaign, table: pd.DataFrame, path: str | Path) -> Path:
    """One self-contained HTML page: all cases in a table, two pictures, failed cases with their reasons."""
    from tyrefem.campaign_report import write

    return write(campaign, table, Path(path))


def _write(campaign: Campaign, rows: list[dict[str, Any]], folder: Path) -> pd.DataFrame:
    import pandas as pd

    from tyrefem.output import atomic_path

    names = dict.fromkeys(name for entry in rows for name in entry if name != "failure")
    table = pd.DataFrame(rows, columns=[*(names or ("case", "note")), "failure"])
    with atomic_path(folder / "campaign.csv") as temporary:
        table.to_csv(temporary, index=False, float_format="%.6g")
    stopped = len(rows) < len(campaign.cases) or rows[-1]["failure"].startswith("interrupted")
    write_json(_summary(campaign, table, not stopped), folder / "summary.json")
    return table


def _summary(campaign: Campaign, table: pd.DataFrame, complete: bool) -> dict[str, Any]:
    return {
        "study": campaign.study.name,
        "title": campaign.study.title,
        "complete": complete,
        "cases": table.to_dict("records"),
        "failed": [entry["case"] for entry in table.to_dict("records") if entry.get("failure")],
        "tolerance_K": campaign.study.tolerance,
        "mesh": campaign.study.card.mesh.model_dump(),
        "versions": versions(),
        "random_seed": None,
        "input": dict(campaign.study.data),
    }
