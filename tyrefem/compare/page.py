"""A comparison as one self-contained HTML page: summary first, pictures embedded."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.compare.history import ALL

if TYPE_CHECKING:
    from tyrefem.compare.comparison import Comparison


def page(comparison: Comparison, pictures: Mapping[str, bytes]) -> str:
    """The page's HTML; ``pictures`` maps file name -> PNG, as `tyrefem.compare.pictures.pictures` returns."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    records = comparison.table.to_dict(orient="records")
    embedded = {name: base64.b64encode(png).decode("ascii") for name, png in pictures.items()}
    whole = [record for record in records if record["phase"] == ALL]
    relative_sd = dict(zip(comparison.inputs["key"], comparison.inputs["relative_sd"], strict=True))
    regions = {
        key: ", ".join(names.split(", ")[1:])
        for key, names in zip(comparison.inputs["key"], comparison.inputs["regions"], strict=True)
    }
    return environment.get_template("page.html").render(
        comparison=comparison, whole=whole, records=records, relative_sd=relative_sd, regions=regions, pictures=embedded
    )
