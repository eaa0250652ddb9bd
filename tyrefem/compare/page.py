"""A comparison in a folder: tables, pictures, and one self-contained HTML page, summary first."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.compare.history import ALL
from tyrefem.compare.pictures import pictures
from tyrefem.output import atomic_folder

if TYPE_CHECKING:
    from tyrefem.compare.comparison import Comparison

#: Files that `save` may write.
FILES = ("comparison.csv", "residuals.csv", "comparison.json", "comparison.html", "histories-*.png", "deviations.png")


def save(comparison: Comparison, folder: str | Path) -> Path:
    """Write tables, pictures and a self-contained page into a folder; returns the page.

    ``comparison.csv``, ``residuals.csv``, ``comparison.json``, ``histories-<run>.png``, ``deviations.png``,
    ``comparison.html``. Each file is complete or not there.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    folder = Path(folder)
    with atomic_folder(folder) as temporary:
        comparison.table.to_csv(temporary / "comparison.csv", index=False, lineterminator="\n")
        comparison.residuals.to_csv(temporary / "residuals.csv", index=False, lineterminator="\n")
        text = json.dumps(comparison.to_dict(), indent=1, ensure_ascii=False, allow_nan=False)
        (temporary / "comparison.json").write_text(text + "\n", encoding="utf-8")
        drawn = pictures(comparison)
        for name, picture in drawn.items():
            (temporary / name).write_bytes(picture)
        (temporary / "comparison.html").write_text(page(comparison, drawn), encoding="utf-8")
    return folder / "comparison.html"


def page(comparison: Comparison, images: Mapping[str, bytes]) -> str:
    """The page's HTML; ``images`` maps file name -> PNG, as `tyrefem.compare.pictures.pictures` returns."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    records = comparison.table.to_dict(orient="records")
    embedded = {name: base64.b64encode(png).decode("ascii") for name, png in images.items()}
    whole = [record for record in records if record["phase"] == ALL]
    relative_sd = dict(zip(comparison.inputs["key"], comparison.inputs["relative_sd"], strict=True))
    regions = {
        key: ", ".join(names.split(", ")[1:])
        for key, names in zip(comparison.inputs["key"], comparison.inputs["regions"], strict=True)
    }
    return environment.get_template("page.html").render(
        comparison=comparison, whole=whole, records=records, relative_sd=relative_sd, regions=regions, pictures=embedded
    )
