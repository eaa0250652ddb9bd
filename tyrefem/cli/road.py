"""`tyrefem road`: film between tread and road, its published tables, and the error of averaging it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.cli.common import ForceOption
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.file import PICTURES, results_file
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.boundaries import Contact

road = typer.Typer(
    name="road",
    help="The film between tread and road (Cattani et al. 2023): tables, one contact, averaging.",
    no_args_is_help=True,
)
Conductivity = Annotated[str, typer.Option("--conductivity", help="Tread's conductivity.")]
HeatCapacity = Annotated[str, typer.Option("--heat-capacity", help="Tread's heat capacity by volume.")]
#: Allowed range of each quantity, by unit: no road, tread or contact is outside.
LEAST = {"m/s": 1e-6, "m": 1e-4, "W/m/K": 1e-4, "J/m**3/K": 1e3}
HOTTEST = 2000.0
MOST = {"m/s": 400.0, "m": 10.0, "W/m/K": 1e4, "J/m**3/K": 1e9}
#: Speeds (km/h) and footprint lengths (m) of the averaging sweep.
SPEEDS = (0.2, 0.5, 1, 2, 5, 10, 15, 20, 50, 100, 200, 300)
LENGTHS = (0.10, 0.14, 0.20, 0.30)
#: Shipped laws of the road film in words.
FILMS = {
    "constant": "value of the NASA report, at every speed",
    "cattani": "sqrt(lambda C v/FL)",
    "half-space": "exact, road of its own effusivity",
}


def _positive(text: str, unit: str, option: str) -> float:
    from tyrefem.quantity import Unit

    try:
        return Unit(unit, gt=0, ge=LEAST[unit], le=MOST[unit])(text)
    except InputError as error:
        raise error.within(field=option) from None


def _paper_table(number: int) -> pd.DataFrame:
    """Read a table of the paper."""
    import pandas as pd

    from tyrefem.library import shipped

    return pd.read_csv(shipped() / "studies" / "cattani-road" / f"table-{number}.csv", comment="#")


@road.command()
def table() -> None:
    """Print tables 1 and 2 of the paper: printed value, recomputed value and deviation."""
    from tyrefem.boundaries.road_film import triangular_film
    from tyrefem.reports.figures.road import PAPER

    rows_1, rows_2 = [], []
    say("Table 1: v m/s, FL m, literature, printed, recomputed H_c W/m2/K, recomputed - literature")
    for v, length, literature, printed in _paper_table(1).itertuples(index=False):
        film = triangular_film(v, length, *PAPER)
        rows_1.append(
            {
                "speed_m_s": v,
                "footprint_length_m": length,
                "literature_W_m2_K": literature,
                "printed_W_m2_K": printed,
                "recomputed_W_m2_K": film,
            }
        )
        say(f"{v:8g} {length:6.2f} {literature:9.0f} {printed:9.0f} {film:11.2f} {film / literature - 1:+8.1%}")
    say("Table 2: v km/h, FL m, printed, recomputed H_c W/m2/K, recomputed - printed")
    largest, count, printed_2 = 0.0, 0, _paper_table(2)
    lengths = [float(name.split("_")[1]) for name in printed_2.columns[1:]]
    for speed, *films in printed_2.itertuples(index=False):
        for length, printed in zip(lengths, films, strict=True):
            film = triangular_film(speed / 3.6, length, *PAPER)
            largest, count = max(largest, abs(film - printed)), count + 1
            rows_2.append(
                {
                    "speed_km_h": speed,
                    "footprint_length_m": length,
                    "printed_W_m2_K": printed,
                    "recomputed_W_m2_K": film,
                }
            )
            say(f"{speed:8g} {length:6.2f} {printed:9.2f} {film:9.2f} {film - printed:+8.3f}")
    say(f"largest deviation of {count} values in table 2: {largest:.3f} W/m2/K")
    answer_with({"table_1": rows_1, "table_2": rows_2, "largest_deviation_of_table_2_W_m2_K": largest})


@road.command()
def film(
    speed: Annotated[str, typer.Option("--speed", help="Speed, e.g. '50 km/h'.")],
    footprint: Annotated[str, typer.Option("--footprint", help="Footprint length, e.g. '0.14 m'.")],
    conductivity: Conductivity = "0.25 W/m/K",
    heat_capacity: HeatCapacity = "2e6 J/m**3/K",
    road_conductivity: Annotated[str | None, typer.Option(help="Road's conductivity; default: asphalt.")] = None,
    road_heat_capacity: Annotated[str | None, typer.Option(help="Road's heat capacity; default: asphalt.")] = None,
) -> None:
    """Print the film coefficient of one contact by every law, and its penetration depth in the tread."""
    from tyrefem.boundaries import Contact
    from tyrefem.boundaries.road_film import half_space_film, propagation_depth

    v, length = _positive(speed, "m/s", "--speed"), _positive(footprint, "m", "--footprint")
    k = _positive(conductivity, "W/m/K", "--conductivity")
    C = _positive(heat_capacity, "J/m**3/K", "--heat-capacity")
    of_road: dict[str, Any] = {}
    if road_conductivity is not None:
        of_road["road_conductivity"] = road_conductivity
    if road_heat_capacity is not None:
        of_road["road_heat_capacity"] = road_heat_capacity
    films = _films(Contact(v, length, k, C), of_road)
    lines = [f"{name:16} {value:10.1f} W/m2/K  {FILMS.get(name, 'with its example')}" for name, value in films.items()]
    ideal = half_space_film(v, length, k, C)
    lines.append(f"{'half-space':16} {ideal:10.1f} W/m2/K  exact, road of constant temperature")
    depth = propagation_depth(length / v, k, C)
    lines.append(f"{'contact':16} {length / v * 1e3:10.4g} ms, penetrates {depth * 1e3:.4g} mm into the tread")
    say("\n".join(lines))
    answer_with(
        {
            "films_W_m2_K": films,
            "constant_road_temperature_W_m2_K": ideal,
            "contact_s": length / v,
            "penetration_m": depth,
        }
    )


def _films(contact: Contact, of_road: dict[str, Any]) -> dict[str, float]:
    """Law -> film of a contact, W/m2/K. A law of the user has the values of its example; one without them is left out.

    ``of_road``: the road's values for ``half-space``.
    """
    from tyrefem.boundaries import laws
    from tyrefem.contracts.law import example_table
    from tyrefem.plugins import working

    films = {}
    for name, law in sorted(laws("road").items()):
        try:
            chosen: Any = law.check(example_table(law, name) | (of_road if name == "half-space" else {}))
        except InputError as error:
            if name not in FILMS:
                continue
            raise InputError(error.message, field=f"--{error.field}".replace("_", "-")) from None
        films[name] = working(chosen).film(contact)
    return films


@road.command()
def averaging(
    out: Annotated[Path | None, typer.Option("--out", help="PNG, PDF or SVG to draw.")] = None,
    thickness: Annotated[str, typer.Option("--thickness", help="Tread thickness.")] = "10 mm",
    inner_temperature: Annotated[
        str, typer.Option("--inside", help="Temperature of the tread's inner side.")
    ] = "80 degC",
    conductivity: Conductivity = "0.25 W/m/K",
    heat_capacity: HeatCapacity = "2e6 J/m**3/K",
    force: ForceOption = False,
) -> None:
    """Compare the film averaged over the revolution with every contact resolved, over speed and footprint length."""
    from tyrefem.boundaries.averaging import TreadPoint, averaging_sweep
    from tyrefem.quantity import Unit
    from tyrefem.reports.figures.road import averaging_figure

    try:
        inside = Unit("degC", le=HOTTEST)(inner_temperature)
    except InputError as error:
        raise error.within(field="--inside") from None
    point = TreadPoint(
        speed=1.0,
        footprint_length=LENGTHS[0],
        thickness=_positive(thickness, "m", "--thickness"),
        conductivity=_positive(conductivity, "W/m/K", "--conductivity"),
        heat_capacity=_positive(heat_capacity, "J/m**3/K", "--heat-capacity"),
        inner_temperature=inside,
    )
    with nullcontext() if out is None else results_file(out, PICTURES, force=force):
        with progress("resolving contacts"):
            errors = averaging_sweep(point, [v / 3.6 for v in SPEEDS], LENGTHS)
        above = _print_averaging(errors)
        if out is not None:
            _save(averaging_figure(errors), out)
    rows = [
        {
            "footprint_length_m": error.point.footprint_length,
            "speed_m_s": error.point.speed,
            "resolved_degC": error.mean_surface,
            "averaged_degC": error.averaged_surface,
            "difference_K": error.surface_difference,
            "swing_K": error.swing,
        }
        for error in errors
    ]
    answer_with({"rows": rows, "holds_from_m_s": above, "picture": out})


def _print_averaging(errors: Sequence[Any]) -> dict[str, float | None]:
    """Print the rows; footprint length -> speed from which averaging holds, m/s."""
    from tyrefem.reports.figures.road import SMALL, holds_above

    say("FL m, v km/h: mean surface resolved, averaged degC; averaged - resolved K; swing in one contact K")
    for error in errors:
        v, length = error.point.speed * 3.6, error.point.footprint_length
        say(
            f"{length:5.2f} {v:7.1f} {error.mean_surface:9.2f} {error.averaged_surface:9.2f} "
            f"{error.surface_difference:+8.2f} {error.swing:8.2f}"
        )
    holds = {}
    for length in LENGTHS:
        above = holds_above([error for error in errors if error.point.footprint_length == length])
        holds[f"{length:g}"] = above
        where = f"from {above * 3.6:.4g} km/h" if above is not None else "at no speed of the sweep"
        say(f"footprint {length * 1e3:.0f} mm: averaging holds to {SMALL:g} K {where}")
    return holds


@road.command()
def figures(
    out: Annotated[Path, typer.Option("--out", help="Folder for the pictures.")], force: ForceOption = False
) -> None:
    """Redraw figures 4 and 5 of the paper."""
    from tyrefem.reports.figures.road import film_figure

    literature = _paper_table(1)
    points = list(zip(literature["speed_m_s"], literature["literature_Hc_W_m2K"], strict=True))
    with results_folder(out, "road figures", ("figure-4.png", "figure-5.png"), origin=None, force=force) as folder:
        _save(film_figure([0.14], points), folder / "figure-4.png")
        _save(film_figure([0.10, 0.12, 0.14, 0.16, 0.18]), folder / "figure-5.png")
    answer_with({"pictures": [folder / "figure-4.png", folder / "figure-5.png"]})


def _save(drawn: Any, path: Path) -> None:
    from tyrefem.output import atomic_path
    from tyrefem.reports.figures.style import picture

    with atomic_path(path) as temporary:
        temporary.write_bytes(picture(drawn, path.suffix))
    say(f"drawn in {path}")


#: Place among the commands.
ORDER = 70


def register(app: typer.Typer) -> None:
    """Add the group."""
    app.add_typer(road)
