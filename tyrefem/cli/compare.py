"""`tyrefem compare`: computed against measured, in kelvin."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import JsonOption, SetOption, StudyArgument, print_json, settings, writable_folder


def compare(
    study: StudyArgument,
    table: Annotated[
        Path | None, typer.Argument(metavar="[TABLE]", help="CSV of thermocouple histories; default: the study's own.")
    ] = None,
    changes: SetOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-compare.")] = None,
    ignore: Annotated[list[str] | None, typer.Option(help="A column of the table to leave out. Repeatable.")] = None,
    inputs: Annotated[
        bool, typer.Option(help="Propagate the cards' uncertainties into the validation uncertainty.")
    ] = True,
    k: Annotated[float, typer.Option("-k", min=0.1, help="Coverage factor of the validation uncertainty.")] = 2.0,
    as_json: JsonOption = False,
) -> None:
    """Compare a study with measured tables: deviation per sensor, run and phase, against the validation uncertainty."""
    from tyrefem.studies import study as load

    found = load(study, settings(changes))
    folder = writable_folder(out or Path("results") / f"{found.name}-compare")
    comparison = found.compare(table, ignore=tuple(ignore or ()), inputs=inputs, k=k)
    comparison.save(folder)
    if as_json:
        print_json(comparison.to_dict())
        return
    columns = ["run", "sensor", "phase", "n", "bias_K", "rms_K", "largest_K", "at_s", "u_val_K", "beyond"]
    typer.echo(comparison.table[columns].to_string(index=False, float_format="%.3g"))
    typer.echo(comparison.summary)
    for note in comparison.notes:
        typer.echo(f"note: {note}")
    typer.echo(f"results in {folder}; read {folder / 'comparison.html'}")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(compare)
