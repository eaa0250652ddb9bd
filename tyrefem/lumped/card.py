"""The card of a lumped tyre: bodies, films between them and the surroundings, and what was measured."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from tyrefem.cards import Card, Temperature, Text
from tyrefem.errors import InputError, nearest
from tyrefem.quantity import Unit

#: Surroundings of given temperature.
SURROUNDINGS = ("air", "road", "rim")
Duration = Annotated[float, Unit("s", gt=0, le=1e7)]


class LumpedBody(Card):
    """A body of one temperature.

    ``heat_share``: share of the rolling resistance's heat that it gets; the shares of all bodies add up to 1.
    ``heat_capacity``: if it is known; else it is identified.
    """

    heat_share: Annotated[float, Unit("1", ge=0, le=1)] = 0.0
    heat_capacity: Annotated[float, Unit("J/K", gt=0)] | None = None


class LumpedFilm(Card):
    """A film between two bodies, or a body and its surroundings (air, road, rim).

    ``between``: the two names. ``area``: area of the film; with it the answer is a film coefficient, else a
    conductance. ``speed``: ``constant``, or ``linear``: conductance = at rest + rise x speed.
    ``conductance``: if it is known; else it is identified.
    """

    between: tuple[Text, Text]
    area: Annotated[float, Unit("m**2", gt=0)] | None = None
    speed: Literal["constant", "linear"] = "constant"
    conductance: Annotated[float, Unit("W/K", gt=0)] | None = None

    @property
    def name(self) -> str:
        """Both names."""
        return "-".join(self.between)


class LumpedRun(Card):
    """A test at constant speed and load.

    ``speed``, ``load``: of the test; the load is for the record. ``rolling_resistance``: force at the plateau; its heat
    is force times speed. ``air``, ``road``, ``rim``: temperatures of the surroundings; road and rim are by default the
    air's. ``start``: temperature of all bodies at the start; by default the air's.
    ``plateau``: body -> temperature that it reaches. ``warm_up``: body -> time to 63 % of its way from start to
    plateau. ``cool_down``: body -> time to 63 % of its way from the plateau, at ``cool_down_speed`` without heat.
    """

    name: Text
    speed: Annotated[float, Unit("m/s", gt=0, le=200)]
    load: Annotated[float, Unit("N", gt=0)] | None = None
    rolling_resistance: Annotated[float, Unit("N", gt=0)]
    air: Temperature
    road: Temperature | None = None
    rim: Temperature | None = None
    start: Temperature | None = None
    plateau: Annotated[dict[Text, Temperature], Field(min_length=1)]
    warm_up: dict[Text, Duration] = Field(default_factory=dict)
    cool_down: dict[Text, Duration] = Field(default_factory=dict)
    cool_down_speed: Annotated[float, Unit("m/s", ge=0, le=200)] = 0.0

    def surroundings(self, name: str) -> float:
        """Temperature of air, road or rim, degC."""
        given = getattr(self, name)
        return float(self.air if given is None else given)

    @property
    def heat(self) -> float:
        """Heat of the rolling resistance, W."""
        return self.rolling_resistance * self.speed


class ThermalCard(Card):
    """A thermal.toml: what was measured of a tyre, and the bodies that a real-time model has.

    ``temperature_sd``: standard deviation of a plateau. ``time_sd``: of a time, relative. ``heat_sd``: of the heat,
    relative, the same in all runs. ``identify_shares``: True: the heat shares are identified too; those given are the
    first guess, and bodies without heat stay without.
    """

    kind: ClassVar[str] = "thermal card"
    title: Text
    notes: str = ""
    bodies: Annotated[dict[Text, LumpedBody], Field(min_length=1, max_length=8)]
    films: Annotated[tuple[LumpedFilm, ...], Field(min_length=1)]
    runs: Annotated[tuple[LumpedRun, ...], Field(min_length=1)]
    identify_shares: bool = False
    temperature_sd: Annotated[float, Unit("delta_degC", gt=0, le=50)] = 1.0
    time_sd: Annotated[float, Unit("1", gt=0, lt=1)] = 0.05
    heat_sd: Annotated[float, Unit("1", ge=0, lt=1)] = 0.03

    @model_validator(mode="after")
    def _connected(self) -> ThermalCard:
        for name in self.bodies:
            if name in SURROUNDINGS:
                raise InputError(f"'{name}' is a surrounding, whose temperature the runs give", field=f"bodies.{name}")
        known = (*self.bodies, *SURROUNDINGS)
        before: set[frozenset[str]] = set()
        names: set[str] = set()
        for number, film in enumerate(self.films):
            if frozenset(film.between) in before:
                raise InputError(f"a second film {film.name}: state both as one", field=f"films.{number}.between")
            before.add(frozenset(film.between))
            if film.name in names:
                words = f"'{film.name}' is the name of another film too: call a body differently"
                raise InputError(words, field=f"films.{number}.between")
            names.add(film.name)
            for name in film.between:
                if name not in known:
                    raise InputError(f"no body '{name}'{nearest(name, known)}", field=f"films.{number}.between")
            first, second = film.between
            if first == second or {first, second} <= set(SURROUNDINGS):
                raise InputError("must join two bodies, or a body and a surrounding", field=f"films.{number}.between")
            if film.conductance is not None and film.speed == "linear":
                raise InputError("a known conductance is constant", field=f"films.{number}.speed")
        shares = sum(body.heat_share for body in self.bodies.values())
        if abs(shares - 1) > 1e-6:
            raise InputError(f"the heat shares of the bodies add up to {shares:g}, must be 1", field="bodies")
        self._lost()
        return self

    def _lost(self) -> None:
        """Every body must reach the surroundings through films: else it has no plateau."""
        reached = set(SURROUNDINGS)
        for _ in self.bodies:
            for film in self.films:
                if reached & set(film.between):
                    reached |= set(film.between)
        for name in self.bodies:
            if name not in reached:
                raise InputError(
                    "loses its heat nowhere: no films lead from it to a surrounding", field=f"bodies.{name}"
                )

    @model_validator(mode="after")
    def _measured(self) -> ThermalCard:
        names: set[str] = set()
        for number, run in enumerate(self.runs):
            if run.name in names:
                raise InputError(f"a second run '{run.name}': it would count twice", field=f"runs.{number}.name")
            names.add(run.name)
            if run.load is not None and run.rolling_resistance >= run.load:
                raise InputError(
                    f"{run.rolling_resistance:g} N must be less than the load, {run.load:g} N; it is about a hundredth",
                    field=f"runs.{number}.rolling_resistance",
                )
            coldest = min(run.surroundings(name) for name in SURROUNDINGS)
            for body, temperature in run.plateau.items():
                if body in self.bodies and temperature < coldest - 3 * self.temperature_sd:
                    raise InputError(
                        f"{temperature:g} degC is colder than all surroundings, {coldest:g} degC: no plateau",
                        field=f"runs.{number}.plateau.{body}",
                    )
            for table in ("plateau", "warm_up", "cool_down"):
                for name in getattr(run, table):
                    if name not in self.bodies:
                        raise InputError(
                            f"no body '{name}'{nearest(name, self.bodies)}", field=f"runs.{number}.{table}"
                        )
        return self
