"""`tyrefem run`: simulate a study, or a campaign of cases, and write a folder of results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    fail,
    settings,
    warn,
)
from tyrefem.cli.progress import counted, progress, stages
from tyrefem.cli.shell import answer_with, notify, say
from tyrefem.errors import InputError, Interrupted
from tyrefem.interruption import interruption_delayed, keeping
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.api import Result, Study
    from tyrefem.sweep.campaign import CampaignData


def run(
    study: StudyArgument,
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results; default: results/STUDY.")] = None,
    pictures: Annotated[bool, typer.Option(help="Draw the PNG pictures and the HTML report.")] = True,
    vtk: Annotated[bool, typer.Option(help="Write the .pvd and .vtu files.")] = True,
    revolved: Annotated[bool, typer.Option("--revolved", help="Write the VTK files of the whole ring too.")] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="Write the tables as Parquet files too.")] = False,
    force: ForceOption = False,
) -> None:
    """Simulate a study: temperatures, heat budget, rolling resistance, VTK, pictures and a report.

    A study with a table of cases runs all cases, or the case of --case, and writes one table.
    """
    from tyrefem.api import study as load
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.reports.campaign import campaign_files
    from tyrefem.reports.run_files import run_files

    values = settings(changes)
    loaded = load(study, values, case)
    place = out or _usual_place(loaded)
    given: dict[str, Any] = {
        "origin": StudyOrigin(loaded, simulated=True),
        "inputs": [entry.table for entry in loaded.measured],
        "force": force,
    }
    if loaded.is_campaign:
        campaign = loaded.campaign()
        _refuse_overlaid(campaign, values)
        with results_folder(place, "run", campaign_files(campaign, place), **given) as folder:
            table = _campaign(campaign, folder, pictures, vtk, revolved, parquet)
        _tell_campaign(campaign, table, folder, pictures)
    else:
        with results_folder(place, "run", run_files(loaded, place), **given) as folder:
            words = _single(loaded, folder, pictures, vtk, revolved, parquet)
        # After the folder is closed: a line that cannot be printed leaves it complete.
        say(*words)
        answer_with(folder / "summary.json")


def _usual_place(study: Study) -> Path:
    """The folder of the results without ``--out``: ``results/STUDY``, but not the one that the study stands in."""
    place = Path("results") / study.name
    taken = study.folder is not None and place.resolve() == study.folder.resolve()
    return place.with_name(f"{study.name}-run") if taken else place


def _single(study: Study, folder: Path, pictures: bool, vtk: bool, revolved: bool, parquet: bool) -> tuple[str, ...]:
    """Run and write; the lines for people."""
    from tyrefem.reports.run_files import write_tables
    from tyrefem.simulation.estimate import RunEstimate

    warned = warn(study.warnings)
    begins = f"{study.name}{RunEstimate.of(study).beginning}"
    with stages() as tick:
        result = study.run(counted(tick, begins, study.name, study.card.drive.end), partial=True)
    reached = f"{result.times[-1]:g} s" if result.history.interrupted else ""
    tables = f"the tables up to {reached}" if reached else "the tables"
    with keeping(f"{tables} are in {folder}, pictures and VTK files are not complete"):
        with interruption_delayed():
            write_tables(result, folder, parquet=parquet)
        with stages() as tick:
            if vtk:
                tick(f"{study.name}: VTK", 0, 0)
                result.to_vtk(folder / "vtk", revolved=revolved)
            if pictures:
                tick(f"{study.name}: pictures and report", 0, 0)
                result.plot(folder / "pictures")
                result.report(folder / "report.html")
    warn(() if reached else result.warnings, warned)
    words = _words(result), f"results in {folder}" + (f"; read {folder / 'report.html'}" if pictures else "")
    if reached:
        say(*words)
        answer_with(folder / "summary.json")
        raise Interrupted(f"finished files are in {folder}", at=reached)
    return words


def _words(result: Result) -> str:
    peak, region = result.extreme_rows[0], result.summary()["hottest"]["region"]
    from tyrefem.reports.run_files import loaded_cycle, of_run
    from tyrefem.reports.words import motion_words, phase_lines

    resistance, budget = result.rolling_resistance, result.heat_budget
    rubbed = "" if result.sliding is None else f"sliding {budget.total('sliding') / 1e3:.1f} kJ, "
    rests = [phase.name for phase in result.study.card.drive.phases if phase.stops]
    during = f", end of {resistance.phase}" if len(result.phases) > 1 and resistance.phase else ""
    during = f", last reading before rest in {resistance.phase}" if resistance.phase in rests else during
    lifted = [phase.name for phase in result.study.card.drive.phases if phase.unloads and not phase.stops]
    during = f", last reading under load in {resistance.phase}" if resistance.phase in lifted else during
    lines = [
        result.study.title,
        f"  hottest point       {peak['temperature_degC']:7.1f} degC in the {region}, {peak['s_m'] * 1e3:.0f} mm along "
        f"the meridian, {peak['depth_m'] * 1e3:.1f} mm deep, at {peak['time_s']:.0f} s",
        f"  rolling resistance  {resistance.force:7.1f} N, coefficient {resistance.coefficient:.4f} "
        f"(cold {resistance.cold_force:.1f} N, {resistance.cold_coefficient:.4f}){during}",
        f"  contained air       {result.gas_temperature[-1]:7.1f} degC, {result.gas_pressure[-1] / 1e3:.0f} kPa gauge",
        f"  heat generated      {budget.total('generated') / 1e3:7.1f} kJ, {rubbed}stored "
        f"{budget.total('stored') / 1e3:.1f} kJ, lost {budget.total('lost') / 1e3:.1f} kJ; "
        f"{budget.closing}",
    ]
    cycle = loaded_cycle(result)
    if cycle is not None:
        motion = result.study.card.mechanics.motion
        error = cycle.linearisation_error if motion == "linear" else None
        lines.append(f"  motion              {motion_words(motion, error)}")
    if result.feedback is not None:
        lines.append(f"  feedback            {result.feedback.words}")
    lines += [f"  {value.words}" for value in of_run(result)]
    if result.sliding is not None:
        lines += list(phase_lines(result.sliding))
    return "\n".join(lines)


def _campaign(
    campaign: CampaignData, folder: Path, pictures: bool, vtk: bool, revolved: bool, parquet: bool
) -> pd.DataFrame:
    """Run all cases and write; the table of cases."""
    from tyrefem.reports.campaign import run_campaign, write_campaign_report

    study = campaign.study

    def each(result: Result, place: Path) -> None:
        for warning in result.warnings:
            notify(f"warning: {place.name}: {warning}")
        if vtk:
            result.to_vtk(place / "vtk", revolved=revolved)
        if pictures:
            result.report(place / "report.html")

    table_file = folder / "campaign.csv"
    kept = f"finished cases are in {table_file}"
    with keeping(lambda: kept if table_file.exists() else "nothing was written"):
        with progress(study.name, len(campaign.cases)) as step:
            table = run_campaign(campaign, folder, lambda done, _all: step(done), each, parquet=parquet)
        if pictures:
            write_campaign_report(campaign, table, folder / "report.html")
    return table


def _tell_campaign(campaign: CampaignData, table: pd.DataFrame, folder: Path, pictures: bool) -> None:
    study, failed = campaign.study, table[table["failure"] != ""]
    answer_with({"study": study.name, "cases": table.to_dict("records")})
    shown = ["case", "hottest_degC", "rolling_resistance_coefficient", "contained-air_degC"]
    say(study.title)
    say(table[[name for name in shown if name in table]].to_string(index=False, float_format="%.4g"))
    say(f"{len(table)} case{'' if len(table) == 1 else 's'}, {len(failed)} failed; table in {folder / 'campaign.csv'}")
    if pictures:
        say(f"results in {folder}; read {folder / 'report.html'}")
    for entry in failed.itertuples():
        fail(f"case {entry.case}: {entry.failure}")
    if len(failed):
        raise typer.Exit(1)


def _refuse_overlaid(campaign: CampaignData, values: dict[str, Any]) -> None:
    """Refuse a change of a value that the table of cases sets again."""
    for key in values:
        again = {
            case.name: other
            for case in campaign.cases
            for other in case.changes
            if overlays(campaign.study.data, other, key)
        }
        if again:
            cases = "every case" if len(again) == len(campaign.cases) else f"case {', '.join(list(again)[:3])}"
            more = f" and {len(again) - 3} more" if 3 < len(again) < len(campaign.cases) else ""
            other = next(iter(again.values()))
            raise InputError(
                f"'{key}' is set again by '{other}' of {cases}{more}: change it in {campaign.study.card.cases}",
                field="--set",
            )


def overlays(data: Mapping[str, Any], column: str, key: str) -> bool:
    """Whether a column of the table of cases sets a value again: the same, a part or the whole, load or deflection.

    >>> overlays({"section": "nasa"}, "section.crown_radius", "section.parameters.crown_radius")
    True
    """
    from tyrefem.inputs.changes import alternatives

    set_again, (place, *_) = alternatives(data, column), alternatives(data, key)
    return place in set_again or place.startswith(f"{set_again[0]}.") or set_again[0].startswith(f"{place}.")


#: Place among the commands.
ORDER = 10


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(run)
