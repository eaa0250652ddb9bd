"""Films and heat capacities of a lumped tyre from what was measured, by least squares, with standard deviations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.lumped.card import ThermalCard
from tyrefem.lumped.network import LumpedNetwork

Array = NDArray[np.float64]
#: Smallest singular value over the largest, of relative changes, below which numbers cannot be told apart.
DETERMINED = 1e-6
#: Share of a number in such a direction above which it is named.
NAMED = 0.1
#: Relative step of the heat in central differences.
HEAT_STEP = 1e-4
#: Smallest number, relative to its first guess; a number that ends below `ZERO` is reported as 0.
LOWEST, ZERO = 1e-6, 1e-4
#: Probability of a larger misfit by chance below which every number is doubtful.
CHANCE = 1e-3
#: Standard deviation, in sizes of the number, above which a number is not determined.
VAGUE = 30.0


@dataclass(frozen=True)
class LumpedNumber:
    """An identified number, SI: ``value`` and standard deviation ``sd``.

    ``area``: of its film, m2, if the card has it: value / area is the film coefficient. ``doubtful``: the bodies cannot
    have what was measured.
    """

    name: str
    unit: str
    value: float
    sd: float
    area: float | None = None
    doubtful: bool = False

    @property
    def verdict(self) -> str:
        """``doubtful``; else ``determined`` to a third or better, or ``poorly determined``."""
        if self.doubtful:
            return "doubtful"
        return "determined" if self.sd < self.value / 3 else "poorly determined"

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        row: dict[str, Any] = {"name": self.name, "unit": self.unit, "value": self.value, "sd": self.sd}
        row["verdict"] = self.verdict
        if self.area is not None:
            row |= {"per_area": self.value / self.area, "per_area_sd": self.sd / self.area, "area_m2": self.area}
        return row


@dataclass(frozen=True)
class _Unknown:
    """A number that is sought: ``at`` its place in capacities, at_rest, rise or shares."""

    name: str
    unit: str
    kind: str
    at: int
    start: float


@dataclass(frozen=True, eq=False)
class LumpedIdentification(Brief):
    """The identified tyre. Made by `identify`.

    Parameters
    ----------
    card : what was measured. network : the identified tyre. numbers : with standard deviations.
    """

    card: ThermalCard
    network: LumpedNetwork
    numbers: tuple[LumpedNumber, ...]

    def _facts(self) -> Mapping[str, Any]:
        return {number.name: f"{number.value:.4g} +- {number.sd:.2g} {number.unit}" for number in self.numbers}

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """Every measured number beside the computed one: run, body, quantity, unit, measured, computed, sd."""
        return _rows(self.card, self.network)

    @property
    def misfit(self) -> float:
        """Mean square of the residuals over their standard deviations, per degree of freedom: about 1 if all agree."""
        free = max(len(self.rows) - len(self.numbers), 1)
        return sum(_off(row) ** 2 for row in self.rows) / free

    @property
    def words(self) -> tuple[str, ...]:
        """Sentences on what is doubtful: the measurement that the bodies miss most, and numbers that come out as 0."""
        out = []
        if any(number.doubtful for number in self.numbers):
            out.append(f"DOUBTFUL: these bodies cannot have what was measured; {_worst(self.rows)}.")
        none = [number.name for number in self.numbers if number.value == 0.0]
        if none:
            out.append(f"0 fits best, and no less is possible: {', '.join(none)}.")
        return tuple(out)

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "title": self.card.title,
            "numbers": [number.to_dict() for number in self.numbers],
            "rows": self.rows,
            "misfit": self.misfit,
            "words": list(self.words),
            "heat_sd": self.card.heat_sd,
        }


def identify(card: ThermalCard) -> LumpedIdentification:
    """Least squares of plateaus and times over their standard deviations.

    min over p of sum ((y - y(p)) / sd)^2; covariance (J^T J)^-1 + g g^T heat_sd^2 with J = (dy/dp)/sd and
    g = -(J^T J)^-1 J^T h, the change of p with the heat, h = (dy/d ln heat)/sd. If no number is known, conductances and
    capacities are proportional to the heat; beside a known one another may change much more.

    Raises
    ------
    InputError : the measurements do not determine the numbers; says which, and what is missing. Or a body's share of
        the heat comes out below 0.
    """
    from scipy.optimize import least_squares
    from scipy.stats import chi2

    unknowns = _unknowns(card)
    if not unknowns:
        raise InputError("every number is known: nothing is to be identified", field="films")
    count = sum(len(run.plateau) + len(run.warm_up) + len(run.cool_down) for run in card.runs)
    if count < len(unknowns):
        raise InputError(
            f"{count} measured numbers cannot determine {len(unknowns)}: {', '.join(item.name for item in unknowns)}; "
            "add runs, plateaus or times",
            field="runs",
        )
    start = np.array([item.start for item in unknowns])

    def of_card(card: ThermalCard, relative: Array) -> Array:
        network = _network(card, unknowns, start * relative)
        return np.array([(computed - measured) / sd for _, measured, computed, sd in _data(card, network)])

    def residuals(relative: Array) -> Array:
        return of_card(card, relative)

    _told_apart(card, unknowns, _jacobian(residuals, np.ones(len(start))))
    low = np.full(len(start), LOWEST)
    high = np.array([1.0 / item.start if item.kind == "shares" else np.inf for item in unknowns])
    fit = least_squares(residuals, np.ones(len(start)), bounds=(low, high), x_scale="jac", xtol=1e-12, ftol=1e-12)
    values = start * fit.x
    # Relative to the fit, so that all numbers are alike; a number that is 0 relative to its first guess.
    zero = fit.x < ZERO
    near, size = np.maximum(fit.x, ZERO), np.where(zero, 1.0, fit.x)
    jacobian = _jacobian(residuals, near) * size
    free = count - len(unknowns)
    doubtful = free > 0 and bool(chi2.sf(2.0 * fit.cost, free) < CHANCE)
    network = _network(card, unknowns, values)
    try:
        _told_apart(card, unknowns, jacobian)
        covariance = np.linalg.inv(jacobian.T @ jacobian)
        vague = [item for item, variance in zip(unknowns, np.diag(covariance), strict=True) if variance > VAGUE**2]
        if vague:
            raise _undetermined(card, vague)
    except InputError as error:
        if not doubtful:
            raise
        words = f"these bodies cannot have what was measured; {_worst(_rows(card, network))}"
        raise InputError(words, field="runs") from error
    if not doubtful:
        _check_shares(network)
    hotter, colder = (of_card(_heated(card, 1 + step), near) for step in (HEAT_STEP, -HEAT_STEP))
    by_heat = -covariance @ jacobian.T @ (hotter - colder) / (2 * HEAT_STEP)
    sd = start * size * np.hypot(np.sqrt(np.diag(covariance)), by_heat * card.heat_sd)
    numbers = []
    for item, value, spread, none in zip(unknowns, values, sd, zero, strict=True):
        area = card.films[item.at].area if item.kind in ("at_rest", "rise") else None
        value = 0.0 if none else float(value)
        numbers.append(LumpedNumber(item.name, item.unit, value, float(spread), area, doubtful))
    return LumpedIdentification(card, network, tuple(numbers))


def _check_shares(network: LumpedNetwork) -> None:
    """Refuse a share below 0 of the last heated body, which gets the heat that the others leave."""
    for name, share in zip(network.card.bodies, network.shares, strict=True):
        if share < -1e-6:
            raise InputError(
                f"comes out as {share:.3g}, less than no heat: heat_share = 0 leaves the body without heat; else check "
                "plateaus and known conductances",
                field=f"bodies.{name}.heat_share",
            )


def _heated(card: ThermalCard, factor: float) -> ThermalCard:
    """The card with this multiple of the heat in every run."""
    return card.model_copy(
        update={
            "runs": tuple(
                run.model_copy(update={"rolling_resistance": factor * run.rolling_resistance}) for run in card.runs
            )
        }
    )


def _unknowns(card: ThermalCard) -> list[_Unknown]:
    """What is sought, with first guesses of the size that the measurements have."""
    rise = [max(abs(temperature - run.air), 1.0) for run in card.runs for temperature in run.plateau.values()]
    heat, times = [run.heat for run in card.runs], [300.0]
    times += [time for run in card.runs for table in (run.warm_up, run.cool_down) for time in table.values()]
    conductance = float(np.mean(heat) / np.mean(rise))
    speed = float(np.mean([run.speed for run in card.runs]))
    unknowns = []
    for number, film in enumerate(card.films):
        if film.conductance is None:
            linear = film.speed == "linear"
            name = f"conductance {film.name}" + (" at rest" if linear else "")
            unknowns.append(_Unknown(name, "W/K", "at_rest", number, conductance * (0.5 if linear else 1.0)))
            if linear:
                per_speed = 0.5 * conductance / speed
                unknowns.append(_Unknown(f"conductance {film.name} per speed", "W s/m/K", "rise", number, per_speed))
    timed = [run for run in card.runs if run.warm_up or run.cool_down]
    for number, (name, body) in enumerate(card.bodies.items()):
        if body.heat_capacity is None and timed:
            capacity = conductance * float(np.median(times)) / len(card.bodies)
            unknowns.append(_Unknown(f"heat capacity {name}", "J/K", "capacities", number, capacity))
    if card.identify_shares:
        heated = [number for number, body in enumerate(card.bodies.values()) if body.heat_share > 0]
        names = list(card.bodies)
        for number in heated[:-1]:
            share = card.bodies[names[number]].heat_share
            unknowns.append(_Unknown(f"heat share {names[number]}", "1", "shares", number, share))
    return unknowns


def _network(card: ThermalCard, unknowns: list[_Unknown], values: Array) -> LumpedNetwork:
    bodies = list(card.bodies.values())
    parts = {
        "capacities": np.array([body.heat_capacity or 1.0 for body in bodies]),
        "at_rest": np.array([film.conductance or 0.0 for film in card.films]),
        "rise": np.zeros(len(card.films)),
        "shares": np.array([body.heat_share for body in bodies]),
    }
    for item, value in zip(unknowns, values, strict=True):
        parts[item.kind][item.at] = value
    if card.identify_shares and len(heated := np.flatnonzero(parts["shares"] > 0)):
        parts["shares"][heated[-1]] = 1.0 - parts["shares"][heated[:-1]].sum()
    return LumpedNetwork(card, **parts)


def _data(card: ThermalCard, network: LumpedNetwork) -> list[tuple[tuple[str, str, str], float, float, float]]:
    """Label (run, quantity, body), measured, computed, standard deviation."""
    data, names = [], list(card.bodies)
    for run in card.runs:
        for quantity, measured in (("plateau", run.plateau), ("warm_up", run.warm_up), ("cool_down", run.cool_down)):
            if not measured:
                continue
            computed = getattr(network, quantity)(run)
            for name, value in measured.items():
                if not np.isfinite(computed[names.index(name)]):
                    raise InputError(
                        "has no way to go: it starts at its plateau", field=f"runs.{run.name}.{quantity}.{name}"
                    )
                sd = card.temperature_sd if quantity == "plateau" else card.time_sd * value
                data.append(((run.name, quantity, name), value, float(computed[names.index(name)]), sd))
    return data


def _rows(card: ThermalCard, network: LumpedNetwork) -> list[dict[str, Any]]:
    """Every measured number beside the computed one."""
    rows = []
    for (run, quantity, body), measured, computed, sd in _data(card, network):
        unit = "degC" if quantity == "plateau" else "s"
        rows.append({"run": run, "body": body, "quantity": quantity, "unit": unit, "measured": measured,
                     "computed": computed, "sd": sd})  # fmt: skip
    return rows


def _worst(rows: list[dict[str, Any]]) -> str:
    """The measurement that is missed most, and what to look for."""
    row = max(rows, key=lambda row: abs(_off(row)))
    return (
        f"worst: run '{row['run']}', {row['quantity']} of {row['body']}, measured {row['measured']:.4g}, computed "
        f"{row['computed']:.4g} {row['unit']}. Check the readings and their units; else the tyre needs more bodies or "
        "films"
    )


def _off(row: Mapping[str, Any]) -> float:
    """Residual over its standard deviation."""
    return float((row["measured"] - row["computed"]) / row["sd"])


def _jacobian(residuals: Any, at: Array) -> Array:
    """Central differences, d residuals / d parameters."""
    columns = []
    for number in range(len(at)):
        step = np.zeros(len(at))
        step[number] = 1e-5 * at[number]
        columns.append((residuals(at + step) - residuals(at - step)) / (2 * step[number]))
    return np.column_stack(columns)


def _told_apart(card: ThermalCard, unknowns: list[_Unknown], jacobian: Array) -> None:
    """Refuse numbers whose changes cannot be seen, alone or together; name them and what is missing."""
    _, sizes, directions = np.linalg.svd(jacobian, full_matrices=True)
    sizes = np.concatenate([sizes, np.zeros(len(unknowns) - len(sizes))])
    if sizes[-1] > DETERMINED * sizes[0]:
        return
    raise _undetermined(
        card, [item for item, share in zip(unknowns, np.abs(directions[-1]), strict=True) if share > NAMED]
    )


def _undetermined(card: ThermalCard, among: list[_Unknown]) -> InputError:
    """The error of numbers that the measurements do not determine."""
    names = ", ".join(item.name for item in among)
    return InputError(f"the measurements do not determine {names}: {_missing(card, among)}", field="runs")


def _missing(card: ThermalCard, among: list[_Unknown]) -> str:
    """What would determine numbers."""
    wanted = []
    kinds = {item.kind for item in among}
    ends = [set(card.films[item.at].between) for item in among if item.kind in ("at_rest", "rise")]
    sinks = {name for pair in ends for name in pair if name in ("air", "road", "rim")}
    if "rise" in kinds and len({run.speed for run in card.runs}) < 2:
        wanted.append("runs at two or more speeds")
    if len(sinks) > 1 and all(len({run.surroundings(name) for name in sinks}) == 1 for run in card.runs):
        wanted.append(f"a run in which {' and '.join(sorted(sinks))} differ in temperature")
    bodies = list(card.bodies)
    timed = {name for run in card.runs for name in (*run.warm_up, *run.cool_down)}
    without = [bodies[item.at] for item in among if item.kind == "capacities" and bodies[item.at] not in timed]
    if without:
        wanted.append(f"a time of {', '.join(without)}, or its heat capacity")
    seen = {name for run in card.runs for name in run.plateau}
    unseen = sorted({name for pair in ends for name in pair if name in bodies and name not in seen})
    if unseen:
        wanted.append(f"a plateau of {', '.join(unseen)}")
    if "shares" in kinds and not wanted:
        wanted.append("a known heat share, or a known conductance")
    return "; ".join(wanted) or "a run with another heat, speed or surroundings, or one of these numbers as known"
