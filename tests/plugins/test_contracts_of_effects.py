"""Contracts of effects that only cool, have no variant in the study, states beside choices, or no sensors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import pytest

from tyrefem.contracts.effect import _neutral, _tables, contracts
from tyrefem.contracts.study import quick_study
from tyrefem.contracts.template import template
from tyrefem.effects import Effect, Prior
from tyrefem.effects.description import example
from tyrefem.errors import InputError
from tyrefem.simulation.surroundings import Surroundings

pytestmark = pytest.mark.fast


class Cooling(Effect):
    """q -> q + into, of one sign: as a draft of missing cooling."""

    name: ClassVar[str] = "made-up-cooling"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "Cooling is missing."
    source: ClassVar[str] = "estimate: made up"
    surfaces: ClassVar[tuple[str, ...]] = ("outside_air",)

    into: Annotated[float, Prior("W/m**2", "flux", 180.0, -9000.0, 0.0)] = 0.0

    def flux(self, tyre: Any, surface: str, x: Any, t: float) -> float:
        return self.into


class Nowhere(Cooling):
    """Possible, but without a variant."""

    name: ClassVar[str] = "made-up-nowhere"

    @classmethod
    def variants(cls, study: Any) -> tuple[Mapping[str, str], ...]:
        return ()


def test_an_effect_that_only_cools_has_an_example_and_a_typical_value_within_its_bounds() -> None:
    assert 'into = "-180 W/m**2"' in example(Cooling)
    assert _tables(Cooling)["typical"] == {"into": "-180 W/m**2"}


def test_an_effect_without_a_variant_fails_in_words() -> None:
    units, possible = contracts(Nowhere)
    assert units.fault is None
    assert "no variant" in str(possible.fault)


class RoadAtNull(Cooling):
    """Changes the road film at null, and no other."""

    name: ClassVar[str] = "made-up-road"

    def film_factor(self, tyre: Any, film: str, t: float) -> float:
        return 1.1 if film == "road" else 1.0


def test_a_port_that_changes_a_single_film_at_null_is_found() -> None:
    tyre = Surroundings(quick_study())
    assert _neutral(tyre, RoadAtNull.check({})) == "film_factor gives 1.1 at null; it must give 1"


def test_a_study_without_sensors_does_not_fail_an_effect() -> None:
    tyre = Surroundings(quick_study("nasa-22x5.5-8pr", {"sensors": {}}))
    assert _neutral(tyre, Cooling.check({})) is None


@pytest.mark.parametrize("name", ["none", "true", "false"])
def test_a_name_whose_class_is_a_word_of_python_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=f"'{name}' is not allowed as a plugin's name"):
        template("effect", name)
