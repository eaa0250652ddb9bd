"""The result of a run: readings, extremes, heat budget, rolling resistance."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.boundaries.contained_air import ATMOSPHERE
from tyrefem.brief import SHOWN, Brief
from tyrefem.cache import read_only
from tyrefem.conduction.field import History
from tyrefem.conduction.points import OutsideMeshError, as_points
from tyrefem.errors import InputError
from tyrefem.geometry.meshing.sagitta import nearest_places
from tyrefem.geometry.wall import wall_of
from tyrefem.mechanics.cautions import warnings_of
from tyrefem.quantity import KELVIN
from tyrefem.simulation.effect_states import StateHistory
from tyrefem.simulation.heat_budget import HeatBudget, whole_tyre
from tyrefem.simulation.hot_rubber import hot_rubber
from tyrefem.simulation.phases import PhaseState, deep_contacts, phase_states
from tyrefem.simulation.readings import contained_air, logged_columns, temperatures_at, within
from tyrefem.simulation.rolling_resistance import RollingResistance, just_before, rolling_reading, rolling_resistance
from tyrefem.simulation.sensors import recorded, true_places
from tyrefem.simulation.sliding_outcome import SlidingOutcome, sliding_outcome
from tyrefem.simulation.surroundings import GAS, RIM

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.conduction.field import Peak
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.feedback_outcome import FeedbackOutcome
    from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]


#: Warning of a run of a whole campaign.
CASES_LEFT_OUT = (
    "the study is a campaign: this run is of its base drive; study.campaign() and 'tyrefem run' run its cases"
)


#: Fields of a history that are stored; operators and materials belong to the problem.
KEPT = (
    "times", "values", "reservoirs", "budget", "maximum", "region_maximum", "steps", "interrupted", "states",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class ResultData(Brief):
    """A finished (or interrupted) run of a study.

    It can be pickled with study, mesh, strain cycles and temperatures; all else is computed again. Its arrays are
    read-only, and its tables are the caller's: a change of them leaves the result as it is.
    """

    study: StudyData
    tyre: RollingTyre
    history: History
    #: Times of the temperature fields that are written out, s.
    field_times: Array
    #: Wall time of the run, s.
    wall_time: float
    #: Result of the feedback of temperature on the strain cycle; None for a study without feedback.
    feedback: FeedbackOutcome | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle without functions of time and temperature, which are made again from the study."""
        history = {name: getattr(self.history, name) for name in KEPT}
        return _again, (type(self), self.study, self.tyre, history, self.field_times, self.wall_time, self.feedback)

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        hottest, end = self.peaks["tyre"], float(self.times[-1])
        s, depth = self.place_of(hottest)
        hot = max((region for region in self.peaks if region != "tyre"), key=lambda name: self.peaks[name].temperature)
        resistance = self.rolling_resistance
        return {
            "title": self.study.title,
            "time": f"0 to {end:g} s, {len(self.times)} readings{', interrupted' if self.history.interrupted else ''}",
            "hottest": f"{hottest.temperature:.1f} degC in the {hot} at {hottest.time:g} s, "
            f"s = {s * 1e3:.1f} mm, depth = {depth * 1e3:.1f} mm",
            "sensors": ", ".join(f"{name} {T[-1]:.1f}" for name, T in list(self.recorded.items())[:SHOWN])
            + (" degC at the end" if self.recorded else "none")
            + (f", and {len(self.recorded) - SHOWN} more" if len(self.recorded) > SHOWN else ""),
            "contained air": f"{self.gas_temperature[-1]:.1f} degC at the end",
            **{name: f"{np.mean(state.values[-1]):.4g} {state.unit} at the end" for name, state in self.states.items()},
            "rolling resistance": f"{resistance.force:.1f} N, coefficient {resistance.coefficient:.5f}"
            if resistance.phase
            else "none: the tyre never rolls",
            "heat generated": f"{self.generated(-1)[0] / 1e3:.4g} kJ",
            "mesh": f"{self.tyre.mesh.n_nodes} nodes, {self.study.card.mesh.element}",
            "warnings": f"{len(self.warnings)}",
        }

    # -- temperatures ------------------------------------------------------------------------------------------------

    @property
    def times(self) -> Array:
        """Times of the readings, (n,) s."""
        return np.asarray(self.history.times)

    def at(self, points: ArrayLike) -> Array:
        """Temperatures at points (n_points, 2) in (r, z), m: (n_times, n_points), degC.

        A point between the section's curved outline and the mesh's straight edges gets the temperature of the nearest
        point of the mesh (`tyrefem.geometry.meshing.sagitta`).

        Raises
        ------
        InputError : a point is farther outside; names the point and its distance.
        """
        return temperatures_at(self.tyre, self.history.values, points)

    def near(self, points: ArrayLike) -> Array:
        """Temperatures at points of another mesh of the section, as `at`; outside, those of the nearest place."""
        try:
            return np.asarray(self.history.at(points))
        except OutsideMeshError as error:
            places = as_points(points).copy()
            places[error.numbers] = nearest_places(self.tyre.mesh, places[error.numbers])
            return np.asarray(self.history.at(places))

    def reading_at(self, time: float | None) -> int:
        """Number of the reading nearest to a time, s; None: the last.

        Raises
        ------
        InputError : a time before the first or after the last reading.
        """
        if time is None:
            return len(self.times) - 1
        first, last = float(self.times[0]), float(self.times[-1])
        if not isinstance(time, Real):
            raise InputError(f"must be a number of seconds, not {time!r:.60}", field="time")
        if not first - 1e-9 <= time <= last * (1 + 1e-9):
            raise InputError(f"the run has times from {first:g} to {last:g} s, not {float(time):g} s", field="time")
        return int(np.argmin(np.abs(self.times - time)))

    def temperature_field(self, i: int = -1) -> Callable[[Array], Array]:
        """T(x), degC, at ``times[i]``, for places (2, n) in (r, z), m; see `tyrefem.mechanics.solid.inflation`."""
        return lambda x: self.history.field(i).at(self._inside(np.asarray(x).T))

    @functools.cached_property
    def sensor_places(self) -> dict[str, tuple[float, float]]:
        """(r, z) of every sensor, m."""
        return true_places(self.study)

    def _inside(self, points: ArrayLike) -> Array:
        """Points (n, 2) of the rubber, those outside the straight-sided elements moved to the nearest edge."""
        return within(self.tyre, points)

    @property
    def sensor_points(self) -> Array:
        """(n_sensors, 2) places of the sensors in the mesh, (r, z), m."""
        return self._inside(list(self.sensor_places.values()))

    @property
    def readings(self) -> pd.DataFrame:
        """`reading_columns` as a table; ``readings.attrs["units"]``: column -> unit."""
        import pandas as pd

        table = pd.DataFrame(self.reading_columns)
        table.attrs["units"] = {name: "s" if name == "time_s" else "degC" for name in table}
        return table

    @property
    def reading_columns(self) -> dict[str, Array]:
        """``time_s``, one column per sensor (lag applied), the contained air, and a lumped rim; degC.

        All are as the logger records them: an effect on its clock shifts every column.
        """
        lumped = {GAS: self.gas_temperature} | ({} if self.rim_temperature is None else {RIM: self.rim_temperature})
        return logged_columns(self.study, self.times, self.recorded, lumped)

    @functools.cached_property
    def recorded(self) -> dict[str, Array]:
        """Sensor -> recorded readings, (n_times,) degC."""
        if not self.sensor_places:
            return {}
        columns = recorded(self.study, self.times, self.at(self.sensor_points))
        return {name: read_only(column) for name, column in columns.items()}

    @property
    def rim_temperature(self) -> Array | None:
        """Temperature of a lumped rim, (n_times,) degC; None if the rim's temperature is given."""
        return np.asarray(self.history.reservoirs[RIM]) if RIM in self.history.reservoirs else None

    @functools.cached_property
    def states(self) -> dict[str, StateHistory]:
        """States of effects: "effect state" -> unit, meaning and values (n_times,) or (n_times, n)."""
        return {} if self.tyre.states is None else self.tyre.states.named(np.asarray(self.history.states))

    @functools.cached_property
    def gas_temperature(self) -> Array:
        """Contained-air temperature, (n_times,) degC."""
        return read_only(contained_air(self.study, self.times, self.history.reservoirs))

    @functools.cached_property
    def gas_pressure(self) -> Array:
        """Gauge pressure of the contained air at its temperature and constant volume, (n_times,) Pa.

        p + p_atm = (p_phase + p_atm) T / T_start, p_phase being the drive's (cold) pressure.
        """
        return read_only([self.pressure_at(i) for i in range(len(self.times))])

    def pressure_at(self, i: int) -> float:
        """Gauge pressure of the contained air at ``times[i]``, Pa."""
        return warmed(self.study.card.drive.value("pressure", float(self.times[i])) or 0.0, self.gas_temperature, i)

    @functools.cached_property
    def wall_gradient(self) -> tuple[Array, Array]:
        """s (k,) m along the meridian, and |T inner - T outer| / thickness there at the end, K/m."""
        wall = wall_of(self.tyre.mesh)
        field = self.history.field(len(self.times) - 1)
        inner, outer = (np.asarray(field.at(points)) for points in (wall.inner, wall.outer))
        return read_only(wall.s), read_only(np.abs(inner - outer) / wall.thickness)

    @property
    def gradient_at_sensors(self) -> pd.DataFrame:
        """|grad T| at every sensor, K/m, shaped as `readings`; 0 for lumped temperatures."""
        table = self.readings * 0.0
        table["time_s"] = self.times
        for name, gradient in self.sensor_gradients.items():
            table[name] = gradient
        return table

    @functools.cached_property
    def sensor_gradients(self) -> dict[str, Array]:
        """Sensor -> |grad T|, (n_times,) K/m.

        Central differences over +-0.5 mm along the meridian and the depth, kept inside the rubber.
        """
        if not self.sensor_places:
            return {}
        section, step = self.study.section, 5e-4
        s, depth = section.locate(np.array(list(self.sensor_places.values())))
        squares = np.zeros((len(self.times), len(s)))
        for ds, dd in ((step, 0.0), (0.0, step)):
            ends = [self._inside(section.place(s + sign * ds, depth + sign * dd)) for sign in (1, -1)]
            apart = np.linalg.norm(ends[0] - ends[1], axis=1)
            # At the crown of a half section, both ends are the same point, where the slope along the meridian is zero.
            squares += ((self.at(ends[0]) - self.at(ends[1])) / np.where(apart > 0, apart, np.inf)) ** 2
        return dict(zip(self.sensor_places, read_only(np.sqrt(squares)).T, strict=True))

    @property
    def extremes(self) -> pd.DataFrame:
        """`extreme_rows` as a table."""
        import pandas as pd

        return pd.DataFrame(self.extreme_rows)

    @property
    def extreme_rows(self) -> list[dict[str, Any]]:
        """Highest temperature of the tyre and of every region over the whole run, with place and time."""
        return [dict(row) for row in self._extreme_rows]

    @functools.cached_property
    def _extreme_rows(self) -> list[dict[str, Any]]:
        rows = []
        for region, peak in self.peaks.items():
            s, depth = self.place_of(peak)
            rows.append(
                {
                    "region": region,
                    "temperature_degC": peak.temperature,
                    "time_s": peak.time,
                    "r_m": peak.point[0],
                    "z_m": peak.point[1],
                    "s_m": s,
                    "depth_m": depth,
                }
            )
        return rows

    @property
    def peaks(self) -> dict[str, Peak]:
        """Highest temperature of the ``tyre`` and of every region over the whole run."""
        return {"tyre": self.history.maximum} | dict(self.history.region_maximum)

    def place_of(self, peak: Peak) -> tuple[float, float]:
        """(s, depth) of a peak, m."""
        s, depth = self.study.section.locate(np.array([peak.point]))
        return float(s[0]), float(depth[0])

    @property
    def highest(self) -> Array:
        """Hottest node over time, (n_times,) degC."""
        return np.asarray(self.history.values).max(axis=1)

    # -- heat --------------------------------------------------------------------------------------------------------

    @functools.cached_property
    def heat_budget(self) -> HeatBudget:
        """W and J per region and boundary of the whole tyre; generated = stored + lost."""
        titles = {zone.name: zone.title for zone in self.tyre.schedule.zones}
        return whole_tyre(self.history.budget, titles, self.study.section.half, self.tyre.condition_names)

    @property
    def end_budget(self) -> HeatBudget:
        """The heat budget, for its values at the end."""
        return self.heat_budget

    @functools.cached_property
    def _generated(self) -> tuple[Array, Array]:
        energies, powers = self.heat_budget.energies, self.heat_budget.powers
        rows = [[series[key] for key in energies if key[0] == "generated"] for series in (energies, powers)]
        energy, power = (np.sum(each, axis=0) + np.zeros(len(self.times)) for each in rows)
        return energy, power

    def generated(self, i: int) -> tuple[float, float]:
        """Heat of hysteresis in the whole tyre: energy until ``times[i]``, J, and power at that time, W."""
        energy, power = self._generated
        return float(energy[i]), float(power[i])

    def cold_power(self, t: float) -> float:
        """Power of hysteresis in the whole tyre at the drive's initial temperature, W."""
        problem, initial = self.tyre.problem, self.study.card.drive.initial
        total = 0.0
        for zone, source in self.tyre.sources.items():
            nodes = problem.points(zone)
            q = source(nodes, t, np.full(nodes.shape[1], initial))
            total += float((problem.operators.source(zone) @ q).sum())
        return total * (2.0 if self.study.section.half else 1.0)

    def heat_source(self, i: int) -> dict[str, tuple[Array, Array]]:
        """Zone -> (nodes (2, n), q (n,) W/m3) at ``times[i]``; q at a border is the zone's value."""
        field = self.history.field(i)
        return {
            zone: (
                nodes := self.tyre.problem.points(zone),
                source(nodes, self.just_before(i), self._nodal(field, zone)),
            )
            for zone, source in self.tyre.sources.items()
        }

    def just_before(self, i: int) -> float:
        """A time just before ``times[i]``, which at the end of a phase is still in that phase."""
        return just_before(self.times, i)

    def _nodal(self, field: Any, zone: str) -> Array:
        return np.asarray(field.values[self.tyre.problem.operators.dofs(zone)])

    @functools.cached_property
    def rolling_reading(self) -> int | None:
        """Index of the last reading of the rolling phase with most heat, in which it rolls; None if it never does."""
        return rolling_reading(self)

    @functools.cached_property
    def rolling_resistance(self) -> RollingResistance:
        """Force, N, and coefficient from hysteresis alone."""
        return rolling_resistance(self)

    @functools.cached_property
    def phases(self) -> tuple[PhaseState, ...]:
        """The drive's phases as simulated."""
        return phase_states(self.tyre)

    @functools.cached_property
    def sliding(self) -> SlidingOutcome | None:
        """Friction heat, mean tread and exit-edge temperatures of phases with slip; None if none was reached."""
        return sliding_outcome(self)

    @functools.cached_property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of unusual input, of phases outside the range of the assumptions, and of hot rubber; one line each.

        Where the tread slides, its surface may be hot: `SlidingOutcome.warnings` say where it decomposes.
        """
        return (
            *map(str, warnings_of(self.study)),
            *((CASES_LEFT_OUT,) if self.study.is_campaign else ()),
            *(() if self.feedback is None else self.feedback.warnings),
            *deep_contacts(self.study.section, self.phases),
            *(hot_rubber(self.peaks) if self.sliding is None else self.sliding.warnings),
        )


def _again(
    kind: type[ResultData],
    study: StudyData,
    tyre: RollingTyre,
    history: dict[str, Any],
    times: Array,
    wall_time: float,
    feedback: Any,
) -> ResultData:
    """Make a result from its pickled data."""
    problem = tyre.problem
    return kind(study, tyre, History(problem.operators, problem.regions, **history), times, wall_time, feedback)


def warmed(cold: float, gas: Array, i: int) -> float:
    """Gauge pressure, Pa, of air inflated to ``cold`` (Pa) and then shut in, at reading i of its temperatures, degC."""
    start, now = gas[0] + KELVIN, gas[i] + KELVIN
    return float((cold + ATMOSPHERE) * now / start - ATMOSPHERE)
