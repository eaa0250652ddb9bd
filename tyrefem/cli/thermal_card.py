"""`tyrefem thermal-card`: films and heat capacities of a lumped tyre from plateaus and time constants."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tyrefem.cli.common import ForceOption
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.output.folder import results_folder


def thermal_card(
    file: Annotated[
        Path, typer.Argument(metavar="CARD", help="A thermal.toml: bodies, films, plateaus, time constants.")
    ],
    pictures: Annotated[bool, typer.Option(help="Draw the PNG picture.")] = True,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/CARD-thermal.")] = None,
    force: ForceOption = False,
) -> None:
    """Films and heat capacities of a tyre of few bodies, as real-time models have, with standard deviations.

    Measured plateau temperatures at given heat inputs and times of warm-up and cool-down go in.
    """
    from tyrefem.cards import read_toml
    from tyrefem.cards.file_kinds import expect_kind
    from tyrefem.errors import InputError
    from tyrefem.lumped.card import ThermalCard
    from tyrefem.lumped.identification import identify
    from tyrefem.reports.thermal_card import FILES, words, write_files

    path = file / "thermal.toml" if file.is_dir() else file
    data = read_toml(path)
    expect_kind("thermal", data, path)
    card = ThermalCard.check(data, path)
    name = path.resolve().parent.name if path.name == "thermal.toml" else path.stem
    with (
        results_folder(
            out or Path("results") / f"{name}-thermal", "thermal-card", FILES, origin=None, force=force
        ) as folder,
        progress(f"{name}: identifying"),
    ):
        try:
            result = identify(card)
        except InputError as error:
            raise error if error.file else error.within(file=path) from None
        write_files(result, folder, pictures=pictures)
    answer_with(result.to_dict())
    say(words(result), f"results in {folder}")


#: Place among the commands.
ORDER = 86


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("thermal-card")(thermal_card)
