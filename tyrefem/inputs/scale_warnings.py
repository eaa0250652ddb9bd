"""Warnings of ``thickness_scale``: a factor acts on the rows of tables, and so on a part of some regions only."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import Any

from tyrefem import library
from tyrefem.errors import InputWarning
from tyrefem.geometry.builder import WrittenSection, section_of
from tyrefem.geometry.section import Section
from tyrefem.quantity import parse
from tyrefem.sizes import gauge_of

#: A factor whose share in the region's area is less than this is warned of (a judgement: tread and belts have 0.97 to
#: 1.1).
LEAST_SHARE = 0.9
#: A factor nearer to one is not judged: its share would be rounding.
NEAR_ONE = 1e-3


def scale_warnings(written: WrittenSection, section: Section, reference: Any) -> Iterator[InputWarning]:
    """A warning for each region of which a factor changes the area by less than it says; with the number of a size
    that acts on the whole.

    Parameters
    ----------
    written : the section's card with its changes. section : built of it. reference : as the study names it.
    """
    factors = {name: parse(value, "1") for name, value in _scales(written[0]).items()}
    factors = {name: factor for name, factor in factors.items() if abs(factor - 1) > NEAR_ONE}
    if not factors:
        return
    plain = copy.deepcopy(written[0])
    _scales(plain).clear()
    unscaled = section_of((plain, *written[1:]), half=section.half)
    for region, factor in factors.items():
        share = (section.area(region) / unscaled.area(region) - 1) / (factor - 1)
        if share < LEAST_SHARE:
            instead = gauge_of(reference, region) if library.of_size("section", reference) else ""
            use = f"; give the size's number parameters.{instead} in its place" if instead else ""
            changed, stated = 100 * share * (factor - 1), 100 * (factor - 1)
            yield InputWarning(
                f"{factor:.4g} changes the area of '{region}' by {changed:+.2g} %, not by {stated:+.3g} %: a factor "
                f"acts on the rows of the layers' tables, of which this region has few{use}",
                field=f"section.parameters.thickness_scale.{region}",
            )


def _scales(data: Mapping[str, Any]) -> dict[str, Any]:
    scales: dict[str, Any] = data.get("parameters", {}).get("thickness_scale", {})
    return scales
