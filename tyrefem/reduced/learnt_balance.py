"""The balance of a variant from learnt inputs, and the learning of them from some dozen studies.

Learnt inputs are used only where they meet fresh studies to the last written digits. In every task two variants are
made as studies, too, and compared.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.reduced.balance import ReducedBalance, reduced_balance
from tyrefem.reduced.heat_change import HeatChange
from tyrefem.reduced.learnt_inputs import LearntInputs, entry_names
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.sampled_source import LOSS_GRID, has_tabulated_loss, sampled_energies
from tyrefem.reduced.separated import RELATIVE, NotSeparableError, separated
from tyrefem.simulation.rolling_resistance import RollingPhase, rolling_phases
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.surroundings import GAS
from tyrefem.variants.answers import input_answers
from tyrefem.variants.samples import changes_at
from tyrefem.variants.varied import Varied

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: Tables of a study whose numbers are learnt: others change sensors, effects or shapes.
TABLES = ("drive", "materials", "boundaries", "mechanics")
#: Inputs of which all entries depend on the same numbers.
LARGE = ("energies", "loss")
#: Variants per evaluation at which learning takes as long as it saves; evaluations per number, at least.
VARIANTS_PER_EVALUATION, LEAST_PER_NUMBER = 4, 7


def learnt_balances(model: ReducedModel, changes: Sequence[Mapping[str, Any]]) -> list[ReducedBalance] | None:
    """The heat balances of variants; None: one is not of this box, or differs from that of its study.

    The variants with the least and the greatest deflection are made as studies and compared.
    """
    # Samples make the changes of a variant whenever they are asked for.
    inputs, changes = model.inputs, list(changes)
    places = [] if inputs is None else [inputs.place(each) for each in changes]
    if inputs is None or not places or any(place is None for place in places):
        return None
    arrays = inputs.at(np.array(places))
    rows = [{name: array[b] for name, array in arrays.items()} for b in range(len(places))]
    by_deflection = np.argsort([float(row.get("answer drive deflection_m", 0.0)) for row in rows], kind="stable")
    for b in {int(by_deflection[0]), int(by_deflection[-1])}:
        try:
            exact = inputs_of(reduced_balance(model, model.tyre(model.base.study.replace(changes[b]))))
        except (InputError, NotReducibleError):
            return None
        if not same_inputs(rows[b], exact):
            return None
    template = reduced_balance(model, model.base)
    empty = [name for name, values in input_answers(model.base).items() if not values]
    return [LearntBalance(template, row, each, empty) for row, each in zip(rows, changes, strict=True)]


class LearntBalance(ReducedBalance):
    """The balance of a variant from its learnt inputs; its tyre is made only where it is wanted.

    Parameters
    ----------
    like : of the model's base study. known : the variant's inputs by name. changes : the variant's.
    empty : functions of answers that give none for this study.
    """

    def __init__(
        self, like: ReducedBalance, known: Mapping[str, Array], changes: Mapping[str, Any], empty: Sequence[str]
    ) -> None:
        self.empty = empty
        self.like, self.known, self.inputs, self.changes = like, known, known, changes
        self._made: RollingTyre | None = None
        self.model, self.films, self.reservoirs, self.layout = like.model, like.films, like.reservoirs, like.layout
        of_bodies = {region: known[f"body {region}"].tolist() for region in like.bodies}
        self.bodies = {region: (along, across, capacity) for region, (along, across, capacity) in of_bodies.items()}
        self.start = np.zeros(len(like.start))
        self.start[0] = known["initial"][0] / like.model.V[0, 0]
        self.start[like.model.size :] = known["initial"][1:]

    @property
    def tyre(self) -> RollingTyre:
        """The variant's tyre, made as a study."""
        if self._made is None:
            self._made = self.model.tyre(self.model.base.study.replace(self.changes))
        return self._made

    @property
    def alike(self) -> RollingTyre:
        """A tyre with the same phases, load-case times, zones, section and sensors."""
        return self.like.tyre

    def on(self, model: ReducedModel) -> ReducedBalance:
        """The same balance on other modes."""
        return LearntBalance(self.like.on(model), self.inputs, self.changes, self.empty)

    @functools.cached_property
    def capacities(self) -> Array:
        """Heat capacities of the reservoirs, (m,) J/K."""
        return self.inputs["capacities"]

    def coefficients(self, t: float, known: dict[int, float] | None = None) -> tuple[Array, Array]:
        """Films and conductances, and their sinks, at a time."""
        films = self.inputs[f"films {self._phase(t)}"]
        return films[:, 0], films[:, 1]

    def powers(self, t: float) -> list[float]:
        """Power into every reservoir from outside, W."""
        return list(self.inputs[f"powers {self._phase(t)}"])

    def _phase(self, t: float) -> int:
        return self.alike.drive.locate(t)[0]

    @property
    def rolling(self) -> tuple[RollingPhase, ...]:
        """The phases in which the variant rolls."""
        phases = zip(rolling_phases(self.alike), self.inputs["rolling"], strict=True)
        return tuple(RollingPhase(p.name, p.start, p.end, float(row[0]), float(row[1])) for p, row in phases)

    def pressure(self, t: float) -> float:
        """Gauge pressure of the drive at a time, Pa."""
        return float(self.inputs[f"pressure {self._phase(t)}"])

    @property
    def fixed_gas(self) -> float:
        """Temperature of contained air that is not a reservoir, degC."""
        return float(self.inputs["fixed gas"])

    @functools.cached_property
    def answers(self) -> dict[str, dict[str, float]]:
        """Function of answers -> its answers, of those that need no temperature."""
        answers: dict[str, dict[str, float]] = {name: {} for name in self.empty}
        for name, value in self.inputs.items():
            kind, *names = name.split()
            if kind == "answer":
                answers.setdefault(names[0], {})[names[1]] = float(value)
        return answers


def inputs_of(balance: ReducedBalance) -> dict[str, Array]:
    """Inputs of a variant made as a study, by name: see `LearntBalance`."""
    tyre, drive = balance.tyre, balance.tyre.drive
    inputs = {f"body {region}": np.array(body) for region, body in balance.bodies.items()}
    first, m = float(balance.model.V[0, 0]), balance.model.size
    inputs["initial"] = np.array([balance.start[0] * first, *balance.start[m:]])
    inputs["capacities"] = balance.capacities
    if GAS not in balance.reservoirs:
        inputs["fixed gas"] = np.array(balance.fixed_gas)
    inputs["rolling"] = np.array([[phase.speed, phase.load] for phase in rolling_phases(tyre)]).reshape(-1, 2)
    for number, (start, phase) in enumerate(zip(drive.starts, drive.phases, strict=True)):
        t = start + 0.5 * phase.duration
        films, sinks = balance.coefficients(t)
        inputs[f"films {number}"] = np.stack([films, sinks], axis=1)
        inputs[f"powers {number}"] = np.array(balance.powers(t))
        inputs[f"energies {number}"] = sampled_energies(balance, number)
        inputs[f"rate {number}"] = np.array(tyre.motion(t).revolutions_per_second)
        inputs[f"pressure {number}"] = np.array(balance.pressure(t))
    for zone, source in tyre.hysteresis.items():
        inputs[f"loss {zone}"] = np.asarray(source.loss_tangent(LOSS_GRID))
    for function, values in input_answers(tyre).items():
        inputs |= {f"answer {function} {name}": np.array(value) for name, value in values.items()}
    return inputs


def same_inputs(known: Mapping[str, Array], exact: Mapping[str, Array]) -> bool:
    """Are the inputs those of a study, but for written digits?"""
    if known.keys() != exact.keys():
        return False
    for name, array in exact.items():
        # Entries of small inputs have units of their own.
        scale = np.abs(array).max(initial=0.0) if name.startswith(LARGE) else np.abs(array)
        if known[name].shape != array.shape or not (np.abs(known[name] - array) <= RELATIVE * scale).all():
            return False
    return True


def _structure(balance: ReducedBalance) -> tuple[Any, ...]:
    """What all variants must have in common."""
    tyre, drive = balance.tyre, balance.tyre.drive
    phases = tuple((phase.name, phase.duration, phase.stands) for phase in drive.phases)
    rolling = tuple(phase.start for phase in rolling_phases(tyre))
    return phases, tyre.schedule.knots, balance.layout, rolling


def _is_steady(balance: ReducedBalance) -> bool:
    """Is all that is learnt constant within every phase, and tan delta a table, changed by no effect?"""
    tyre = balance.tyre
    steady = all(tyre.is_steady(n) and phase.steady_motion for n, phase in enumerate(tyre.drive.phases))
    return steady and has_tabulated_loss(balance) and not HeatChange(balance).acts


def learnt_inputs(model: ReducedModel, varied: Sequence[Varied], variants: int) -> LearntInputs | None:
    """The inputs of a box's variants.

    None: they do not separate, change in a phase, are not numbers, or the ``variants`` are too few to learn for.
    """
    most = variants // VARIANTS_PER_EVALUATION
    if most < LEAST_PER_NUMBER * len(varied):
        return None
    study: StudyData = model.base.study
    keys = [key for number in varied for key in number.keys]
    if any(number.values for number in varied) or any(key.split(".")[0] not in TABLES for key in keys):
        return None
    if model.shapes is not None or model.base.topology is not None or strain_law(study).by_elements:
        return None
    structure: list[tuple[Any, ...]] = []
    shapes: dict[str, tuple[int, ...]] = {}

    def evaluated(x: Array) -> tuple[Array, Mapping[str, Array]]:
        changes = changes_at(varied, x)
        balance = reduced_balance(model, model.tyre(study.replace(changes)))
        structure.append(_structure(balance))
        if structure[-1] != structure[0] or not _is_steady(balance):
            raise NotSeparableError("the variants have other phases, or change within them")
        inputs = inputs_of(balance)
        shapes.update((name, array.shape) for name, array in inputs.items())
        used = np.array([number.place_of(changes[number.key]) for number in varied])
        return used, dict(_entries(inputs))

    try:
        return LearntInputs(tuple(varied), shapes, separated(evaluated, len(varied), most))
    except (NotSeparableError, NotReducibleError, InputError):
        return None


def _entries(inputs: Mapping[str, Array]) -> Iterator[tuple[str, Array]]:
    """Large inputs, and every entry of small ones: these depend on other numbers."""
    for name, array in inputs.items():
        if name.startswith(LARGE):
            yield name, array
        else:
            yield from zip(entry_names(name, array.shape), np.ravel(array), strict=True)
