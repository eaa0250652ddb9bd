"""`tyrefem slide`: heat of sliding friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from tyrefem.cli.common import ForceOption, options_named
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.file import PICTURES, results_file

group = typer.Typer(
    name="slide",
    help="Heat of sliding friction: a pad on a track, Roberts' tables, a locked wheel.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
#: Largest allowed value of each quantity, by unit: no pad, wheel or track has more.
MOST = {"m/s": 400.0, "m": 1e5, "1": 100.0, "Pa": 1e10, "N": 1e9, "delta_degC": 1e4}
#: Least value of each number of the locked wheel, SI.
LEAST = 1e-6
#: Speeds of the printed table of the locked wheel, km/h.
SPEEDS = (10, 20, 30, 40, 50, 60, 80, 100, 130)


def complete_solids(incomplete: str) -> list[str]:
    """Solids for shell completion."""
    from tyrefem.boundaries.friction_names import SOLIDS

    return [name for name in SOLIDS if name.startswith(incomplete)]


@group.command()
def rise(
    speed: Annotated[str, typer.Option(help="Sliding speed, e.g. '0.35 m/s' or '50 km/h'.")],
    length: Annotated[str, typer.Option(help="Pad length along the way, e.g. '225 mm'.")],
    friction: Annotated[str, typer.Option(help="Coefficient of friction, e.g. 0.5.")],
    pressure: Annotated[str | None, typer.Option(help="Contact pressure, e.g. '300 kPa'.")] = None,
    load: Annotated[
        str | None, typer.Option(help="Load, instead of a pressure, e.g. '12.8 kgf'; needs --breadth.")
    ] = None,
    breadth: Annotated[str | None, typer.Option(help="Pad breadth across the way, e.g. '153 mm'.")] = None,
    behind: Annotated[
        str | None, typer.Option(help="Distance behind the pad where the rise is computed, e.g. '15 mm'.")
    ] = None,
    slid: Annotated[
        str | None, typer.Option(help="Sliding distance, for the slider's share of the heat, e.g. '1 m'.")
    ] = None,
    slider: Annotated[str, typer.Option(help="Solid that slides.", autocompletion=complete_solids)] = "rubber",
    track: Annotated[str, typer.Option(help="Solid below.", autocompletion=complete_solids)] = "teak",
) -> None:
    """Compute the temperature rise of a track under a sliding pad (equations 1 to 5 and 9)."""
    from tyrefem.boundaries import friction_names as sliding
    from tyrefem.boundaries.friction import not_negative, positive

    v, long, f = _read("--speed", speed, "m/s"), _read("--length", length, "m"), _read("--friction", friction, "1")
    p = _contact_pressure(pressure, load, breadth, long)
    top, below = _solid("--slider", slider), _solid("--track", track)
    positive(**{"--speed": v, "--length": long})
    not_negative(**{"--friction": f})
    edge = sliding.exit_rise_of_stress(f * p, v, long, below)
    flux, dwell = sliding.heat_flux(f * p * long, v, long, 1.0), long / v
    rises: dict[str, Any] = {
        "contact_pressure_Pa": p,
        "heat_flux_W_m2": flux,
        "time_under_pad_s": dwell,
        "exit_rise_K": edge,
        "mean_rise_K": sliding.MEAN_OF_EXIT * edge,
        "exit_rise_shared_K": sliding.shared_rise(flux, dwell, below, top),
        "share_into_track_at_start": sliding.share_into(below, top),
        "peclet_number": v * long / below.diffusivity,
        "heated_depth_m": 2.0 * (below.diffusivity * dwell) ** 0.5,
    }
    with options_named({"distance": "--behind", "slid": "--slid"}):
        if behind is not None:
            rises["rise_behind_K"] = edge * sliding.fall_off(_read("--behind", behind, "m"), long)
        if slid is not None:
            rises["share_into_slider"] = sliding.share_into_slider(long, _read("--slid", slid, "m"), top, below)
    _print_values(rises)


@group.command()
def tables(
    out: Annotated[Path | None, typer.Option("--out", help="PNG, PDF or SVG of table 2 to write.")] = None,
    force: ForceOption = False,
) -> None:
    """Print Roberts' tables 2 (rubber on wood) and 3 (rubber on ice), measured beside predicted."""
    from tyrefem.boundaries import friction_names as sliding
    from tyrefem.reports.words import ice_lines, wood_lines

    wood, ice = sliding.wood_rows(), sliding.ice_rows()
    distance, pressure = sliding.ice_distance(ice), ice[0].needed_pressure
    if out is not None:
        from tyrefem.reports.figures.friction import wood_figure

        _draw(wood_figure, wood, out, force)
    on_ice = {
        "distance_behind_m": distance,
        "pressure_of_first_row_Pa": pressure,
        "rows": [row.summary(distance, pressure) for row in ice],
    }
    answer_with({"rubber_on_wood": [row.summary() for row in wood], "rubber_on_ice": on_ice, "picture": out})
    say("\n".join([*wood_lines(wood), "", *ice_lines(ice)]))
    if out is not None:
        say(f"drawn in {out}")


@group.command("locked-wheel")
def locked_wheel(
    friction: Annotated[str | None, typer.Option(help="Coefficient of friction; default 0.8 (estimate).")] = None,
    pressure: Annotated[str | None, typer.Option(help="Contact pressure; default '300 kPa' (estimate).")] = None,
    length: Annotated[str | None, typer.Option(help="Footprint length; default '150 mm' (estimate).")] = None,
    decomposition: Annotated[
        str | None, typer.Option(help="Temperature rise at which rubber decomposes; default '330 K' (estimate).")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="PNG, PDF or SVG to write.")] = None,
    force: ForceOption = False,
) -> None:
    """Compute contact temperature rise and friction of a locked wheel on asphalt against speed (equations 12, 13)."""
    from tyrefem.boundaries.friction_names import LockedWheel

    given = {
        "friction": ("--friction", friction, "1"),
        "pressure": ("--pressure", pressure, "Pa"),
        "length": ("--length", length, "m"),
        "decomposition_rise": ("--decomposition", decomposition, "delta_degC"),
    }
    changes: dict[str, Any] = {
        name: _read(option, text, unit, LEAST) for name, (option, text, unit) in given.items() if text is not None
    }
    with options_named({name: option for name, (option, _, _) in given.items()}):
        car = replace(LockedWheel(), **changes)
    rows = [
        {
            "speed_km_h": kmh,
            "exit_rise_K": car.exit_rise(kmh / 3.6),
            "mean_rise_K": car.mean_rise(kmh / 3.6),
            "uncapped_exit_rise_K": car.uncapped_exit_rise(kmh / 3.6),
            "friction": car.friction_at(kmh / 3.6),
        }
        for kmh in SPEEDS
    ]
    limit = 3.6 * car.decomposition_speed()
    if out is not None:
        from tyrefem.reports.figures.friction import locked_wheel_figure

        _draw(locked_wheel_figure, car, out, force)
    answer_with({"rows": rows, "decomposition_from_km_h": limit, "picture": out})
    say(f"{'km/h':>6}{'exit rise K':>13}{'mean rise K':>13}{'uncapped exit K':>17}{'friction':>10}")
    for row in rows:
        say(
            f"{row['speed_km_h']:6}{row['exit_rise_K']:13.0f}{row['mean_rise_K']:13.0f}"
            f"{row['uncapped_exit_rise_K']:17.0f}{row['friction']:10.2f}"
        )
    say(f"decomposition limits friction above {limit:.0f} km/h; all inputs are estimates")
    if out is not None:
        say(f"drawn in {out}")


def _draw(picture: Callable[[Any], Any], shown: Any, out: Path, force: bool) -> None:
    from tyrefem.output import atomic_path
    from tyrefem.reports.figures.style import picture as written

    with results_file(out, PICTURES, force=force), atomic_path(out) as temporary:
        temporary.write_bytes(written(picture(shown), out.suffix))


def _read(option: str, text: str, unit: str, least: float | None = None) -> float:
    from tyrefem.quantity import Unit

    try:
        return Unit(unit, ge=least, le=MOST[unit])(text)
    except InputError as error:
        raise error.within(field=option) from None


def _solid(option: str, name: str) -> Any:
    from tyrefem.boundaries.friction_names import solid

    try:
        return solid(name)
    except InputError as error:
        raise error.within(field=option) from None


def _contact_pressure(pressure: str | None, load: str | None, breadth: str | None, length: float) -> float:
    """The contact pressure, Pa, from --pressure, or from --load, length and breadth."""
    from tyrefem.boundaries.friction import not_negative, positive

    if (pressure is None) == (load is None):
        raise InputError("give either --pressure or --load")
    if pressure is not None:
        if breadth is not None:
            raise InputError("goes with --load: a pressure needs none", field="--breadth")
        value = _read("--pressure", pressure, "Pa")
        not_negative(**{"--pressure": value})
        return value
    if breadth is None:
        raise InputError("--load needs --breadth: the contact pressure is the load per area")
    force, wide = _read("--load", str(load), "N"), _read("--breadth", breadth, "m")
    not_negative(**{"--load": force})
    positive(**{"--length": length, "--breadth": wide})
    return force / (length * wide)


def _print_values(values: dict[str, Any]) -> None:
    answer_with(values)
    for key, value in values.items():
        say(f"{key:28} {value:.5g}")


#: Place among the commands.
ORDER = 80


def register(app: typer.Typer) -> None:
    """Add the group of commands."""
    app.add_typer(group)
