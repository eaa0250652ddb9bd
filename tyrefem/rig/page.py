"""An identification as one self-contained HTML page."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.rig.estimate import COVERAGE
from tyrefem.rig.pictures import references
from tyrefem.rig.summary import diffusivities, ranked
from tyrefem.rig.verdict import sentences, spoken

if TYPE_CHECKING:
    from tyrefem.rig.identification import Identification


def page(found: Identification, pictures: Mapping[str, bytes], cards: Mapping[str, Any]) -> str:
    """The page's HTML; ``pictures`` maps file name -> PNG, ``cards`` layer -> material card data."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template("page.html").render(
        found=found,
        sentences=sentences(found),
        coverage=COVERAGE,
        references=references(found.card),
        spoken=spoken,
        pictures={name: base64.b64encode(png).decode("ascii") for name, png in pictures.items()},
        cards=cards,
        diffusivities=diffusivities(found),
        ranked=[(", ".join(map(spoken, key)) or "all constant", value) for key, value in ranked(found, 6)],
        complaint=any(one.verdict != "determined" for one in found.properties),
    )
