"""`tyrefem strain`: run a study with every strain law; compare strain energy and temperatures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    settings,
    warn,
)
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, notify, say, say_table
from tyrefem.errors import InputError, nearest
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.simulation.law_comparison import LawComparison

#: Files that the command writes.
FILES = ("strain.json", "strain.csv", "strain.png")
#: Kind of row -> heading and unit factor of the printed table.
KINDS = {
    "deflection": ("", 1e3),
    "energy": ("strain energy, largest change, J", 1.0),
    "density": ("its mean, kJ/m3", 1e-3),
    "heating": ("energy that heats, all cycles of a revolution, J", 1.0),
    "coefficient": ("rolling resistance coefficient, 1/1000", 1e3),
    "temperature": ("temperature at the end (hottest: ever), degC", 1.0),
}


def strain(
    study: StudyArgument,
    law: Annotated[
        list[str] | None, typer.Option("--law", help="arcs, barrel or fem; repeatable. Default: all.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-strain.")] = None,
    force: ForceOption = False,
    changes: SetOption = None,
    case: CaseOption = None,
) -> None:
    """Run a study with every strain law; compare strain energy by region and temperatures."""
    from tyrefem.api import study as load_study
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.output import atomic_folder, write_json
    from tyrefem.simulation.law_comparison import NEEDS, compare_laws, compared_laws

    known = compared_laws()
    wanted = tuple(dict.fromkeys(law or known))
    for law_name in wanted:
        if law_name not in known:
            raise InputError(f"no strain law '{law_name}' to compare{nearest(law_name, known)}", field="--law")
    chosen = load_study(study, settings(changes), case)
    NEEDS.check(chosen)
    warn(chosen.warnings)
    origin = StudyOrigin(chosen, simulated=True).using(list(wanted))
    place = out or Path("results") / f"{chosen.name}-strain"
    with (
        results_folder(place, "strain", FILES, origin=origin, force=force) as folder,
        progress(f"{chosen.name}: {', '.join(wanted)}"),
    ):
        comparison = compare_laws(chosen, wanted)
        summary = comparison.summary()
        with atomic_folder(folder) as temporary:
            write_json(summary, temporary / "strain.json")
            comparison.table().to_csv(temporary / "strain.csv", index=False)
            (temporary / "strain.png").write_bytes(_picture(comparison))
    for refused, why in comparison.refused.items():
        notify(f"warning: the strain law '{refused}' has no solution: {why}")
    answer_with(summary)
    _print(comparison)
    say(f"results in {folder}")


def _picture(comparison: LawComparison) -> bytes:
    from tyrefem.reports.figures.strain_laws import strain_laws_figure
    from tyrefem.reports.figures.style import png

    return png(strain_laws_figure(comparison))


def _print(comparison: LawComparison) -> None:
    from rich.table import Table
    from rich.text import Text

    titles = {
        part.name: part.name if part.name == part.title else f"{part.name} {part.title}" for part in comparison.parts
    }
    laws = [outcome.law for outcome in comparison.outcomes]
    table = Table(title=comparison.study.title, title_justify="left", title_style="bold")
    table.add_column("")
    for law in laws:
        table.add_column(law, justify="right")
    before = "deflection"
    for row in comparison.table().to_dict("records"):
        heading, factor = KINDS[row["kind"]]
        if row["kind"] != before:
            before = row["kind"]
            table.add_section()
            table.add_row(Text(heading, style="bold"))
        name = "deflection, mm" if row["kind"] == "deflection" else titles.get(row["name"], row["name"])
        table.add_row(name, *(f"{factor * row[law]:.2f}" for law in laws))
    say_table(table)


#: Place among the commands.
ORDER = 46


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(strain)
