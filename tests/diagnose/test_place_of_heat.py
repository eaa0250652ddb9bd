"""Source and law of missing heat in sentences: one place is told, or both are and which to take."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.diagnose.law.places import FILM, FLUX, HEAT, LOSS, LawPlace
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, INNER, OUTER
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.words.law import place_words

X = Unknown("x", 1.0)
INSIDE = LawPlace(HEAT, 0.1, ALL_LAYERS, X, 1.0)
OUTSIDE = LawPlace(FLUX, 0.1, OUTER, X, 1.0)


def words(depths: dict[str, float], lead: float, *ranking: tuple[LawPlace, float]) -> list[str]:
    """The sentences for a source with these depths, and places of laws with ln evidence below the best."""
    where = max(depths, key=lambda name: depths[name])
    source = SimpleNamespace(
        station=0.1, where=where, inside=where == ALL_LAYERS, depths=depths, move=SimpleNamespace(kelvin=3.0)
    )
    places: list[Any] = [SimpleNamespace(place=place, below=below) for place, below in ranking]
    law = SimpleNamespace(place=places[0].place, ranking=places, lead=lead)
    d: Any = SimpleNamespace(
        original=tf.study("nasa-22x5.5-8pr"), missing=SimpleNamespace(over_time=SimpleNamespace(clear=(source,)))
    )
    return place_words(d, law)  # type: ignore[arg-type]


def test_places_on_one_side_need_no_sentence() -> None:
    assert words({ALL_LAYERS: 0.97, OUTER: 0.03}, 2.0, (INSIDE, 0.0), (OUTSIDE, 4.0)) == []
    assert words({ALL_LAYERS: 0.97, OUTER: 0.03}, 2.0, (LawPlace(LOSS, math.nan, "tread", X, 1.0), 0.0)) == []
    assert words({OUTER: 0.97, ALL_LAYERS: 0.03}, 2.0, (LawPlace(FILM, math.nan, "outside_air", X, 1.0), 0.0)) == []
    whole = LawPlace(FLUX, math.nan, "whole tread surface", X, 1.0)
    assert words({OUTER: 0.97, ALL_LAYERS: 0.03}, 2.0, (whole, 0.0)) == []


@pytest.mark.parametrize(("lead", "taken"), [(4.0, "at the outer surface"), (-4.0, "in mid sidewall")])
def test_two_told_places_that_differ_are_named_with_the_likelier(lead: float, taken: str) -> None:
    (sentence,) = words({ALL_LAYERS: 0.97, OUTER: 0.03}, lead, (OUTSIDE, 0.0))
    assert sentence.startswith(
        "The law is at the outer surface, the source that may act at any time is in mid sidewall"
    )
    assert "(98.2 %)" in sentence
    assert sentence.partition("so take ")[2].startswith(taken)


def test_what_the_source_does_not_tell_the_law_tells_or_does_not() -> None:
    open_place = {ALL_LAYERS: 0.6, OUTER: 0.4}
    assert words(open_place, 0.0, (OUTSIDE, 0.0), (INSIDE, 5.0)) == [
        "Only the law tells the two apart: at the outer surface 99.3 %, not inside the rubber"
    ]
    assert words(open_place, 0.0, (INSIDE, 0.0), (LawPlace(FLUX, 0.1, INNER, X, 1.0), 0.4)) == [
        "The law does not tell them apart either: inside the rubber 60 %, at the inner surface 40 %"
    ]
    assert words(open_place, 0.0, (INSIDE, 0.0)) == []
