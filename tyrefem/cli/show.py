"""`tyrefem show`: draw or print a section, material, study, sweep, mesh, strain cycle or effect."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tyrefem.cli.common import CaseOption, ForceOption, SetOption, settings, warn
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say, say_table
from tyrefem.errors import InputError, nearest
from tyrefem.output.file import PICTURES, results_file
from tyrefem.requirements import Requirements

if TYPE_CHECKING:
    from tyrefem.api import Study
    from tyrefem.simulation.strain_by_region import StrainByRegion

#: Suffixes of a mesh file.
MESHES = (".msh", ".vtu", ".vtk")
KINDS = ("section", "material", "study", "sweep", "mesh", "strain", "effect")
#: Kinds that take one case of a campaign.
OF_A_CASE = ("study", "sweep", "mesh", "strain")
#: Parts of a study that a drawing needs.
NEEDS = Requirements("a drawing")


def complete_kinds(incomplete: str) -> list[str]:
    """Kinds for shell completion."""
    return [kind for kind in KINDS if kind.startswith(incomplete)]


def complete_names(context: typer.Context, incomplete: str) -> list[str]:
    """Names of the kind already typed."""
    from tyrefem import library

    kind = context.params.get("kind", "study")
    if kind == "effect":
        from tyrefem.effects import catalogue

        return [name for name in catalogue() if name.startswith(incomplete)]
    kind = kind if kind in library.FOLDERS else "study"
    return [name for name in library.names(kind) if name.startswith(incomplete)]


def show(
    kind: Annotated[str, typer.Argument(help=", ".join(KINDS), autocompletion=complete_kinds)],
    name: Annotated[str, typer.Argument(help="Name or path of the card.", autocompletion=complete_names)],
    changes: SetOption = None,
    case: CaseOption = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="PNG, PDF or SVG to write (a mesh: also .msh, .vtu); default: KIND-NAME.png."),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Show a card: `section`, `mesh` and `strain` drawn; `material`, `study`, `sweep` and `effect` printed."""
    from tyrefem.sizes import looks_like_size

    if kind not in KINDS:
        raise InputError(f"no kind '{kind}'{nearest(kind, KINDS)}")
    if case is not None and kind not in OF_A_CASE:
        raise InputError(f"is for {', '.join(OF_A_CASE)}, not for a {kind}", field="--case")
    values = settings(changes)
    if values and kind == "effect":
        raise InputError("changes a card; an effect has its values in a study", field="--set")
    if out is not None and kind not in _SHOWN:
        raise InputError(f"a {kind} is printed, not drawn: remove this option", field="--out")
    shown: dict[str, Any] = {"kind": kind, "name": name}
    if kind == "effect":
        answer_with({**shown, "content": _effect(name)})
        return
    if kind in ("material", "study", "sweep"):
        answer_with({**shown, **_print(kind, name, values, case)})
        return
    if kind == "mesh" and out is not None and out.suffix.lower() in MESHES:
        with results_file(out, MESHES, force=force):
            with progress(f"{name}: mesh"):
                facts = _write_mesh(name, values, case, out)
            answer_with({**shown, "facts": facts, "picture": out})
        return
    stem = Path(name).stem if name.lower().endswith(".toml") else Path(name).resolve().name
    if looks_like_size(name):
        stem = name.replace("/", "-").replace(" ", "-")
    path = out or Path(f"{kind}-{stem}.png")
    from tyrefem.output import atomic_path
    from tyrefem.reports.figures.style import picture

    suffixes = PICTURES + (MESHES if kind == "mesh" else ())
    with results_file(path, suffixes, force=force), progress(f"{name}: {kind}"):
        figure, facts = _SHOWN[kind](name, values, case)
        with atomic_path(path) as temporary:
            temporary.write_bytes(picture(figure, path.suffix))
    answer_with({**shown, "facts": facts, "picture": path})
    for key, value in facts.items():
        if key != "regions":  # printed as a table
            say(f"{key:28} {_formatted(value)}")
    say(f"drawn in {path}")


def _formatted(value: Any) -> str:
    """Format a value as text: numbers with six digits, lists and tables without brackets."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_formatted(entry)}" for key, entry in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(_formatted, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _section(name: str, values: dict[str, Any], _case: str | None) -> tuple[Any, dict[str, Any]]:
    from tyrefem.geometry import load
    from tyrefem.inputs.changes import changed
    from tyrefem.reports.figures.mesh import section_figure

    data: dict[str, Any] = {"section": name}
    for key, value in values.items():
        data = changed(data, key if key.startswith("section.") else f"section.{key}", value)
    section = load(data["section"])
    warn(section.warnings)
    return section_figure(section), section.summary()


def _single(name: str, values: dict[str, Any], case: str | None) -> Study:
    """The study to draw: a single drive, not a campaign."""
    from tyrefem.api import study

    chosen = study(name, values, case)
    NEEDS.check(chosen)
    warn(chosen.warnings)
    return chosen


def _mesh(name: str, values: dict[str, Any], case: str | None) -> tuple[Any, dict[str, Any]]:
    from tyrefem.reports.figures.mesh import mesh_figure

    tyre = _single(name, values, case).mesh()
    return mesh_figure(tyre), tyre.summary()


def _write_mesh(name: str, values: dict[str, Any], case: str | None, path: Path) -> dict[str, Any]:
    from tyrefem.geometry import meshing
    from tyrefem.output import atomic_path

    tyre = _single(name, values, case).mesh()
    with atomic_path(path) as temporary:
        meshing.write(tyre, temporary)
    say(f"{tyre.n_nodes} nodes, {tyre.n_elements} elements written to {path}")
    return tyre.summary()


def _strain(name: str, values: dict[str, Any], case: str | None) -> tuple[Any, dict[str, Any]]:
    from tyrefem.simulation.rolling_tyre import RollingTyre
    from tyrefem.simulation.strain_by_region import StrainByRegion

    loaded = _single(name, values, case)
    strains = StrainByRegion.of(RollingTyre(loaded))
    largest = strains.case
    facts = {
        "load_N": largest.load,
        "pressure_Pa": largest.pressure,
        "deflection_m": largest.deflection,
        "rolling_radius_m": largest.rolling_radius,
        "footprint_length_m": largest.footprint_length,
        "road_fraction": largest.road_fraction,
        "regions": strains.table.to_dict("records"),
    }
    _print_strains(strains)
    if loaded.card.mechanics.strain == "arcs":
        from tyrefem.reports.figures.strain import cycle_figure

        return cycle_figure(loaded, strains.tyre.schedule), facts
    from tyrefem.reports.figures.heat_source import cycle_heat_figure

    return cycle_heat_figure(strains), facts


def _print_strains(strains: StrainByRegion) -> None:
    """Print a row per region."""
    from rich.table import Table

    elastic = bool(strains.amplitudes)
    table = Table(box=None, padding=(0, 1, 0, 0))
    table.add_column("", no_wrap=True)
    heads = ["volume cm3", "U mean kJ/m3", "U max kJ/m3", "at s mm", "depth mm"]
    heads += ["strain mean %", "strain max %"] if elastic else []
    for head in [*heads, "heat W", "share %"]:
        table.add_column(head, justify="right")
    for row in strains.table.to_dict("records"):
        cells = [
            f"{1e6 * row['volume_m3']:.0f}", f"{1e-3 * row['energy_mean_J_m3']:.2f}",
            f"{1e-3 * row['energy_highest_J_m3']:.1f}", f"{1e3 * row['highest_s_m']:.0f}",
            f"{1e3 * row['highest_depth_m']:.1f}",
        ]  # fmt: skip
        if elastic:
            cells += [_percent(row["amplitude_mean"]), _percent(row["amplitude_highest"])]
        table.add_row(row["region"], *cells, f"{row['heat_W']:.1f}", f"{100 * row['heat_share']:.1f}")
    say_table(table)
    say("U: strain energy per cycle, highest at s and depth; heat of the whole tyre at the start")
    if elastic:
        say("strain: shear strain amplitude of a revolution")
    say("")


def _percent(share: float) -> str:
    return "" if share != share else f"{100 * share:.2f}"


def _effect(name: str) -> dict[str, Any]:
    """Print an effect; what is printed, as data."""
    from tyrefem.effects import catalogue
    from tyrefem.effects.description import COLUMNS, equation, example, parameter_rows, ports

    known = catalogue()
    if name not in known:
        raise InputError(f"no effect named '{name}'{nearest(name, known)}")
    effect = known[name]
    say(f"{name} ({effect.family}): {effect.sentence}")
    say(f"  {equation(effect)}\n  enters as: {ports(effect)}\n  source: {effect.source}\n")
    for row in parameter_rows(effect):
        say(row[0])
        for heading, cell in zip(COLUMNS[1:], row[1:], strict=True):
            if cell:
                say(f"  {heading:14} {cell}")
    say(f"\n{example(effect)}")
    rows = [dict(zip(("parameter", *COLUMNS[1:]), row, strict=True)) for row in parameter_rows(effect)]
    return {
        "family": effect.family, "sentence": effect.sentence, "source": effect.source, "equation": equation(effect),
        "parameters": rows, "example": example(effect),
    }  # fmt: skip


_SHOWN = {"section": _section, "mesh": _mesh, "strain": _strain}


def _print(kind: str, name: str, values: dict[str, Any], case: str | None) -> dict[str, Any]:
    """Print a card as TOML; its file and content."""
    import tomli_w

    from tyrefem import library
    from tyrefem.api import study
    from tyrefem.cards import read_toml
    from tyrefem.inputs.changes import changed
    from tyrefem.materials.card import MaterialCard

    data: dict[str, Any]
    if kind == "study":
        shown_study = study(name, values, case)
        warn(shown_study.warnings)
        data, path = dict(shown_study.data), shown_study.file
    elif kind == "sweep":
        from tyrefem.sweep.design import loaded

        path = library.find("sweep", name)
        of_a_case = {} if case is None else {"case": case}
        sweep = loaded(str(path), values, **of_a_case)
        warn(sweep.warnings)
        say(f"# {sweep.words}")
        data = read_toml(path) | of_a_case
        if values:
            data["change"] = {**data.get("change", {}), **values}
    else:
        data, file, _ = library.load("material", name)
        for key, value in values.items():
            data = changed(data, key, value)
        card = MaterialCard.check(data, file)
        warn(warning.within(file=file) for warning in card.warnings())
        path = file
    say(f"# {path}")
    say(tomli_w.dumps(data).rstrip("\n"))
    return {"file": path, "content": data}


#: Place among the commands.
ORDER = 40


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(show)
