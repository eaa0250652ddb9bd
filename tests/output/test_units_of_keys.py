"""Columns of tables and keys of JSON files have the whole unit that ends their name, not its last letter alone."""

from __future__ import annotations

from tyrefem import study
from tyrefem.output.key_units import UNITS, readable, unit_of
from tyrefem.schemas.answers import ANSWERS
from tyrefem.schemas.rows import ROWS
from tyrefem.variants import answer_units
from tyrefem.variants.answers import answer_names

#: Parts of names that are units, also of quotients: ``K_m`` is K/m.
PARTS = {"K", "J", "N", "W", "Pa", "kg", "m", "m2", "m3", "rad", "deg", "km", "h", "s", "Hz", "degC"}


def test_every_name_with_a_quotient_of_units_has_all_of_it() -> None:
    answers = answer_names(study("nasa-22x5.5-8pr"), 40.0)
    keys = [key for table in (*ANSWERS.values(), *ROWS.values()) for key in table]
    quotients = set()
    for name in {key.removesuffix("*") for key in (*answers, *keys)}:
        parts, start = name.split("_"), len(name.split("_"))
        while start > 1 and parts[start - 1] in PARTS:
            start -= 1
        # `hottest_s_m`: the place s, in m.
        if len(parts) - start > 1 and parts[start] != "s":
            quotients.add("_" + "_".join(parts[start:]))
    assert {"_K_m", "_J_m3", "_W_m2_K", "_m_s"} <= quotients <= set(UNITS)


def test_gradients_and_ratings_have_their_unit() -> None:
    names = ("gradient_K_m", "cornering_stiffness_N_rad", "angle_deg", "tkph", "gradient_s_m")
    assert [unit_of(name) for name in names] == ["K/m", "N/rad", "deg", "t km/h", "m"]


def test_answers_in_words_have_the_units_of_keys() -> None:
    """Units of keys have one home; answers of a sweep show each of them."""
    assert all(answer_units.unit_of(f"x{end}") == readable(unit) for end, unit in UNITS.items())
    assert answer_units.name_of("crown_max_degC") == "crown max"
    assert answer_units.shown("footprint_area_m2", 0.02) == "0.02 m²"
