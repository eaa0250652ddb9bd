"""Files of `tyrefem thermal-card`: the numbers as TOML and CSV, measured beside computed, a picture."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.output import atomic_folder, write_json
from tyrefem.reports.words import number

if TYPE_CHECKING:
    from tyrefem.lumped.identification import LumpedIdentification

#: Files that `write_files` may write.
FILES = ("thermal-card.toml", "numbers.csv", "measured.csv", "thermal-card.json", "thermal-card.png")


def write_files(identified: LumpedIdentification, folder: Path, *, pictures: bool = True) -> None:
    """``thermal-card.toml``, ``numbers.csv``, ``measured.csv``, ``thermal-card.json``, ``thermal-card.png``."""
    import tomli_w

    with atomic_folder(folder) as place:
        write_json(identified.to_dict(), place / "thermal-card.json")
        (place / "thermal-card.toml").write_text(tomli_w.dumps(_card(identified)), encoding="utf-8")
        heading = ["name", "unit", "value", "sd", "area_m2", "per_area", "per_area_sd", "verdict"]
        _csv(place / "numbers.csv", heading, [row.to_dict() for row in identified.numbers])
        _csv(place / "measured.csv", list(identified.rows[0]), identified.rows)
        if pictures:
            from tyrefem.reports.figures.style import png

            (place / "thermal-card.png").write_bytes(png(_figure(identified)))


def _csv(path: Path, heading: list[str], rows: list[dict[str, Any]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, heading, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def _card(identified: LumpedIdentification) -> dict[str, Any]:
    """The numbers as a card: quantity with unit, standard deviation, film coefficient where there is an area."""
    tables: dict[str, Any] = {"title": identified.card.title, "misfit": round(identified.misfit, 3)}
    if identified.words:
        tables["words"] = list(identified.words)
    for row in identified.numbers:
        entry: dict[str, Any] = {
            "value": f"{row.value:.5g} {row.unit}".removesuffix(" 1"),
            "sd": f"{row.sd:.2g} {row.unit}".removesuffix(" 1"),
        }
        if row.area is not None:
            unit = "W/m**2/K" if row.unit == "W/K" else "W*s/m**3/K"
            entry["film"] = f"{row.value / row.area:.5g} {unit}"
            entry["film_sd"] = f"{row.sd / row.area:.2g} {unit}"
        kind, _, name = row.name.partition(" ")
        if kind == "heat":
            kind, _, name = name.partition(" ")
            kind = f"heat_{kind}"
        tables.setdefault(kind, {})[name] = entry
    return tables


def words(identified: LumpedIdentification) -> str:
    """Lines of text."""
    lines = [identified.card.title]
    for row in identified.numbers:
        film = "" if row.area is None else f"   film {row.value / row.area:.4g} +- {number(row.sd / row.area, 2)}"
        film += {"": "", "W/K": " W/m2/K", "W s/m/K": " W s/m3/K"}[row.unit if film else ""]
        doubt = "" if row.verdict == "determined" else f"   {row.verdict}"
        lines.append(f"  {row.name:36} {row.value:10.4g} +- {number(row.sd, 2):<8} {row.unit}{film}{doubt}")
    lines.append(f"  misfit per degree of freedom {identified.misfit:.2f} (1: as the stated standard deviations)")
    lines += [f"  {text}" for text in identified.words]
    return "\n".join(lines)


def _figure(identified: LumpedIdentification) -> Any:
    """Computed over measured: plateaus on the left, times on the right, with two standard deviations."""
    from tyrefem.reports.figures.style import FONT, INK, PALETTE, TITLE, add_axes, figure, plain, tidy, title

    drawn = figure(9.0, 3.8 + TITLE)
    names = list(identified.card.bodies)
    for place, (kinds, unit) in enumerate(((("plateau",), "°C"), (("warm_up", "cool_down"), "s"))):
        axes = add_axes(drawn, 0.75 + 4.5 * place, 0.6, 3.5, 3.0)
        rows = [row for row in identified.rows if row["quantity"] in kinds]
        for row in rows:
            marker = "o" if row["quantity"] != "cool_down" else "s"
            colour = PALETTE[names.index(row["body"]) % len(PALETTE)]
            axes.errorbar(
                row["measured"], row["computed"], xerr=2 * row["sd"], fmt=marker, ms=5, color=colour, elinewidth=1.0
            )
        if rows:
            values = [row[key] for row in rows for key in ("measured", "computed")]
            ends = [min(values), max(values)]
            axes.plot(ends, ends, color=INK, lw=0.8)
        axes.set_xlabel(f"measured [{unit}]", fontsize=FONT)
        axes.set_ylabel(f"computed [{unit}]", fontsize=FONT)
        axes.set_title("plateaus" if unit == "°C" else "times: o warm-up, □ cool-down", fontsize=FONT, loc="left")
        tidy(axes)
    for place, name in enumerate(names):
        drawn.text(0.62 + 0.12 * (place % 3), 0.965 - 0.04 * (place // 3), plain(f"● {name}"), fontsize=FONT,
                   color=PALETTE[place % len(PALETTE)])  # fmt: skip
    title(
        drawn, "Lumped tyre: computed over measured", f"bars: two standard deviations; misfit {identified.misfit:.2f}"
    )
    return drawn
