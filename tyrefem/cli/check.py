"""`tyrefem check`: check a file without running it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.brief import counted
from tyrefem.cli.common import IgnoreOption, RenameOption, fail, renamed, warn
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError, nearest

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.rig import RigCard

#: Kinds of cards that may be checked by name, in this order.
KINDS = ("study", "sweep", "section", "material")


def check(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="A study, sweep, section or material (TOML, or its name), a table (CSV, Excel), or own plugins (.py).",
        ),
    ],
    study: Annotated[
        str | None, typer.Option("--study", metavar="STUDY", help="Of plugins: the study in which they are tried.")
    ] = None,
    ignore: IgnoreOption = None,
    rename: RenameOption = None,
) -> None:
    """Check a file without running it; report its first error.

    A Python file is loaded, and the contracts of its effects, laws and answers are tried in short runs.
    """
    path = Path(file)
    if path.suffix == ".py" and path.is_file():
        _refuse_names(rename, ignore)
        _plugins(path, study)
        return
    if study is not None:
        raise InputError("goes with a Python file of plugins", field="--study")
    if path.is_dir():
        from tyrefem.cards.file_kinds import FILES

        # A sweep, card or rig may have its study beside it: the study comes last.
        names = list(reversed(FILES.values()))
        path = path / next((name for name in names if (path / name).is_file()), FILES["study"])
        if not path.is_file():
            raise InputError(f"this folder has no {', '.join(names[:-1])} or {names[-1]}", file=file)
    if not os.path.lexists(path):
        from tyrefem import library

        known = {name: of_kind for kind in reversed(KINDS) for name, of_kind in library.names(kind).items()}
        if file not in known:
            hint = nearest(file, known)
            raise InputError(f"no such file, and no study, sweep, section or material of that name{hint}", file=file)
        path = known[file]
    is_card = path.suffix.lower() == ".toml"
    if is_card:
        _refuse_names(rename, ignore)
    with progress(f"{path.name}: checking"):
        words = _card(path) if is_card else _table(path, renamed(rename), ignore or [])
    answer_with({"file": path, "words": words})
    say(f"{path}: {words}")


def _refuse_names(rename: list[str] | None, ignore: list[str] | None) -> None:
    """Raises InputError for names of columns: only a measured table has them."""
    if rename or ignore:
        message = "goes with a measured table; in a study both are keys of its [[measured]] entries, rename and ignore"
        raise InputError(message, field="--rename" if rename else "--ignore")


def _plugins(path: Path, study: str | None) -> None:
    """Print every contract of a file's plugins; exit code 2 if one is not kept."""
    from tyrefem.contracts import check_file

    with progress(f"{path.name}: checking"):
        checked = check_file(path, study)
    say(*checked.lines)
    words = f"{checked.count} contracts, all kept"
    if checked.failed:
        words = f"{checked.failed} of {checked.count} contracts fail"
    answer_with({"file": path, "words": words, **checked.to_dict()})
    if checked.failed:
        raise typer.Exit(fail(f"{path}: {words}", 2))
    say(f"{path}: {words}")


def _table(path: Path, rename: dict[str, str], ignore: list[str]) -> str:
    from tyrefem.measured import read_table
    from tyrefem.measured.cases import looks_like_cases, read_cases

    if not rename and not ignore and looks_like_cases(path):
        cases = read_cases(path)
        number = counted(len(cases), "case")
        return f"a table of {number}; to check their values, run 'tyrefem check' on the study that names it"
    runs = read_table(path, rename=rename, ignore=ignore)
    sensors = sorted({sensor for run in runs for sensor in run.sensors})
    readings = sum(int(run.temperatures.notna().sum().sum()) for run in runs)
    channels = dict.fromkeys(heading for run in runs for heading in run.channels)
    left_out = f"; no temperatures, left out: {', '.join(channels)}" if channels else ""
    notes = "".join(f"; {note}" for note in dict.fromkeys(note for run in runs for note in run.notes))
    return (
        f"a measured table, {counted(len(runs), 'run')}, {counted(readings, 'reading')} of {', '.join(sensors)}"
        f"{left_out}{notes}"
    )


def _card(path: Path) -> str:
    from tyrefem.cards import read_toml
    from tyrefem.cards.file_kinds import kind_of

    data: dict[str, Any] = read_toml(path)
    if not data:
        raise InputError("is empty", file=path)
    kind = kind_of(data)
    if kind == "rig":
        from tyrefem.rig import RigCard

        rig = RigCard.check(data, path)
        warn(warning.within(file=path) for warning in rig.warnings())
        parts = {"layer": rig.layers, "sensor": rig.sensors, "run": rig.runs}
        words = ", ".join(counted(len(part), noun) for noun, part in parts.items())
        return f"a laser rig, {words}, {_rig_tables(rig, path)}"
    if kind == "thermal":
        from tyrefem.lumped.card import ThermalCard

        thermal = ThermalCard.check(data, path)
        bodies = f"{len(thermal.bodies)} bod{'y' if len(thermal.bodies) == 1 else 'ies'}"
        films, runs = counted(len(thermal.films), "film"), counted(len(thermal.runs), "run")
        return f"a thermal card of {bodies}, {films}, {runs}"
    if kind == "sweep":
        from tyrefem.sweep.design import loaded

        sweep = loaded(str(path.resolve()))
        warn(sweep.warnings)
        return f"a sweep: {sweep.words}"
    if kind == "section":
        from tyrefem.geometry import load

        section = load(str(path.resolve()))
        warn(warning.within(file=path) for warning in section.warnings)
        return (
            f"a section, {section.overall_width * 1e3:.1f} mm wide, {section.outer_diameter * 1e3:.1f} mm in diameter"
        )
    if kind == "material":
        from tyrefem.materials.card import material

        card = material(str(path.resolve()))
        warn(warning.within(file=path) for warning in card.warnings())
        return f"a material card, {card.title}"
    from tyrefem.api import study
    from tyrefem.compare.experiment import experiments
    from tyrefem.compare.omitted import table_notes
    from tyrefem.compare.study_check import check_study
    from tyrefem.mechanics.cautions import warnings_of

    checked = study(str(path.resolve()))
    if checked.is_campaign:
        campaign = checked.campaign()
        warned: list[str] = []
        for case in campaign.cases:
            study_of_case = campaign.case_study(case)
            check_study(study_of_case)
            warned += warn(warnings_of(study_of_case), warned)
        return f"a campaign of {counted(len(campaign.cases), 'case')}"
    tables = check_study(checked)
    _questions(checked)
    warn(checked.warnings)
    of_tables = table_notes(experiments(checked)) if tables else []
    notes = "".join(f"; {note.removeprefix('Note: ')}" for note in of_tables)
    return (
        f"a study of {counted(len(checked.card.drive.phases), 'phase')}, {checked.card.drive.end:g} s, "
        f"{counted(len(checked.sensors), 'sensor')}, {counted(tables, 'measured run')}{notes}"
    )


def _questions(study: StudyData) -> None:
    """Check the tables [explore] and [plan], where the study states them."""
    explore, plan = study.card.explore, study.card.plan
    if explore.model_fields_set & {"vary", "limits", "axes"}:
        from tyrefem.realtime.box_model import check_explore

        check_explore(study)
    if plan.limits:
        from tyrefem.plan.drives import candidate_drives

        candidate_drives(study)
    if plan.sensors:
        from tyrefem.plan.places import with_candidate_sensors

        with_candidate_sensors(study, study.sensors)


def _rig_tables(rig: RigCard, path: Path) -> str:
    """Describe the tables beside a rig's card. No table: the rig is simulated only; some of them: an error."""
    from tyrefem.heating_test.files import tables
    from tyrefem.rig import read

    if not any((path.parent / f"{run}.csv").is_file() for run in rig.runs):
        return "no table beside it"
    return f"{len(read(rig, tables(rig, path)))} table(s)"


#: Place among the commands.
ORDER = 50


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(check)
