"""The `[explore]` table of a study: numbers with sliders, limits, and the axes of the safe envelope."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from tyrefem.cards import Card, Text
from tyrefem.quantity import Unit


class ExploreChoice(Card):
    """What `tyrefem explore` shows; by default a box about the study's drive, its rubbers and films.

    ``vary``: dotted name -> its range, as in a sweep file. ``limits``: answer -> below, above, likewise. ``axes``: the
    two numbers of the safe envelope. ``tolerance``: largest temperature error that the certificate allows.
    """

    vary: dict[str, Any] = Field(default_factory=dict)
    limits: dict[str, Any] = Field(default_factory=dict)
    axes: tuple[Text, Text] | None = None
    tolerance: Annotated[float, Unit("delta_degC", gt=0, le=20)] = 0.3
