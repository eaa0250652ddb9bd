"""An effect that says something untrue of itself is found: simulations would keep its values at the wrong times."""

from __future__ import annotations

import tomllib
from typing import Annotated, Any, ClassVar

import numpy as np
import pytest

from tyrefem.contracts.flags import flag_contracts
from tyrefem.contracts.study import quick_study
from tyrefem.effects import Effect, Prior, catalogue
from tyrefem.effects.description import example
from tyrefem.simulation.surroundings import Surroundings

pytestmark = pytest.mark.fast
TYRE = Surroundings(quick_study())


class Honest(Effect):
    """Heat that grows in time and with temperature, a wind that begins at 60 s."""

    name: ClassVar[str] = "made-up-honest"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "Heat grows."
    source: ClassVar[str] = "estimate: made up"
    jumps: ClassVar[tuple[float, ...]] = (60.0,)

    gain: Annotated[float, Prior("1", "gain", 0.2, 0.0, 1.0)] = 0.0

    def heat_factor(self, tyre: Any, zone: str, x: Any, t: float, T: Any) -> Any:
        return 1 + self.gain * t / 100 * (T / 100)

    def film_factor(self, tyre: Any, film: str, t: float) -> float:
        return 1 + self.gain * (film == "outside_air" and t >= 60)


class OfPlace(Honest):
    """Says that its heat depends on place only."""

    name: ClassVar[str] = "made-up-of-place"
    of_place: ClassVar[bool] = True


class NotOfTemperature(Honest):
    """Says that its heat does not depend on temperature."""

    name: ClassVar[str] = "made-up-not-of-temperature"
    heat_of_temperature: ClassVar[bool] = False


class OfDrive(Honest):
    """Says that films depend on the drive only."""

    name: ClassVar[str] = "made-up-of-drive"
    of_drive: ClassVar[bool] = True


class Jumping(Honest):
    """Does not say when it jumps."""

    name: ClassVar[str] = "made-up-jumping"
    jumps: ClassVar[tuple[float, ...]] = ()


class JumpingHeat(Honest):
    """Heat that ends in some points after 100.5 s."""

    name: ClassVar[str] = "made-up-jumping-heat"

    def heat_factor(self, tyre: Any, zone: str, x: Any, t: float, T: Any) -> Any:
        return np.where((x[0] > x[0].mean()) & (t > 100.5), 1.0, 1 + self.gain)


def faults(effect: type[Effect]) -> list[str]:
    contracts = [*flag_contracts(TYRE, effect.check({"gain": 0.2}))]
    assert contracts
    return [contract.fault for contract in contracts if contract.fault]


def test_true_flags_are_kept() -> None:
    assert faults(Honest) == []


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        (OfPlace, "heat_factor in zone 'I' gives 1.0048 at 12 s and 20 degC"),
        (NotOfTemperature, "heat_factor in zone 'I' gives 1.0048 at 12 s and 20 degC, 1.0168 at 12 s and 70 degC"),
        (OfDrive, "film_factor('outside_air') gives 1 at 12 s and 1.2 at 108 s, within phase 'rolling'"),
        (Jumping, "film_factor('outside_air') jumps at 60 s; its jumps are: none"),
        (JumpingHeat, "jumps at 100.5 s; its jumps are: 60 s; time steps must end there: jumps = (100.5,)"),
    ],
)
def test_an_untrue_flag_is_named_with_values(effect: type[Effect], words: str) -> None:
    (fault,) = faults(effect)
    assert words in fault


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_shipped_effects_keep_theirs(name: str) -> None:
    effect = catalogue()[name]
    (entry,) = tomllib.loads(example(effect))["effects"]
    tried = effect.check({key: value for key, value in entry.items() if key != "name"} | dict(effect.signature.choice))
    tyre = Surroundings(quick_study(None, effect.signature.changes))
    assert [contract.line for contract in flag_contracts(tyre, tried) if contract.fault] == []
