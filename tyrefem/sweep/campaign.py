"""A campaign: a study, a table of cases, and a table of their answers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from tyrefem.brief import Brief, counted
from tyrefem.conduction import SolverError
from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.inputs.study import StudyData
from tyrefem.measured.cases import Case
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.simulation.run import run
from tyrefem.sizes import drawn_of
from tyrefem.variants.answers import check_sensor_names

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData

#: Cases from which the time of all cases is estimated.
SAMPLED_CASES = 10
#: Dotted names of a tyre's size and of what stands beside it.
SECTION, SIZE, PARAMETERS = "section.", "section.size", "section.parameters."


@dataclass(frozen=True, eq=False)
class CampaignData(Brief):
    """The cases of a study; each case is a study. `Study.campaign` makes it."""

    study: StudyData
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
    def of(cls, study: StudyData) -> Self:
        """The campaign of a study that names a table of cases.

        Raises
        ------
        InputError : the study names no table, or the table or a case is invalid (with file and line). A case whose
            tyre size gives no section is not refused: its row of the answers says why.
        """
        check_sensor_names(study)
        for case in study.cases:
            try:
                study.case_study(case)
            except InputError:
                if not _has_no_section(study, case):
                    raise
        return cls(study, study.cases)

    def case_study(self, case: Case) -> StudyData:
        """The study of a case.

        Raises
        ------
        InputError : no case of a table; errors of the case.
        """
        _check_case(case)
        return self.study.case_study(case)

    def runs(self, progress: Callable[[int, int], None] | None = None) -> Iterator[tuple[Case, ResultData | str]]:
        """Run the cases in their order and yield (case, result); a failed case gives its reason instead of a result.

        An interruption (Ctrl-C) yields the finished part of the running case, then raises ``KeyboardInterrupt``.
        """
        self._warn()
        for number, case in enumerate(self.cases):
            outcome = self.outcome(case)
            if progress is not None:
                progress(number + 1, len(self.cases))
            yield case, outcome
            if not isinstance(outcome, str) and outcome.history.interrupted:
                raise KeyboardInterrupt

    def _warn(self) -> None:
        """Warn of long work; the time is estimated from some of the cases."""
        some = self.cases[:: max(len(self.cases) // SAMPLED_CASES, 1)]
        runs: list[RunEstimate] = []
        for case in some:
            with suppress(InputError):  # an invalid case becomes a row with its failure
                runs.append(RunEstimate.of(self.case_study(case)))
        if runs:
            count = len(self.cases)
            mean = sum(run.total.time for run in runs) / len(runs)
            estimate.warn_if_long(
                mean * count,
                f"{counted(count, 'case')} of {self.study.name}",
                lambda: runs[0].quick_look(lambda run: run.total.time * count),
            )

    def outcome(self, case: Case) -> ResultData | str:
        """The result of a case, or the reason of its failure.

        Raises
        ------
        InputError : no case of a table.
        """
        _check_case(case)
        try:
            return run(self.case_study(case), partial=True)
        except (InputError, SolverError) as error:
            return str(error)
        except Exception as error:  # a defect in a case must not stop the other cases
            return f"defect, please report: {type(error).__name__}: {error}"


def _check_case(case: object) -> None:
    if not isinstance(case, Case):
        raise InputError(
            f"must be one of the campaign's cases, not {case!r:.60}; study.case(NAME) is the study of a name",
            field="case",
        )


def _has_no_section(study: StudyData, case: Case) -> bool:
    """Does a case name a size of which no section can be drawn?"""
    if SIZE not in case.changes:
        return False
    written = study.data.get("section")
    reference: dict[str, Any] = dict(written) if isinstance(written, Mapping) else {}
    parameters = dict(reference.get("parameters", {}))
    for name, value in case.changes.items():
        if name.startswith(PARAMETERS):
            parameters[name.removeprefix(PARAMETERS)] = value
        elif name.startswith(SECTION):
            reference[name.removeprefix(SECTION)] = value
    try:
        drawn_of({**reference, "parameters": parameters})
    except InputError:
        return True
    return False


def row(case: Case, outcome: ResultData | str) -> dict[str, Any]:
    """A case as a row of the campaign's table; a failed case has only its name, note and ``failure``."""
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
        "rolling_resistance_phase": resistance.phase,
        "rolling_resistance_N": resistance.force,
        "rolling_resistance_coefficient": resistance.coefficient,
        **{f"{name}_degC": float(readings[name].iloc[-1]) for name in readings.columns if name != "time_s"},
        **({} if outcome.sliding is None else {"exit_edge_max_degC": outcome.sliding.hottest.exit_edge_highest}),
        "heat_budget_imbalance": outcome.heat_budget.imbalance,
        "failure": f"interrupted at {outcome.times[-1]:g} s" if outcome.history.interrupted else "",
    }
