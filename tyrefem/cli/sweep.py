"""`tyrefem sweep`: many variants of a study, one table of answers and one page."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.cli.common import JsonOption, SetOption, fail, print_json, settings, writable_folder
from tyrefem.errors import InputError

if TYPE_CHECKING:
    from tyrefem.sweep.plan import Plan
    from tyrefem.sweep.schedulers import Scheduler


def sweep(
    study: Annotated[str, typer.Argument(metavar="STUDY|FILE", help="A study's name or path, or a sweep file.")],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=VALUES",
            help="'drive.speed=10 mph:40 mph:4' (from, to, levels), 'materials.tread=soft,hard', "
            "'materials.tread.loss_tangent.value=x0.8:x1.2' (factors). Repeatable.",
        ),
    ] = None,
    sample: Annotated[str, typer.Option(help="grid, latin-hypercube, sobol or list.")] = "grid",
    count: Annotated[int | None, typer.Option(min=1, help="How many variants; not of a grid.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the sample.")] = 1,
    cases: Annotated[str | None, typer.Option(help="CSV file of variants (sample 'list').")] = None,
    limit: Annotated[
        list[str] | None, typer.Option("--limit", metavar="ANSWER<VALUE", help="E.g. 'hottest_degC<110'. Repeatable.")
    ] = None,
    time_to: Annotated[str | None, typer.Option(help="Temperature whose first reaching is an answer.")] = None,
    changes: SetOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: results/STUDY-sweep.")] = None,
    reduced: Annotated[str, typer.Option(help="Use a certified reduced model: auto, never, always.")] = "auto",
    tolerance: Annotated[str, typer.Option(help="Error that its certificate allows.")] = "0.01 K",
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core.")] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="A Dask cluster's scheduler.")
    ] = None,
    restart: Annotated[bool, typer.Option("--restart", help="Forget finished variants in the folder.")] = False,
    pictures: Annotated[bool, typer.Option(help="Draw the pictures and the page.")] = True,
    as_json: JsonOption = False,
) -> None:
    """Answer many variants of a study: a table (CSV, Parquet), pictures and one page.

    Finished variants are kept: the same command goes on where an interrupted or killed one was.
    """
    from tyrefem.quantity import parse
    from tyrefem.sweep.output import write
    from tyrefem.sweep.sweep import sweep as run

    if reduced not in ("auto", "never", "always"):
        raise InputError(f"'{reduced}' is not allowed; allowed: auto, never, always", field="--reduced")
    plan = _plan(study, vary, sample, count, seed, cases, limit, time_to, settings(changes))
    folder = writable_folder(out or Path("results") / f"{plan.study.name}-sweep")
    with several(quiet=as_json) as tick:
        found = run(
            plan,
            scheduler=_scheduler(scheduler, workers),
            folder=folder,
            restart=restart,
            reduced=reduced,
            tolerance=parse(tolerance, "delta_degC"),
            progress=tick,
        )
    summary = write(found, folder, pictures=pictures)
    if as_json:
        print_json(summary)
    else:
        for line in summary["words"]:
            typer.echo(line)
        typer.echo(f"results in {folder}" + (f"; read {folder / 'sweep.html'}" if pictures else ""))
    for name, reason in list(found.failed.items())[:10]:
        fail(f"variant {name}: {reason}")
    if len(found.failed) > 10:
        fail(f"... and {len(found.failed) - 10} more; all are in {folder / 'sweep.csv'}")
    if found.interrupted:
        finished = f"{len(found.outcomes)} of {len(plan.variants)} variants"
        kept = f"{found.interrupted}; {finished} are kept, the same command goes on"
        raise typer.Exit(fail(kept, 130 if found.interrupted == "interrupted" else 1))
    if found.failed:
        raise typer.Exit(1)


def _plan(
    study: str,
    vary: list[str] | None,
    sample: str,
    count: int | None,
    seed: int,
    cases: str | None,
    limit: list[str] | None,
    time_to: str | None,
    changes: dict[str, Any],
) -> Plan:
    from tyrefem.cards import read_toml
    from tyrefem.studies import study as load
    from tyrefem.sweep.card import SweepCard
    from tyrefem.sweep.plan import planned

    path, near, data = Path(study), None, {}
    if path.suffix == ".toml" and path.is_file() and "study" in (written := read_toml(path)):
        data, near = dict(written), path.parent
    else:
        data = {"study": study, "sample": sample, "seed": seed}
    if cases is not None:
        data |= {"cases": cases, "sample": "list"}
    if count is not None:
        data["count"] = count
    if time_to is not None:
        data["time_to"] = time_to
    data["vary"] = {**data.get("vary", {}), **dict(_varied(one) for one in vary or [])}
    data["limits"] = {**data.get("limits", {}), **dict(_limit(one) for one in limit or [])}
    card = SweepCard.check(data, path if near else None)
    name = card.study
    if near is not None and (near / name).exists():
        name = str(near / name)
    return planned(load(name, {**card.change, **changes}), card, near)


def _varied(text: str) -> tuple[str, dict[str, Any]]:
    """One ``--vary``.

    >>> _varied("drive.speed=10 mph:40 mph:4")
    ('drive.speed', {'from': '10 mph', 'to': '40 mph', 'levels': 4})
    >>> _varied("materials.tread=soft,hard")
    ('materials.tread', {'values': ['soft', 'hard']})
    """
    key, equals, values = text.partition("=")
    if not equals or not key.strip() or not values.strip():
        raise InputError(f"'{text}' is not KEY=VALUES, e.g. 'drive.speed=10 mph:40 mph:4'", field="--vary")
    parts = [part.strip() for part in values.split(":")]
    if len(parts) == 1:
        return key.strip(), {"values": [_plain(part.strip()) for part in values.split(",")]}
    if len(parts) > 3:
        raise InputError(f"'{values}' has more than from:to:levels", field="--vary")
    levels: dict[str, Any] = {}
    if len(parts) == 3:
        if not parts[2].isdigit():
            raise InputError(f"'{parts[2]}' is not a number of levels", field="--vary")
        levels = {"levels": int(parts[2])}
    if parts[0].startswith("x") and parts[1].startswith("x"):
        try:
            return key.strip(), {"factor": [float(parts[0][1:]), float(parts[1][1:])], **levels}
        except ValueError:
            raise InputError(f"'{values}' are not two factors, e.g. x0.8:x1.2", field="--vary") from None
    return key.strip(), {"from": _plain(parts[0]), "to": _plain(parts[1]), **levels}


def _plain(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _limit(text: str) -> tuple[str, dict[str, float]]:
    match = re.fullmatch(r"\s*([\w .+-]+?)\s*([<>])\s*([-+\d.eE]+)\s*", text)
    if match is None:
        raise InputError(f"'{text}' is not ANSWER<VALUE or ANSWER>VALUE, e.g. 'hottest_degC<110'", field="--limit")
    try:
        return match[1], {"below" if match[2] == "<" else "above": float(match[3])}
    except ValueError:
        raise InputError(f"'{match[3]}' is not a number", field="--limit") from None


def _scheduler(address: str | None, workers: int | None) -> Scheduler:
    from tyrefem.sweep.cluster import Dask
    from tyrefem.sweep.schedulers import Here, Local

    if address is not None:
        return Dask(address)
    count = workers or os.cpu_count() or 1
    return Local(count) if count > 1 else Here()


@contextmanager
def several(*, quiet: bool = False) -> Iterator[Callable[[str, int, int], None]]:
    """A function that takes what is done, how many, and of how many; a bar with the time left on a terminal."""
    import sys

    if quiet or not sys.stderr.isatty():
        yield lambda what, done, total: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        tasks: dict[str, Any] = {}

        def tick(what: str, done: int, total: int) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=total)
            bar.update(tasks[what], completed=done, total=total)

        yield tick


#: Place among the commands.
ORDER = 15


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(sweep)
