"""Arrays of the model of all settings of a box: those of the real-time export, and how numbers change them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.realtime.drive_inputs import DriveInputs
from tyrefem.realtime.export import arrays_of, rotation
from tyrefem.realtime.number_factors import NumberFactors
from tyrefem.realtime.setting_tyre import step_lengths
from tyrefem.realtime.tables import Probe, Tables
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.model import ReducedModel
from tyrefem.simulation.heat_budget import NAMES as FILM_NAMES
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.simulate import output_times
from tyrefem.simulation.surroundings import RIM
from tyrefem.variants.varied import Varied

Array = NDArray[np.float64]


def setting_arrays(
    model: ReducedModel,
    inputs: DriveInputs,
    varied: Sequence[Varied],
    probe: Probe,
    tables: Tables,
    factors: NumberFactors,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The arrays that `tyrefem.realtime.setting_tyre` reads, without steps and hottest nodes, and what names them.

    Parameters
    ----------
    probe : of the study in the middle of the box. factors : of the numbers beside the drive.
    """
    study = probe.study
    tyre = probe.middle().tyre
    balance = reduced_balance(model, tyre)
    _, T = rotation(balance)
    m, whole = model.size, 2.0 if study.section.half else 1.0
    every = np.concatenate(list(model.regions.values()))
    arrays = arrays_of(model, probe, tables, np.unique(every))
    del arrays["hot"]
    # A table of tan delta for every zone, as numbers may change the one and not the other.
    middle = factors.middle
    counts = [len(points) for points in model.samples.values()]
    arrays |= {"loss_table": middle["loss"], "loss_row": np.repeat(np.arange(len(counts)), counts)}
    regions = list(model.mass)
    turn = T[:m, :m]
    bodies = np.array([balance.bodies[region] for region in regions])
    arrays |= {
        "middle_bodies": bodies,
        "stiffness_parts": np.array(
            [
                [k * turn.T @ part @ turn for k, part in zip(body[:2], model.conduction[region], strict=True)]
                for region, body in zip(regions, bodies, strict=True)
            ]
        ),
        "mass_parts": np.array(
            [body[2] * turn.T @ model.mass[region] @ turn for region, body in zip(regions, bodies, strict=True)]
        ),
        "exchange_rows": whole * balance.exchanges.rows @ T,
        "exchange_areas": whole * balance.exchanges.areas * balance.exchanges.given,
        "zone_power": whole * _by_region(model, tyre),
        "speeds": tables.axes["speed"],
        "durations": inputs.durations,
        "last_readings": last_readings(model.base),
        "input_constant": inputs.constant,
        "input_slopes": inputs.slopes,
        "low": inputs.low,
        "high": inputs.high,
        "log": np.array([number.log for number in varied], dtype=float),
        "turn": T,
    }
    parts = []
    for number, changes in factors.factors.items():
        for name, table in changes.items():
            parts.append((number, name))
            arrays[f"factor_{number}_{name}"] = table
    films = [_film_name(side, number, tyre.condition_names) for side, number, _ in balance.films]
    about = {
        "read": [*study.sensors, *([RIM] if RIM in balance.reservoirs else [])],
        "heat": [f"generated: {region}" for region in heated_regions(model, tyre)],
        "lost": [f"lost: {name}" for name in films],
        "factors": parts,
    }
    return arrays, about


#: Arrays of more numbers are kept in single precision: a page holds them so.
LARGE = 500


def rounded(arrays: Mapping[str, Array]) -> dict[str, Array]:
    """The arrays with large ones rounded to single precision, as float64."""
    return {
        name: values.astype(np.float32).astype(float) if values.size > LARGE else values
        for name, values in arrays.items()
    }


def step_arrays(inputs: DriveInputs, fineness: int) -> dict[str, Array]:
    """Lengths of all steps, s, and their phases."""
    lengths, phases = [], []
    ends = inputs.at((inputs.low + inputs.high) / 2)[0]
    for number, (duration, (start, end)) in enumerate(zip(inputs.durations, ends, strict=True)):
        of_phase = step_lengths(float(duration), ramp=bool((start != end).any()), fineness=fineness)
        lengths += of_phase
        phases += [float(number)] * len(of_phase)
    return {"step_lengths": np.array(lengths), "step_phases": np.array(phases)}


def last_readings(tyre: RollingTyre) -> Array:
    """(n_phases,) time of the last reading before the end of every phase, s; its start if there is none."""
    times, _ = output_times(tyre)
    ends = [*tyre.drive.starts[1:], tyre.drive.end]
    return np.array([times[max(int(np.searchsorted(times, end - 1e-6)) - 1, 0)] for end in ends])


def heated_regions(model: ReducedModel, tyre: Any) -> list[str]:
    """The regions with strain zones, in the order of the zones."""
    return list(dict.fromkeys(tyre.region(zone) for zone in model.zones))


def _by_region(model: ReducedModel, tyre: Any) -> Array:
    """(n_regions, n_samples) power of every region per heat source at the samples."""
    regions = heated_regions(model, tyre)
    rows = np.zeros((len(regions), model.power.shape[1]))
    for zone, row in zip(model.zones, model.power, strict=True):
        rows[regions.index(tyre.region(zone))] += row
    return rows


def _film_name(side: str, number: int, names: Mapping[tuple[str, int], str]) -> str:
    return names.get((side, number)) or FILM_NAMES.get((side, number)) or side.replace("_", " ")
