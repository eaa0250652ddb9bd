"""The part of the drive in which an effect acts: its begin and its end, each of which may be left out."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from tyrefem.quantity import Unit

Begins = Annotated[
    float | None, Unit("s", ge=0), Field(description="begins at this time of the drive", examples=["300 s"])
]
Ends = Annotated[float | None, Unit("s", ge=0), Field(description="ends at this time of the drive", examples=["600 s"])]


def check_order(begins: float | None, ends: float | None) -> None:
    """Refuse an end before the begin: the effect would never act.

    Raises
    ------
    ValueError : ``ends`` is before ``begins``.
    """
    if begins is not None and ends is not None and ends < begins:
        raise ValueError(f"ends at {ends:g} s, before it begins at {begins:g} s")


def stated_times(begins: float | None, ends: float | None) -> tuple[float, ...]:
    """Begin and end, s, as far as they are stated."""
    return tuple(time for time in (begins, ends) if time is not None)


def times_in_words(begins: float | None, ends: float | None) -> dict[str, str]:
    """The stated times as in a study file."""
    return {key: f"{time!r} s" for key, time in (("begins", begins), ("ends", ends)) if time is not None}


def is_outside(t: float, begins: float | None, ends: float | None) -> bool:
    """Whether a time of the drive, s, is before the begin or after the end."""
    return (begins is not None and t < begins) or (ends is not None and t > ends)
