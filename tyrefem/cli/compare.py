"""`tyrefem compare`: computed against measured, in kelvin."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import JsonOption, SetOption, StudyArgument, print_json, settings


def compare(
    study: StudyArgument,
    table: Annotated[
        Path | None, typer.Argument(metavar="[TABLE]", help="CSV of thermocouple histories; default: the study's own.")
    ] = None,
    changes: SetOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-compare.")] = None,
    ignore: Annotated[list[str] | None, typer.Option(help="A column of the table to leave out. Repeatable.")] = None,
    inputs: Annotated[
        bool | None, typer.Option(help="Propagate the cards' uncertainties into the validation uncertainty.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Compare a study with measured tables: deviation per sensor, run and phase, against the validation uncertainty."""
    from tyrefem.compare import compare as compared
    from tyrefem.studies import study as load

    found = load(study, settings(changes))
    comparison = compared(found, table, ignore=tuple(ignore or ()), inputs=inputs)
    folder = out or Path("results") / f"{found.name}-compare"
    comparison.save(folder)
    if as_json:
        print_json(comparison.to_dict())
        return
    shown = comparison.table.drop(
        columns=[c for c in comparison.table.columns if c.startswith("u_") and c != "u_val_K"]
    )
    typer.echo(shown.to_string(index=False, float_format="%.3g", max_colwidth=40))
    typer.echo(comparison.summary)
    typer.echo(f"results in {folder}")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(compare)
