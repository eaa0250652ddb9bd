"""An effect with a state of its own, as a user would write it."""

from math import exp
from typing import Annotated, ClassVar

from tyrefem.effects import Effect, EffectState, Prior


class DryingTread(Effect):
    """L dw/dt = -2.8 h wet(w) (T_tread - T_air) off the road;  h of the tread -> h (1 + 2.8 wet(w))."""

    name: ClassVar[str] = "drying-tread"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "Water that a puddle left on the tread cools it until it is dry."
    source: ClassVar[str] = "Lewis relation as of 'wet-road', L = 2.45e6 J/kg; estimate: wet above 10 um of water"
    states: ClassVar = {"water": EffectState("kg/m**2", "water on the tread", scale=1e-3)}

    puddle: Annotated[float, Prior("kg/m**2", "water at the start", 0.05, 0.0, 1.0)] = 0.0

    def initial_states(self, tyre):
        return {"water": self.puddle}

    def state_rates(self, tyre, t, state, temperatures):
        film = tyre.study.card.boundaries.outside_air.film(tyre.speed(t)) * (1 - tyre.road_fraction(t))
        warmer = temperatures.surface("road") - tyre.ambient(t)
        return {"water": -2.8 * film * self.wet(state["water"]) * warmer / 2.45e6}

    def film_factor(self, tyre, film, t):
        return 1 + 2.8 * self.wet(tyre.state(self, "water", t)) if film == "tread_air" else 1.0

    @staticmethod
    def wet(water):
        return 1 - exp(-max(water, 0.0) / 0.01)
