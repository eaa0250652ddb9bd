"""The unknowns of a diagnosis: base numbers, sensors, effects. Each is a real number x, 0 for the study as written."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tyrefem.cache import Cache
from tyrefem.effects import catalogue
from tyrefem.effects.effect import Effect, Parameter, Prior
from tyrefem.effects.sensor_misplaced import SensorMisplaced
from tyrefem.inputs.changes import scaled
from tyrefem.inputs.name_patterns import number_at
from tyrefem.inputs.study import StudyData
from tyrefem.quantity import parse

Choice = tuple[tuple[str, str], ...]
#: Effects that every sensor may have within the limits of its card: position, lag, offset.
OF_SENSORS = ("sensor-misplaced", "sensor-lag", "sensor-offset")


@dataclass(frozen=True)
class Unknown:
    """An unknown number x; the study as written has x = 0.

    Parameters
    ----------
    key : dotted name of a base number (x = ln of its factor), or of an effect's parameter (x = value - origin, SI).
    sd : standard deviation of its prior. low, high : bounds of x.
    keys : all dotted names of a base number: a number of a card belongs to every region with this card.
    effect, choice, parameter : for an effect's parameter: name, variant, and the parameter.
    origin : the parameter's value at x = 0 if the study has the effect.
    runs : the measured runs in which the effect acts; empty: all.
    beside : other parameters of the effect (name, value in SI) that a new entry gets with this one; others have the
        effect's defaults.
    kelvins : a base number that is a temperature, as the study states it, K; 0: another number.
    """

    key: str
    sd: float
    low: float = -math.inf
    high: float = math.inf
    effect: str | None = None
    choice: Choice = ()
    parameter: Parameter | None = None
    origin: float | None = None
    keys: tuple[str, ...] = ()
    runs: tuple[str, ...] = ()
    beside: tuple[tuple[str, float], ...] = ()
    kelvins: float = 0.0

    def __hash__(self) -> int:
        # Nearly always enough to tell unknowns apart; all fields would take ten times as long.
        return hash((self.key, self.sd))

    @property
    def step(self) -> float:
        """Step of a difference quotient, towards the inside of the bounds."""
        if self.fixed:
            return 1.0
        size = 0.02 * self.sd if self.effect else 0.01
        return size if self.high > 0 else -size

    @property
    def label(self) -> str:
        """The key, and the other regions in which the base number changes with it.

        >>> Unknown("materials.a.k.value", 0.1, keys=("materials.a.k.value", "materials.b.k.value")).label
        'materials.a.k.value (also b)'
        """
        regions = list(dict.fromkeys(key.split(".")[1] for key in self.keys if key.startswith("materials.")))
        return f"{self.key} (also {', '.join(regions[1:])})" if len(regions) > 1 else self.key

    @property
    def fixed(self) -> bool:
        """Whether the effect has no amplitude: it is present (x = 1) or absent (x = 0)."""
        return self.effect is not None and self.parameter is None

    def acts_in(self, run: str | None) -> bool:
        """Whether the unknown changes the readings of a measured run; None: of a drive that is no measured run."""
        return not self.runs or run in self.runs

    def in_runs(self, runs: Sequence[str]) -> Unknown:
        """The same parameter of the effect in some measured runs only.

        >>> Unknown("effects.hot-road.warmer_by", 10.0, effect="hot-road").in_runs(["run-2"]).key
        'effects.hot-road.warmer_by in run-2'
        """
        return replace(self, key=f"{self.key} in {', '.join(runs)}", runs=tuple(runs))

    @property
    def everywhere(self) -> Unknown:
        """The same parameter of the effect in all runs."""
        return replace(self, key=self.key.removesuffix(f" in {', '.join(self.runs)}"), runs=()) if self.runs else self

    @property
    def entry(self) -> dict[str, Any]:
        """The effect's entry of ``[[effects]]``, without values."""
        runs = {"runs": list(self.runs)} if self.runs else {}
        return {"name": self.effect, **dict(self.choice), **runs}

    def belongs_to(self, entry: Mapping[str, Any]) -> bool:
        """Whether an entry of ``[[effects]]`` is this unknown's effect, with its choices and runs.

        Choices are compared as the effect reads them: "32 mm" is "0.032 m", and a default may be left out.
        """
        if entry.get("name") != self.effect or tuple(entry.get("runs", ())) != self.runs:
            return False
        if not self.choice:
            return True
        stated = catalogue()[str(self.effect)].check({key: value for key, value in entry.items() if key != "name"})
        return stated.choice == dict(self.choice)

    @property
    def measures(self) -> bool:
        """Whether the unknown changes only the measurement, not the tyre."""
        return self.effect is not None and catalogue()[self.effect].only_measures()

    @property
    def moves_sensor(self) -> tuple[str, int] | None:
        """The sensor that the unknown moves, and the direction: 0 along the meridian, 1 in depth. None: no sensor."""
        if self.effect != SensorMisplaced.name or self.parameter is None or self.runs:
            return None
        return dict(self.choice)["sensor"], ("along", "deeper").index(self.parameter.name)

    @property
    def only_sensor(self) -> str | None:
        """The sensor whose reading is all that the unknown changes, if no channels are swapped; None: more changes."""
        return None if self.effect not in OF_SENSORS else dict(self.choice)["sensor"]

    def value(self, x: float) -> float:
        """The value of the parameter, SI; for a base number its factor."""
        if self.parameter is None:
            return x if self.fixed else math.exp(x)
        return (self.parameter.prior.origin if self.origin is None else self.origin) + x

    @property
    def unit(self) -> str:
        """Unit of `value`."""
        return "1" if self.parameter is None else self.parameter.prior.unit


def twins(unknowns: Sequence[Unknown], known: Sequence[Unknown]) -> dict[int, int]:
    """Place of an unknown -> place of the same number among known ones, with another prior: readings follow their sum.

    The tolerance of a sensor's card and the effect of a sensor beyond it are twins.

    >>> lag = Unknown("effects.sensor-lag.crown.slower_by", 2.0, effect="sensor-lag")
    >>> twins([Unknown("k", 0.1), replace(lag, sd=15.0)], [lag])
    {1: 0}
    """
    place = {unknown.key: number for number, unknown in enumerate(known)}
    return {number: place[each.key] for number, each in enumerate(unknowns) if each.key in place and each not in known}


def of_effect(
    effect: type[Effect], choice: Choice, sd: float | None = None, stated: Effect | None = None
) -> tuple[Unknown, ...]:
    """The unknowns of an effect; ``stated``: the effect in the study, with its values and standard deviations."""
    tag = ".".join((effect.name, *(value for _, value in choice)))
    if not effect.parameters():
        return (Unknown(f"effects.{tag}", 1.0, 0.0, 1.0, effect.name, choice),)
    unknowns = []
    for parameter in effect.parameters():
        name, prior = parameter.name, parameter.prior
        spread = prior.scale if sd is None else sd
        origin = None if stated is None else stated.values[name]
        if stated is not None and name in stated.sd:
            spread = parse(stated.sd[name], prior.unit)
        zero = prior.origin if origin is None else origin
        limits = prior.low - zero, prior.high - zero
        unknowns.append(Unknown(f"effects.{tag}.{name}", spread, *limits, effect.name, choice, parameter, origin))
    runs = None if stated is None else stated.runs
    return tuple(unknown.in_runs(runs) for unknown in unknowns) if runs else tuple(unknowns)


def base_unknowns(study: StudyData) -> tuple[Unknown, ...]:
    """The uncertain base numbers: relevant numbers of the study, film coefficients, and uncertain values of effects."""
    numbers = tuple(
        Unknown(number.key, number.sd, keys=number.keys, kelvins=number.kelvins)
        for number in study.uncertain_numbers
        if not number.idle
    )
    known = catalogue()
    films: list[Unknown] = []
    for name in ("road", "outside_air", "contained_air", "rim"):
        choice = (("film", name),)
        stated = stated_effect(study, "film-scale", choice)
        films += of_effect(known["film-scale"], choice, study.card.diagnosis.film_sd, stated)
    fitted = [
        unknown
        for effect in study.card.effects
        if effect.runs or (effect.name != "film-scale" and effect.name not in OF_SENSORS)
        for unknown in of_effect(type(effect), tuple(effect.choice.items()), stated=effect)
        if unknown.parameter is not None and unknown.parameter.name in effect.sd
    ]
    return (*numbers, *films, *(unknown for unknown in fitted if unknown.sd > 0))


def stated_effect(study: StudyData, name: str, choice: Choice) -> Effect | None:
    """The effect in all runs of the study; None if the study does not have it."""
    effects = (effect for effect in study.card.effects if not effect.runs)
    return next((each for each in effects if each.name == name and tuple(each.choice.items()) == choice), None)


def sensor_unknowns(study: StudyData, measured: set[str]) -> tuple[Unknown, ...]:
    """Position, lag and offset of every measured sensor of the study."""
    known = catalogue()
    unknowns: list[Unknown] = []
    for name, sensor in study.sensors.items():
        if name not in measured:
            continue
        choice = (("sensor", name),)
        for effect, sd in zip(OF_SENSORS, (sensor.position_sd, sensor.lag_sd, sensor.accuracy), strict=True):
            of_sensor = of_effect(known[effect], choice, sd, stated_effect(study, effect, choice))
            unknowns += [unknown for unknown in of_sensor if unknown.sd > 0]
    return tuple(unknowns)


def with_values(
    study: StudyData, values: Mapping[Unknown, float], like: StudyData | None = None, written: Cache[Any] | None = None
) -> StudyData:
    """The study with unknowns set to values x; the same object if all are zero.

    Parameters
    ----------
    like : a similar study that shares its contents; see `StudyData.replace`.
    written : cache of the numbers as they are written in study and cards.
    """
    entries = _Entries([dict(entry) for entry in study.data.get("effects", [])])
    changes: dict[str, Any] = {}
    totals: dict[str, tuple[Unknown, float]] = {}
    for unknown, x in values.items():
        if unknown.effect is None:
            if x != 0.0:
                keys = unknown.keys or (unknown.key,)
                changes |= {key: scaled(_written(study, key, written), math.exp(x)) for key in keys}
        else:
            # A sensor's offset may occur twice: as a nuisance unknown, and as a candidate.
            totals[unknown.key] = unknown, totals.get(unknown.key, (unknown, 0.0))[1] + x
    for unknown, x in totals.values():
        if unknown.parameter is None:
            if x:
                entries.of(unknown)
            continue
        entries.of(unknown)[unknown.parameter.name] = _text(unknown.parameter.prior, unknown.value(x))
    if totals:
        changes["effects"] = entries.entries
    return study.replace(changes, like) if changes else study


def _text(prior: Prior, value: float) -> float | str:
    """A value as an entry has it. A fit may end on a bound to within rounding."""
    within = min(max(value, prior.low), prior.high)
    return within if prior.unit == "1" else f"{within!r} {prior.unit}"


def _written(study: StudyData, key: str, known: Cache[Any] | None) -> Any:
    """The number at a dotted name as it is written; it depends on the study's table of the first part of the name."""
    if known is None:
        return number_at(study.data, key, study.folder)
    table = repr(study.data.get(key.split(".", maxsplit=1)[0]))
    return known.get((key, table, study.folder), lambda: number_at(study.data, key, study.folder))


class _Entries:
    """Entries of ``[[effects]]``, which gain those of unknowns that they lack."""

    def __init__(self, entries: list[dict[str, Any]]) -> None:
        self.entries = entries
        self._by_name: dict[Any, list[dict[str, Any]]] = {}
        for entry in entries:
            self._by_name.setdefault(entry.get("name"), []).append(entry)
        self._known: dict[tuple[str | None, Choice, tuple[str, ...]], dict[str, Any]] = {}

    def of(self, unknown: Unknown) -> dict[str, Any]:
        """The entry of an unknown's effect; a new one if there is none."""
        effect = unknown.effect, unknown.choice, unknown.runs
        if effect not in self._known:
            self._known[effect] = self._stated(unknown) or self._added(unknown)
        return self._known[effect]

    def _stated(self, unknown: Unknown) -> dict[str, Any] | None:
        of_name = self._by_name.get(unknown.effect, ())
        return next((entry for entry in of_name if unknown.belongs_to(entry)), None)

    def _added(self, unknown: Unknown) -> dict[str, Any]:
        entry = unknown.entry
        if unknown.beside:
            parameters = {each.name: each.prior for each in catalogue()[str(unknown.effect)].parameters()}
            entry |= {name: _text(parameters[name], value) for name, value in unknown.beside}
        self.entries.append(entry)
        return entry
