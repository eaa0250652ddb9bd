"""Contracts of effects that only cool, have no variant in the study, states beside choices, or no sensors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

import pytest

from tyrefem.contracts.effect import _neutral, _tables, _units, _vectorised, contracts
from tyrefem.contracts.law import _friction_alone
from tyrefem.contracts.study import quick_study
from tyrefem.contracts.template import template
from tyrefem.effects import Effect, Prior
from tyrefem.effects.description import example
from tyrefem.errors import InputError
from tyrefem.materials.road_friction import FrictionOnRoad
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


class OfTheHottest(Cooling):
    """A factor from the hottest of the points that are evaluated together."""

    name: ClassVar[str] = "made-up-hottest"

    def conductivity_factor(self, tyre: Any, region: str, T: Any) -> tuple[Any, Any]:
        return 1.0, 1.0 - self.into * T.max() * 1e-6


def test_a_factor_of_all_temperatures_together_is_found() -> None:
    tyre = Surroundings(quick_study())
    fault = _vectorised(tyre, {"typical": OfTheHottest.check({"into": "-100 W/m**2"})})
    assert str(fault).startswith("conductivity_factor gives 1.012 at a temperature among")
    assert str(fault).endswith("1.002 at it alone")


def test_a_number_without_a_unit_is_found() -> None:
    class Plain(Cooling):
        """A parameter as a plain float."""

        name: ClassVar[str] = "made-up-plain"
        gain: float = 1.0

    assert _units(Cooling) is None
    assert str(_units(Plain)).startswith("'gain' is a number without a unit")


def test_a_friction_of_the_mean_pressure_is_found() -> None:
    class OfTheMean(FrictionOnRoad):
        """A coefficient from all points together."""

        law: Literal["made-up-mean"]

        def mu(self, speed: Any, pressure: Any, temperature: Any) -> Any:
            return pressure.mean() / 1e6 + 0 * speed

    law = OfTheMean.check({"law": "made-up-mean", "source": "estimate: made up"})
    assert _friction_alone(law) == "at 0 m/s, 100 kPa, -20 degC it gives 0.38 among others, 0.1 alone"


def test_a_name_whose_class_would_hide_what_the_template_imports_is_refused() -> None:
    """`tyrefem new strain-law zone` wrote a file whose class Zone stood where the strain cycle needs another Zone."""
    with pytest.raises(InputError, match=r"'zone' is not allowed as the name of this strain law: .* would hide Zone"):
        template("strain-law", "zone")
    assert 'name: ClassVar[str] = "n-a-m-e"' in template("effect", "n-a-m-e")
    assert "class NAME(Effect):" in template("effect", "n-a-m-e")
