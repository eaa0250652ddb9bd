"""`tyrefem rig`: simulate the laser rig, identify layers from measured tables, compare numbers of layers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from tyrefem.cli.common import ForceOption, IgnoreOption, RenameOption, options_named, renamed, warn
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError, Interrupted
from tyrefem.interruption import interruption_delayed
from tyrefem.output.folder import results_folder

group = typer.Typer(
    name="rig",
    help="Laser rig: conductivity and specific heat of a tyre's layers from heating tests.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
RigArgument = Annotated[str, typer.Argument(metavar="RIG", help="A rig's name, rig.toml or folder, e.g. trtlab.")]
OutOption = Annotated[Path | None, typer.Option("--out", help="Folder; default: results/rig-...")]
#: Typical number of simulated tests in the fit of one model, for the progress bar.
_USUAL = 16


@group.command()
def simulate(
    rig: RigArgument,
    out: OutOption = None,
    every: Annotated[str, typer.Option(help="Time between readings.")] = "5 s",
    seed: Annotated[int | None, typer.Option(help="Seed of the instruments' noise; default: no noise.")] = None,
    force: ForceOption = False,
) -> None:
    """Simulate the sensors' readings in the card's tests: one table per run, pictures."""
    from tyrefem import rig as rigs
    from tyrefem.heating_test.files import beside
    from tyrefem.quantity import parse
    from tyrefem.reports.rig import simulation_files, write_simulation

    card, file = rigs.load(rig)
    warn(warning.within(file=file) for warning in card.warnings())
    place = out or Path("results") / f"rig-{_name(file)}"
    try:
        step = parse(every, "s")
    except InputError as error:
        raise error.within(field="--every") from None
    if seed is not None and seed < 0:
        raise InputError("must not be negative", field="--seed")
    with (
        results_folder(
            place, "rig simulate", simulation_files(card), origin=None, inputs=beside(card, file), force=force
        ) as folder,
        progress(f"{_name(file)}: simulated tests"),
    ):
        with options_named({"every": "--every"}):
            done = rigs.simulate(file, every=step, seed=seed)
        write_simulation(done, folder)
    rows = {name: run.temperatures.max().round(2).to_dict() for name, run in done.runs.items()}
    answer_with({"highest_degC": rows, "words": done.words, "folder": folder})
    for name, highest in rows.items():
        seen = ", ".join(f"{sensor} {value:.1f}" for sensor, value in highest.items())
        say(f"{name} ({card.runs[name].power:g} W): highest readings, degC: {seen}")
    for words in done.words:
        say(f"note: {words}")
    say(f"results in {folder}")


@group.command()
def identify(
    rig: RigArgument,
    tables: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[TABLE...]", help="CSV or Excel files; runs named as in the card. Default: CSV beside it."
        ),
    ] = None,
    out: OutOption = None,
    base: Annotated[
        list[str] | None,
        typer.Option(
            help="Card with data that a rig cannot measure (loss tangent ...): CARD or LAYER=CARD. Repeatable."
        ),
    ] = None,
    without: Annotated[list[str] | None, typer.Option(help="Leave out this sensor of the card. Repeatable.")] = None,
    rename: RenameOption = None,
    ignore: IgnoreOption = None,
    constant: Annotated[bool, typer.Option("--constant", help="Properties that do not depend on temperature.")] = False,
    force: ForceOption = False,
) -> None:
    """Identify every layer's conductivity and specific heat with 95 % intervals; list what remains undetermined."""
    from tyrefem import rig as rigs
    from tyrefem.heating_test.files import tables as tables_of
    from tyrefem.heating_test.layer_cards import bases
    from tyrefem.heating_test.verdict import name_in_words, shown
    from tyrefem.reports.rig import FILES, save

    card, file = rigs.load(rig)
    warn(warning.within(file=file) for warning in card.warnings())
    given = tables_of(card, file, tables or ())
    with options_named({"without": "--without"}):
        tests = rigs.read(card, given, without or (), rename=renamed(rename), ignore=ignore or ())
    chosen = bases(card, base or [])
    count = 0
    total = _USUAL * len(tests)
    with results_folder(
        out or Path("results") / f"rig-{_name(file)}-identified", "rig identify", FILES, origin=None, force=force
    ) as folder:
        with progress(f"{_name(file)}: computed tests", total) as step:

            def one_more() -> None:
                nonlocal count
                count += 1
                step(min(count, total))

            identification = rigs.identify(file, tests=tests, linear=not constant, progress=one_more)
        save(identification, folder, base or [])
    answer_with(identification.to_dict())
    for estimate in identification.properties:
        say(f"{name_in_words(estimate.name):34}{shown(estimate, 4):42}{estimate.verdict}")
    for words in identification.words:
        say(f"- {words}")
    say(f"results in {folder}; read {folder / 'report.html'}")
    if chosen:
        say("material cards: " + ", ".join(str(folder / "materials" / f"{layer}.toml") for layer in chosen))
    else:
        say("no material card written: name the card with loss tangent and stiffness by --base")


@group.command()
def layers(
    rig: RigArgument,
    tables: Annotated[
        list[Path] | None, typer.Argument(metavar="[TABLE...]", help="CSV or Excel files; default: simulated.")
    ] = None,
    out: OutOption = None,
    rename: RenameOption = None,
    ignore: IgnoreOption = None,
    most: Annotated[int, typer.Option(min=1, help="Largest number of layers to fit.")] = 4,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the noise of simulated readings.")] = 1,
    force: ForceOption = False,
) -> None:
    """Fit one set of readings with 1, 2, 3 ... layers, to see what more layers improve."""
    from tyrefem import rig as rigs
    from tyrefem.heating_test.files import tables as tables_of
    from tyrefem.heating_test.layer_study import LayerStudy, fits
    from tyrefem.heating_test.readings import matched
    from tyrefem.reports.rig import LAYER_FILES, save_layer_table, save_layers

    card, file = rigs.load(rig)
    warn(warning.within(file=file) for warning in card.warnings())
    if (rename or ignore) and not tables:
        raise InputError("is for a table of readings; none is given", field="--rename" if rename else "--ignore")
    given = tables_of(card, file, tables) if tables else ()
    tests = rigs.read(card, given, rename=renamed(rename), ignore=ignore or ()) if given else ()
    counts = range(1, min(most, len(card.layers)) + 1)
    place, drawn = out or Path("results") / f"rig-{_name(file)}-layers", None if tests else seed
    with results_folder(place, "rig layers", LAYER_FILES, origin=None, force=force) as folder:
        finished: dict[int, Any] = {}
        try:
            with progress(f"{_name(file)}: layers", counts[-1]) as step:
                if not tests:
                    done = rigs.simulate(card, seed=seed)
                    tests = tuple(matched(card, run, list(card.sensors)) for run in done.runs.values())
                for count, fit in fits(card, tests, counts):
                    finished[count] = fit
                    step(count)
        except KeyboardInterrupt:
            if not finished:
                raise
            with interruption_delayed():
                save_layer_table(
                    LayerStudy(tuple(finished), tuple(finished.values())), folder, complete=False, seed=drawn
                )
            raise Interrupted(f"{len(finished)} of {len(counts)} fits are in {folder / 'layers.csv'}") from None
        comparison = LayerStudy(tuple(finished), tuple(finished.values()))
        save_layers(comparison, folder, seed=drawn)
    answer_with({"rows": comparison.table().to_dict("records")})
    say(comparison.table().to_string(index=False, float_format="%.3g"))
    for words in comparison.words:
        say(f"- {words}")
    say(f"results in {folder}")


def _name(file: Path) -> str:
    return file.resolve().parent.name.removeprefix("rig-") if file.name == "rig.toml" else file.stem


#: Place among the commands.
ORDER = 85


def register(app: typer.Typer) -> None:
    """Add the group of commands."""
    app.add_typer(group)
