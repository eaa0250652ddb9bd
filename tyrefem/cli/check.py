"""`tyrefem check`: is this file right?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from tyrefem.errors import InputError


def check(
    file: Annotated[str, typer.Argument(metavar="FILE", help="A study, section or material (TOML), or a table (CSV).")],
) -> None:
    """Check a file without running it; says the first thing that is wrong."""
    path = Path(file)
    if path.is_dir():
        path = path / "study.toml"
    if not path.exists():
        raise InputError("no such file", file=file)
    typer.echo(f"{path}: {_table(path) if path.suffix.lower() != '.toml' else _card(path)}")


def _table(path: Path) -> str:
    from tyrefem.measured import read_table

    runs = read_table(path)
    sensors = sorted({sensor for run in runs for sensor in run.sensors})
    readings = sum(int(run.temperatures.notna().sum().sum()) for run in runs)
    return f"a measured table, {len(runs)} run(s), {readings} readings of {', '.join(sensors)}"


def _card(path: Path) -> str:
    from tyrefem.cards import read_toml

    data: dict[str, Any] = read_toml(path)
    if "layers" in data or "line" in data:
        from tyrefem.section import load

        section = load(str(path.resolve()))
        return (
            f"a section, {section.overall_width * 1e3:.1f} mm wide, {section.outer_diameter * 1e3:.1f} mm in diameter"
        )
    if "loss_tangent" in data or "conductivity" in data:
        from tyrefem.materials import material

        return f"a material card, {material(str(path.resolve())).title}"
    from tyrefem.rolling import RollingTyre
    from tyrefem.studies import study

    found = study(str(path.resolve()))
    if found.is_campaign:
        return f"a campaign of {len(found.campaign().cases)} cases"
    _ = RollingTyre(found).schedule
    return (
        f"a study of {len(found.card.drive.phases)} phase(s), {found.card.drive.end:g} s, {len(found.sensors)} sensors"
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(check)
