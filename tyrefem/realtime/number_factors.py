"""How the numbers of a study other than its drive change a real-time model: factors over each number.

A part of the model is its value in the middle of the box times a factor of each number. Whether parts are such products
is measured at random settings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.realtime.inputs import NAMES, Box, BoxDrive
from tyrefem.realtime.tables import COLD, FINE, HOT, plain
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.model import ReducedModel
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.samples import changes_at
from tyrefem.variants.varied import Varied

Array = NDArray[np.float64]
Parts = dict[str, Array]
#: Points of a factor over its number.
POINTS = 7
#: Relative change that counts as none.
NONE = 1e-9
#: Parts that add up; all others are multiplied.
ADDED = ("sinks",)
#: Settings at which the products are compared with the study itself.
CHECKED = 8


class PartsProbe:
    """Evaluates the parts of a study's balance that numbers beside the drive may change.

    Parameters
    ----------
    model : the modes and sample nodes. box : ranges of the inputs. speeds : (n,) m/s, of the films. stands : does the
        wheel stand in some phase?
    """

    def __init__(self, model: ReducedModel, box: Box, speeds: Array, stands: bool) -> None:
        self.model, self.box, self.speeds, self.stands = model, box, speeds, stands
        # Films, sinks and sources need no modes.
        self._even = ReducedModel(model.base, np.ones((model.base.problem.operators.size, 1)), {}, np.zeros((0, 0)))
        self._first: dict[str, RollingTyre] = {}

    def parts(self, study: StudyData) -> Parts:
        """Name -> values: bodies, films, standing, heat, loss, sinks, capacities, starts.

        Bodies (regions, 3): conductivity along and across, W/m/K, and heat capacity, J/m3/K. Films (speeds, exchanges)
        and standing (exchanges,), W/m2/K. Heat (samples,) J/m3 per m and unit of tan delta. Loss (zones, temperatures):
        tan delta. Sinks (exchanges,) degC. Capacities and starts of the reservoirs, J/K and degC.
        """
        values = self.box.at(np.full(5, 0.5))
        top = max(float(self.speeds[-1]), 1e-3)
        first, last = values.copy(), values.copy()
        first[0], last[0] = 0.0, top
        tyre = self._tyre(study, first, last, "rolls")
        balance = reduced_balance(self._even, tyre)
        plain(balance)
        shares = np.clip(self.speeds / top, 1e-9, 1 - 1e-9)
        grid = np.arange(COLD, HOT + FINE / 2, FINE)
        parts = {
            "bodies": np.array([balance.bodies[region] for region in self.model.mass]),
            "films": np.array([balance.coefficients(float(share))[0] for share in shares]),
            "sinks": balance.coefficients(0.5)[1],
            "heat": np.concatenate([self._heat(tyre, zone) for zone in self.model.zones]),
            "loss": np.array([tyre.hysteresis[zone].loss_tangent(grid) for zone in self.model.zones]),
            "capacities": balance.capacities,
            "starts": balance.start[1:],
        }
        if self.stands:
            still = self._tyre(study, first, first, "stands")
            parts["standing"] = reduced_balance(self._even, still).coefficients(0.5)[0]
        return parts

    def _tyre(self, study: StudyData, first: Array, last: Array, what: str) -> RollingTyre:
        """A tyre on a drive of 1 s; later ones share what they have in common with the first."""
        drive = BoxDrive(np.array([0.0, 1.0]), first[None], last[None], float(first[NAMES.index("ambient")]))
        tyre = RollingTyre(drive.study(study), self._first.get(what, self.model.base))
        self._first.setdefault(what, tyre)
        return tyre

    def _heat(self, tyre: RollingTyre, zone: str) -> Array:
        points = self.model.sample_points[zone]
        if not points.shape[1]:
            return np.zeros(0)
        source, motion = tyre.hysteresis[zone], tyre.motion(0.5)
        rate = source.lost_per_revolution * motion.revolutions_per_second / motion.speed
        return np.asarray(rate * source.energy_density(points, 0.5))


@dataclass(frozen=True, eq=False)
class NumberFactors:
    """Factors on the parts of a model, over each number.

    Parameters
    ----------
    middle : parts in the middle of the box. factors : number of the varied number -> part -> (points, ...) factors at
        equally spaced places of [0, 1]; for `ADDED` parts what is added.
    """

    middle: Parts
    factors: Mapping[int, Parts]

    def at(self, place: Array) -> Parts:
        """The parts at a place of the unit cube."""
        from tyrefem.realtime.tyre import CubicTable

        parts = dict(self.middle)
        for number, changes in self.factors.items():
            for name, table in changes.items():
                factor = CubicTable(table.reshape(len(table), -1), np.array([[0.0, 1.0]]))(float(place[number]))
                factor = factor.reshape(table.shape[1:])
                parts[name] = parts[name] + factor if name in ADDED else parts[name] * factor
        return parts


def number_factors(probe: PartsProbe, study: StudyData, varied: Sequence[Varied]) -> NumberFactors:
    """The factors of all numbers about the middle of the box; ``study``: the study in the middle.

    Raises
    ------
    InputError : a number changes where the tyre's lumped bodies start.
    """
    middle = probe.parts(study)
    factors: dict[int, Parts] = {}
    places = np.linspace(0.0, 1.0, POINTS)
    for number, each in enumerate(varied):
        if each.key.startswith("drive.") and each.key.rpartition(".")[2] in (*NAMES, "initial"):
            continue
        at_ends = [probe.parts(study.replace(each.changes(each.at(end)))) for end in (0.0, 1.0)]
        names = [name for name in middle if any(_differs(middle[name], parts[name]) for parts in at_ends)]
        if "starts" in names:
            raise InputError("changes where contained air or rim start; it cannot vary here", field=f"vary.{each.key}")
        if not names:
            continue
        inner = [probe.parts(study.replace(each.changes(each.at(float(u))))) for u in places[1:-1]]
        rows = [at_ends[0], *inner, at_ends[1]]
        factors[number] = {name: _factors(name, middle[name], [parts[name] for parts in rows]) for name in names}
    return NumberFactors(middle, factors)


def _differs(first: Array, second: Array) -> bool:
    return bool((np.abs(first - second) > NONE * np.maximum(np.abs(first), 1e-12)).any())


def _factors(name: str, middle: Array, rows: Sequence[Array]) -> Array:
    table = np.array(rows)
    if name in ADDED:
        return table - middle
    factors = np.divide(table, middle, out=np.ones_like(table), where=middle != 0)
    # tan delta changes by one factor at all temperatures, as a rule.
    even = factors[..., :1]
    return even if name == "loss" and (np.abs(factors - even) <= 1e-12 * np.abs(even)).all() else factors


def product_errors(probe: PartsProbe, study: StudyData, varied: Sequence[Varied], factors: NumberFactors) -> Parts:
    """Part -> largest relative difference between the product of factors and the study, at random settings."""
    beside = [number for number in range(len(varied)) if number in factors.factors]
    errors: dict[str, float] = {}
    if len(beside) < 2:
        return {}
    for place in np.random.default_rng(4).random((CHECKED, len(varied))):
        chosen = [varied[number] for number in beside]
        exact = probe.parts(study.replace(changes_at(chosen, place[beside])))
        for name, values in factors.at(place).items():
            scale = max(float(np.abs(exact[name]).max(initial=0.0)), 1e-12)
            errors[name] = max(errors.get(name, 0.0), float(np.abs(values - exact[name]).max(initial=0.0)) / scale)
    return {name: np.array(error) for name, error in errors.items()}
