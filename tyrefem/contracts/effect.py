"""Contracts of a user's effect."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.contracts.contract import Contract, finite_run, kept, of_trials
from tyrefem.contracts.flags import flag_contracts
from tyrefem.contracts.study import quick_study
from tyrefem.effects import Effect, Prior
from tyrefem.effects.effect import FILMS, SINKS
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.user_cycle import points_of
from tyrefem.quantity import Unit
from tyrefem.simulation.effect_trials import effect_trials
from tyrefem.simulation.run import run
from tyrefem.simulation.surroundings import Surroundings

#: Ports whose neutral value is a factor of 1 (or a pair of ones), and a shift of 0 (or a pair of zeros).
FACTORS = ("heat_factor", "capacity_factor", "conductivity_factor", "film_factor", "gas_capacity_factor")
SHIFTS = (
    "heat_addend", "film_addend", "film_resistance", "sink_addend", "flux", "rim_power", "lag_addend", "offset",
    "displacement", "clock",
)  # fmt: skip


def contracts(effect: type[Effect], study_name: str | None = None) -> Iterator[Contract]:
    """The contracts of an effect, in a quick study with its signature's changes."""
    yield kept("every parameter has a unit, and its bounds are read back as written", lambda: _units(effect))
    try:
        study = quick_study(study_name, effect.signature.changes)
        refusal = effect.refusal(study)
        if refusal:
            yield Contract(f"it is possible in {study.name}", f"{refusal}; set signature = Signature(changes=...)")
            return
        variants = [effect.signature.choice] if effect.signature.choice else [*effect.variants(study)]
        if not variants:
            yield Contract(
                f"it is possible in {study.name}", "no variant of it is; set signature = Signature(changes=...)"
            )
            return
        choice = dict(variants[0])
        tried = {name: effect.check({**choice, **table}) for name, table in _tables(effect).items()}
    except InputError as error:
        yield Contract("its parameters can be set from their lower to their upper bound", str(error))
        return
    yield Contract("its parameters can be set from their lower to their upper bound", trials=len(tried))
    tyre = Surroundings(study)
    yield from _over_bounds(tyre, tried)
    yield kept("it is vectorised: many points at once give the same as each alone", lambda: _vectorised(tyre, tried))
    yield from flag_contracts(tyre, tried["typical"])
    if any(parameter.prior.amplitude for parameter in effect.parameters()):
        null = tried["at null"]
        yield kept("at null its ports change nothing, to the last bit", lambda: _neutral(tyre, null))
        yield kept("at null the run is the same to the last bit", lambda: _same_run(study, effect, choice))
    typical = study.replace({"effects": [_entry(effect, choice)]})
    yield finite_run(typical)
    yield kept("with a typical amplitude it changes a reading", lambda: _shows(study, typical))


def _tables(effect: type[Effect]) -> dict[str, dict[str, str]]:
    """Name -> parameters as written: at null, typical, and each parameter at its bounds."""
    typical = {parameter.name: parameter.prior.text(_typical(parameter), 12) for parameter in effect.parameters()}
    null = {parameter.name: parameter.prior.text(parameter.prior.origin, 12) for parameter in effect.parameters()}
    tables = {"at null": null, "typical": typical}
    for parameter in effect.parameters():
        for word, bound in (("lower", parameter.prior.low), ("upper", parameter.prior.high)):
            tables[f"{parameter.name} at its {word} bound"] = {
                **typical,
                parameter.name: parameter.prior.text(bound, 12),
            }
    return tables


def _typical(parameter: Any) -> float:
    """A typical value of a parameter: an amplitude's usual one, or the start of a shape."""
    prior = parameter.prior
    return float(prior.usual if prior.amplitude else prior.origin)


def _entry(effect: type[Effect], choice: dict[str, str]) -> dict[str, str]:
    return {"name": effect.name, **choice, **_tables(effect)["typical"]}


def _units(effect: type[Effect]) -> str | None:
    for name, field in effect.model_fields.items():
        if field.annotation is float and not any(isinstance(item, Prior | Unit) for item in field.metadata):
            return f"'{name}' is a number without a unit: write Annotated[float, Prior(...)]"
    for parameter in effect.parameters():
        prior = parameter.prior
        for unit in (prior.unit, prior.written or prior.unit):
            Unit(unit)(f"1 {unit}" if unit != "1" else 1.0)
        for value in (prior.low, prior.high):
            read = Unit(prior.unit)(prior.text(value, 12))
            if not np.isclose(read, value, rtol=1e-9, atol=1e-12):
                return f"'{parameter.name}' is written as {prior.text(value)} and read as {read:g} {prior.unit}"
    return None


def _over_bounds(tyre: Surroundings, tried: dict[str, Effect]) -> Iterator[Contract]:
    """Values of every port, over the bounds of all parameters."""
    merged: dict[str, Contract] = {}
    for name, effect in tried.items():
        for contract in of_trials(effect_trials(_with(tyre, effect), effect)):
            before = merged.get(contract.words)
            fault = contract.fault and f"{contract.fault} ({name})"
            if before is None:
                merged[contract.words] = replace(contract, fault=fault)
            else:
                merged[contract.words] = replace(
                    before, fault=before.fault or fault, trials=before.trials + contract.trials
                )
    yield from merged.values()


def _with(tyre: Surroundings, effect: Effect) -> Surroundings:
    """The tyre with an effect, for its states."""
    if not effect.states:
        return tyre
    # Choices as a study writes them: a number with its unit.
    table = effect.model_dump(exclude={"sd", "provenance", "runs"}, exclude_none=True) | effect.choice
    written = {parameter.name: parameter.prior.text(table.pop(parameter.name), 12) for parameter in effect.parameters()}
    return Surroundings(tyre.study.replace({"effects": [{"name": effect.name, **table, **written}]}))


def _vectorised(tyre: Surroundings, tried: dict[str, Effect]) -> str | None:
    effect = tried["typical"]
    tyre = _with(tyre, effect)
    zone = tyre.schedule.zones[0]
    x = points_of(tyre.study.section, zone)
    T = np.linspace(20.0, 120.0, x.shape[1])
    t = 0.5 * tyre.drive.end
    for method in ("heat_factor", "heat_addend"):
        if effect.overrides(method):
            port = functools.partial(getattr(effect, method), tyre, zone.name)
            together = np.broadcast_to(port(x, t, T), T.shape)
            for n in range(T.size):
                alone = np.broadcast_to(port(x[:, n : n + 1], t, T[n : n + 1]), (1,))[0]
                if not np.isclose(together[n], alone, rtol=1e-9, atol=0):
                    return f"{method} gives {together[n]:.6g} at a point among {T.size}, {alone:.6g} at it alone"
    for region in tyre.study.section.regions:
        for method in ("conductivity_factor", "capacity_factor"):
            if effect.overrides(method):
                of_region = functools.partial(getattr(effect, method), tyre, region)
                together = _factors(of_region(T), T.size)
                alone = np.column_stack([_factors(of_region(T[n : n + 1]), 1) for n in range(T.size)])
                wrong = np.argwhere(~np.isclose(together, alone, rtol=1e-9, atol=0))
                if wrong.size:
                    place = tuple(wrong[0])
                    values = f"{together[place]:.6g} at a temperature among {T.size}, {alone[place]:.6g} at it alone"
                    return f"{method} gives {values}"
    if effect.overrides("flux"):
        for surface in effect.surfaces:
            together = np.broadcast_to(effect.flux(tyre, surface, x, t), T.shape)
            for n in range(T.size):
                alone = np.broadcast_to(effect.flux(tyre, surface, x[:, n : n + 1], t), (1,))[0]
                if not np.isclose(together[n], alone, rtol=1e-9, atol=0):
                    return f"flux gives {together[n]:.6g} at a point among {T.size}, {alone:.6g} at it alone"
    return None


def _neutral(tyre: Surroundings, effect: Effect) -> str | None:
    """The first port of an effect at null that still changes something, in any zone, film, surface or sensor."""
    tyre = _with(tyre, effect)
    t = 0.5 * tyre.drive.end
    points = [(zone.name, points_of(tyre.study.section, zone)) for zone in tyre.schedule.zones]
    zones = [(tyre, name, x, t, np.full(x.shape[1], 60.0)) for name, x in points]
    regions = [(tyre, region, np.array([60.0])) for region in tyre.study.section.regions]
    films, sinks = ([(tyre, name, t) for name in names] for names in (FILMS, SINKS))
    surfaces = [(tyre, surface, points[0][1], t) for surface in effect.surfaces]
    sensors = [(name,) for name in tyre.study.sensors]
    arguments: dict[str, list[tuple[Any, ...]]] = {
        "heat_factor": [*zones], "heat_addend": [*zones], "capacity_factor": [*regions],
        "conductivity_factor": [*regions], "film_factor": [*films], "film_addend": [*films],
        "film_resistance": [*films], "sink_addend": [*sinks], "flux": [*surfaces], "gas_capacity_factor": [(tyre,)],
        "rim_power": [(tyre, t)], "lag_addend": [*sensors], "offset": [*sensors], "displacement": [*sensors],
        "clock": [()],
    }  # fmt: skip
    for names, value in ((FACTORS, 1.0), (SHIFTS, 0.0)):
        for method in (name for name in names if effect.overrides(name)):
            for each in arguments[method]:
                given = _numbers(getattr(effect, method)(*each))
                if not (given == value).all():
                    other = float(given[given != value][0])
                    return f"{method} gives {other!r} at null; it must give {value:g}"
    return None


def _factors(given: Any, size: int) -> NDArray[np.float64]:
    """(1, n) or (2, n) factors of a port at n temperatures: of a capacity, or along and across the plies."""
    parts = given if isinstance(given, tuple) else (given,)
    return np.array([np.broadcast_to(part, (size,)) for part in parts], dtype=float)


def _numbers(given: Any) -> NDArray[np.float64]:
    """(n,) numbers of a port's value, which may be a pair."""
    parts = given if isinstance(given, tuple) else (given,)
    return np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in parts])


def _same_run(study: StudyData, effect: type[Effect], choice: dict[str, str]) -> str | None:
    null = study.replace({"effects": [{"name": effect.name, **choice, **_tables(effect)["at null"]}]})
    same = run(null).readings.equals(run(study).readings)
    return None if same else "readings differ"


def _shows(study: StudyData, typical: StudyData) -> str | None:
    changed = (run(typical).readings - run(study).readings).drop(columns="time_s").to_numpy(dtype=float)
    if np.abs(changed).max() > 0:
        return None
    return (
        f"no reading changes in this drive of {study.card.drive.end:g} s; name a study that shows it (--study NAME), "
        "or say in the class what shows it: signature = Signature(changes={'drive.phases.rolling.duration': '600 s'}), "
        "from tyrefem.effects.signature"
    )
