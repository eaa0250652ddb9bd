"""Sliding in a run: friction, heat into the tread, mean tread and exit-edge temperatures."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.skid import half_space_surface
from tyrefem.brief import Brief

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.conduction.field import History
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.heat_budget import HeatBudget
    from tyrefem.simulation.phases import PhaseState
    from tyrefem.simulation.rolling_tyre import RollingTyre
    from tyrefem.simulation.sliding_tread import SlidingTread

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]
#: Largest difference of the surfaces of section and half-space without a warning, as a share of a skid's rise.
UNRESOLVED = 0.05
#: Part of a skid after which that is asked: no mesh resolves its first instant.
SETTLED = 0.2


class SlidingRun(Protocol):
    """What the sliding of a run is read from; a `Result` is one."""

    @property
    def study(self) -> StudyData: ...
    @property
    def tyre(self) -> RollingTyre: ...
    @property
    def history(self) -> History: ...
    @property
    def times(self) -> Array: ...
    @property
    def phases(self) -> tuple[PhaseState, ...]: ...
    @property
    def heat_budget(self) -> HeatBudget: ...


@dataclass(frozen=True)
class SlidingPhase:
    """A phase with slip. SI, degC; ``highest`` values are over the phase's readings.

    ``sliding_speed`` is the highest, with the ``friction`` at that time; ``pressure`` is of the contact at the end.
    ``tread_start``, ``tread_highest``: means over the tread's surface by finite elements; ``half_space_highest``: mean
    surface temperature of a half-space, for a locked wheel. ``exit_edge_highest``: highest temperature of a contact.
    ``friction_work``: time integral of mu F_z v_s; ``tread_heat``: the tread's part of it, both of one footprint.
    """

    name: str
    start: float
    end: float
    locked: bool
    sliding_speed: float
    pressure: float
    friction: float
    friction_lowest: float
    capped: bool
    friction_work: float
    tread_heat: float
    tread_start: float
    tread_highest: float
    half_space_highest: float | None
    exit_edge_highest: float
    exit_edge_time: float
    heated_depth: float

    @property
    def mean_highest(self) -> float:
        """Highest mean temperature of the sliding surface; under a locked wheel, of the half-space."""
        return self.tread_highest if self.half_space_highest is None else self.half_space_highest

    @property
    def surface(self) -> str:
        """Whose temperature `mean_highest` is, in words."""
        return "mean tread" if self.half_space_highest is None else "half-space"


@dataclass(frozen=True, eq=False)
class SlidingOutcome(Brief):
    """Sliding in a run.

    Parameters
    ----------
    title : the study's title. decomposition_temperature : of the tread's rubber, degC.
    phases : one entry per simulated phase with slip. series : the contact over time, one row per reading.
    warnings : one line of text each.
    """

    title: str
    decomposition_temperature: float
    phases: tuple[SlidingPhase, ...]
    series: pd.DataFrame
    warnings: tuple[str, ...]

    def _facts(self) -> Mapping[str, Any]:
        return {
            phase.name: f"{phase.sliding_speed:.3g} m/s, {phase.surface} {phase.mean_highest:.0f} degC at most, exit "
            f"edge {phase.exit_edge_highest:.0f} degC at {phase.exit_edge_time:g} s"
            for phase in self.phases
        }

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """``phases`` as a table."""
        import pandas as pd

        return pd.DataFrame([asdict(phase) for phase in self.phases])

    @property
    def hottest(self) -> SlidingPhase:
        """The phase with the hottest exit edge."""
        return max(self.phases, key=lambda phase: phase.exit_edge_highest)

    def to_dict(self) -> dict[str, Any]:
        """Data for JSON, one entry per phase."""
        return {"phases": [asdict(phase) for phase in self.phases]}


def _warnings(run: SlidingRun, phase: SlidingPhase, series: pd.DataFrame) -> Iterator[str]:
    """Warnings of limited friction, of locked wheels, and of skids that the mesh does not resolve."""
    limit = run.tyre.sliding.law.decomposition_temperature
    if phase.capped:
        yield (
            f"phase '{phase.name}': friction falls from {phase.friction:.2g} to {phase.friction_lowest:.2g}, so "
            f"that the contact stays below {limit:g} degC, where its rubber decomposes"
        )
    tyre = run.tyre
    share = tyre.sliding.footprint_share((phase.start + phase.end) / 2)
    # A wheel off the road does not slide.
    if not phase.locked or share == 0:
        return
    yield (
        f"phase '{phase.name}': the wheel is locked, the section is the one on the road; the heat budget counts a "
        f"ring of such sections, {1 / share:.3g} times the footprint"
    )
    late = series[series.time_s > phase.start]
    late = late[late.time_s >= phase.start + SETTLED * (phase.end - phase.start)]
    apart = (late.tread_mean_degC - late.half_space_degC).abs().max()
    rise = late.half_space_degC.max() - phase.tread_start
    if apart > UNRESOLVED * abs(rise):
        yield (
            f"phase '{phase.name}': heat penetrates {phase.heated_depth * 1e3:.2g} mm, elements are "
            f"{tyre.mesh.size * 1e3:.2g} mm: the section's surface is up to {apart:.2g} K off the half-space "
            "value, which is reported beside it; use a smaller mesh.size"
        )


def sliding_outcome(run: SlidingRun) -> SlidingOutcome | None:
    """The sliding of a run; None if no phase with slip was reached."""
    if not any(run.tyre.sliding.rubs(phase) for phase in run.study.card.drive.phases):
        return None
    import pandas as pd

    phases, rows = [], []
    warnings: list[str] = []
    for number, phase in enumerate(run.study.card.drive.phases):
        start = run.study.card.drive.starts[number]
        numbers = np.flatnonzero((run.times >= start - 1e-6) & (run.times <= start + phase.duration + 1e-6))
        if run.tyre.sliding.rubs(phase) and len(numbers) > 1:
            readings = list(_series(run, number, numbers))
            series = pd.DataFrame(readings)
            rows += readings
            phases.append(_phase(run, number, numbers, series))
            warnings += _warnings(run, phases[-1], series)
    if not phases:
        return None
    limit = run.tyre.sliding.law.decomposition_temperature
    return SlidingOutcome(run.study.title, limit, tuple(phases), pd.DataFrame(rows), tuple(warnings))


def _within(run: SlidingRun, number: int, i: int) -> float:
    """The time of a reading, moved inside the phase at its ends."""
    drive = run.study.card.drive
    start, duration = drive.starts[number], drive.phases[number].duration
    return float(np.clip(run.times[i], start + 1e-9 * duration, start + duration * (1 - 1e-9)))


def _series(run: SlidingRun, number: int, numbers: Numbers) -> Iterator[dict[str, Any]]:
    sliding, drive = run.tyre.sliding, run.study.card.drive
    surface, phase = sliding.surface, drive.phases[number]
    beside = _half_space(run, number, numbers)
    for i, skid in zip(numbers, beside, strict=True):
        t = _within(run, number, int(i))
        nodes = run.history.values[i][surface.dofs]
        T = surface.trace @ nodes
        mean, flux = float(surface.weight @ T / surface.area), sliding.friction_flux(surface.x, t, T)
        most = sliding.uncapped_flux(surface.x, t)
        used, wanted = sliding.friction_power(flux, t), sliding.friction_power(most, t)
        friction, passage = sliding.friction(t), sliding.passage(t)
        locked = drive.locked_since(t) is not None
        share = 0.0 if passage is None else passage.tread_share
        if locked and used > 0:
            flux_used = used / sliding.contact_area(t)
            share = 1.0 - sliding.skid_film(t) * (skid - run.tyre.road_temperature(t)) / flux_used
        yield {
            "phase": phase.name,
            "time_s": float(run.times[i]),
            "sliding_speed_m_s": sliding.sliding_speed(t),
            "contact_pressure_Pa": sliding.pressure(t),
            "friction": friction * used / wanted if wanted > 0 else friction,
            "capped": bool((flux < most * (1 - 1e-9)).any()),
            "friction_power_W": used,
            "tread_share": share,
            "tread_mean_degC": mean,
            "tread_hottest_degC": float(nodes.max()),
            "half_space_degC": skid,
            "exit_edge_degC": float(np.max(_exit_edge(sliding, t, skid if locked else nodes))),
        }


def _exit_edge(sliding: SlidingTread, t: float, T: Array | float) -> Array:
    """At the nodes of the tread's surface; for the one temperature of a locked wheel at one of them."""
    points = sliding.surface.points
    if isinstance(T, np.ndarray):
        return sliding.exit_edge(points, t, T)
    return sliding.exit_edge(points[:, :1], t, np.array([T]))


def _half_space(run: SlidingRun, number: int, numbers: Numbers) -> Array:
    """Surface temperature of a locked wheel's half-space at readings, starting at the section's mean; else NaN."""
    tyre, drive = run.tyre, run.study.card.drive
    inside = [_within(run, number, int(i)) for i in numbers]
    since = drive.locked_since(inside[0])
    if since is None:
        return np.full(len(numbers), math.nan)
    sliding = tyre.sliding
    first = int(np.searchsorted(run.times, since - 1e-6))
    initial = _mean_surface(run, first)
    last = drive.starts[number] + drive.phases[number].duration

    def at(time: float) -> float:
        return min(since + time, last * (1 - 1e-12))

    return half_space_surface(
        np.array(inside) - since,
        lambda time: float(sliding.friction_flux(sliding.surface.points[:, :1], at(time), np.array([initial]))[0]),
        lambda time: sliding.skid_film(at(time)),
        lambda time: tyre.road_temperature(at(time)),
        initial,
        sliding.effusivities[0],
    )


def _mean_surface(run: SlidingRun, i: int) -> float:
    surface = run.tyre.sliding.surface
    return float(surface.row @ run.history.values[i][surface.dofs] / surface.area)


def _phase(run: SlidingRun, number: int, numbers: Numbers, series: pd.DataFrame) -> SlidingPhase:
    sliding, tyre = run.tyre.sliding, run.tyre
    drive, state = run.study.card.drive, run.phases[number]
    seconds = series.time_s.to_numpy()
    hottest, fastest = int(series.exit_edge_degC.argmax()), int(series.sliding_speed_m_s.argmax())
    energies = run.heat_budget.energies
    energy = sum((heat for (kind, _), heat in energies.items() if kind == "sliding"), np.zeros(1))
    heat = float(energy[numbers[-1]] - energy[numbers[0]])
    middle = float(seconds[0] + seconds[-1]) / 2
    k, capacity = tyre.tread
    since = drive.locked_since(middle)
    return SlidingPhase(
        name=state.name,
        start=state.start,
        end=min(state.end, float(run.times[-1])),
        locked=state.locked,
        sliding_speed=float(series.sliding_speed_m_s.iloc[fastest]),
        pressure=float(series.contact_pressure_Pa.iloc[-1]),
        friction=sliding.friction(_within(run, number, int(numbers[fastest]))),
        friction_lowest=float(series.friction.min()),
        capped=bool(series.capped.any()),
        friction_work=float(np.trapezoid(series.friction_power_W, seconds)),
        # Under a locked wheel, the budget counts a sliding ring of sections: take the footprint's share.
        tread_heat=heat * (sliding.footprint_share(middle) if state.locked else 1.0),
        tread_start=float(series.tread_mean_degC.iloc[0]),
        tread_highest=float(series.tread_mean_degC.max()),
        half_space_highest=float(series.half_space_degC.max()) if state.locked else None,
        exit_edge_highest=float(series.exit_edge_degC.iloc[hottest]),
        exit_edge_time=float(seconds[hottest]),
        heated_depth=math.sqrt(4.0 * k / capacity * (float(seconds[-1]) - since)) if since is not None else 0.0,
    )
