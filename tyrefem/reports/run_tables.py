"""Tables of results in the report of a run: sensors, phases, extremes, slip, heat budget, numerics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.geometry.place_names import place
from tyrefem.inputs.study_plugins import plugins_of
from tyrefem.inputs.wheel_state import wheel_state
from tyrefem.output import versions
from tyrefem.reports.words import number

if TYPE_CHECKING:
    from tyrefem.inputs.drive import Drive
    from tyrefem.simulation.phases import PhaseState
    from tyrefem.simulation.result import ResultData

Rows = list[list[str]]


def sliding_rows(result: ResultData) -> list[list[str]]:
    """One row per phase with slip, in the columns of the template."""
    if result.sliding is None:
        return []
    phases = result.sliding.phases
    beside = {p.name: "–" if p.half_space_highest is None else f"{p.half_space_highest:.1f}" for p in phases}
    return [
        [
            phase.name + (" (locked)" if phase.locked else ""), f"{phase.sliding_speed:.2f}",
            number(phase.pressure / 1e3), f"{phase.friction:.3f}",
            f"{number(phase.friction_lowest, 3)}, decomposition" if phase.capped else "not limited",
            number(phase.friction_work / 1e3), number(phase.tread_heat / 1e3), f"{phase.tread_start:.1f}",
            f"{phase.tread_highest:.1f}", beside[phase.name], f"{phase.exit_edge_highest:.1f}",
        ]
        for phase in phases
    ]  # fmt: skip


def _drag(result: ResultData, phase: PhaseState) -> str:
    """Rolling resistance at the end of a phase, N; none at rest."""
    end, drive = min(phase.end, float(result.times[-1])), result.study.card.drive
    rests = end == phase.end and drive.phases[drive.locate(phase.start)[0]].stops
    if rests or phase.speed <= 0 or phase.start >= result.times[-1]:
        return "–"
    i = int(np.searchsorted(result.times, end - 1e-6))
    speed = result.tyre.motion(end * (1 - 1e-12)).speed
    return number(float(result.heat_budget.power("generated")[i]) / speed, 3) if speed > 0 else "–"


def sensor_rows(result: ResultData) -> Rows:
    """Region, place and temperatures of every sensor, and of every lumped body."""
    section, readings = result.study.section, result.reading_columns
    gradients = result.sensor_gradients
    times, rows = result.times, []
    for name, (r, z) in result.sensor_places.items():
        s, depth = (float(np.ravel(v)[0]) for v in section.locate(np.array([[r, z]])))
        values = readings[name]
        hottest = int(np.argmax(values))
        rows.append(
            [
                name, str(section.region_at(s, depth)), place(section, s, depth),
                f"{s * 1e3:.1f}", f"{depth * 1e3:.1f}",
                f"{values[-1]:.1f}", f"{values[hottest]:.1f}", number(times[hottest]),
                f"{gradients[name][-1] / 1e3:.2f}",
            ]
        )  # fmt: skip
    for name in [column for column in readings if column not in ("time_s", *result.sensor_places)]:
        values = readings[name]
        hottest = int(np.argmax(values))
        rows.append([name.replace("-", " "), "–", "lumped: one temperature", "–", "–", f"{values[-1]:.1f}",
                     f"{values[hottest]:.1f}", number(times[hottest]), "–"])  # fmt: skip
    return rows


def extreme_rows(result: ResultData) -> Rows:
    """Highest temperature of the whole tyre and of every region, with its time and place."""
    return [
        [
            "whole tyre" if row["region"] == "tyre" else str(row["region"]),
            place(result.study.section, row["s_m"], row["depth_m"], "" if row["region"] == "tyre" else row["region"]),
            f"{row['temperature_degC']:.1f}", number(row["time_s"]), f"{row['r_m'] * 1e3:.1f}",
            f"{row['z_m'] * 1e3:.1f}",
        ]
        for row in result.extreme_rows
    ]  # fmt: skip


#: Place of the columns of slip in the table of phases, after the pressure.
SLIP_PLACE = 5


def slip_columns(drive: Drive) -> dict[str, list[str]]:
    """Heading -> text of every phase at its end: slip angle, camber, braking slip and torque, if a phase has them."""
    ends = [wheel_state(phase, 1.0) for phase in drive.phases]
    columns = {
        "slip angle [°]": [math.degrees(wheel.slip_angle) for wheel in ends],
        "camber [°]": [math.degrees(wheel.camber) for wheel in ends],
        "braking slip [%]": [-100 * (wheel.slip or 0.0) for wheel in ends],
        "torque [N m]": [wheel.torque or 0.0 for wheel in ends],
    }
    return {head: [f"{value:z.3g}" for value in values] for head, values in columns.items() if any(values)}


def phase_rows(result: ResultData) -> Rows:
    """One row per phase, with the columns of slip if a phase has them."""
    slip = slip_columns(result.study.card.drive).values()
    cells = (_phase(result, phase) for phase in result.phases)
    return [[*row[:SLIP_PLACE], *slips, *row[SLIP_PLACE:]] for row, *slips in zip(cells, *slip, strict=True)]


def _phase(result: ResultData, phase: PhaseState) -> list[str]:
    reached = result.times[-1]
    state = "" if reached >= phase.end - 1e-6 else " (not reached)" if phase.start >= reached else " (cut short)"
    return [
        phase.name + state, f"{number(phase.start)} – {number(phase.end)}",
        f"{phase.speed:.2f}", number(phase.load / 1e3), number(phase.pressure / 1e3),
        f"{phase.deflection * 1e3:.1f}", f"{phase.footprint_length * 1e3:.0f}", f"{100 * phase.road_fraction:.1f}",
        number(phase.road_film), f"{phase.air_film:.1f}", _drag(result, phase),
    ]  # fmt: skip


def budget_rows(result: ResultData) -> list[dict[str, Any]]:
    """Energy, power and share of every entry of the heat budget, and their totals."""
    budget, rows = result.heat_budget, []
    made = budget.made

    def share(energy: float) -> str:
        return f"{100 * energy / made:z.1f}" if made > 0 else "–"

    words = {
        "generated": "generated in",
        "sliding": "from",
        "stored": "stored in",
        "lost": "lost to",
        "lumped": "of that",
    }
    for kind, word in words.items():
        entries = [(name, series) for (k, name), series in budget.energies.items() if k == kind]
        for name, series in entries:
            power = budget.powers.get((kind, name))
            cells = [
                f"{word} {name.replace('-', ' ') if kind == 'lumped' else name}",
                number(series[-1] / 1e3),
                "–" if power is None else number(power[-1]),
                share(series[-1]),
            ]
            rows.append({"total": False, "cells": cells})
        if entries and kind != "lumped":
            cells = [
                f"{kind} in total",
                number(budget.total(kind) / 1e3),
                number(budget.power(kind)[-1]),
                share(budget.total(kind)),
            ]
            rows.append({"total": True, "cells": cells})
    return rows


def numerics_rows(result: ResultData) -> Rows:
    """Mesh, time integration, wall time and versions."""
    study, steps, mesh = result.study, result.history.steps, result.tyre.mesh.summary()
    rows = [
        ["mesh", f"{mesh['mesher']}: {mesh['nodes']} nodes, {mesh['elements']} {mesh['cell']}s of "
         f"{mesh['size_m'] * 1e3:.3g} mm, {study.card.mesh.element} with "
         f"{result.tyre.problem.operators.size} unknowns, {'half' if mesh['half'] else 'full'} section"],
        ["mesh quality", f"scaled Jacobian at least {mesh['scaled_jacobian']:.2f}, edge ratio at most "
         f"{mesh['edge_ratio']:.1f}"],
        ["time integration", f"adaptive steps, tolerance {study.tolerance:g} K; {steps.accepted} steps accepted, "
         f"{steps.rejected} rejected, {steps.factorisations} factorisations"],
        ["mesh error", f"{study.numerical_sd:g} K (standard deviation assumed by the study)"],
        ["wall time", f"{result.wall_time:.2f} s"],
        ["versions", ", ".join(f"{name} {version}" for name, version in versions().items())],
        *(["own " + plugin.kind.name, f"{plugin.name}, from {plugin.origin.words}"] for plugin in plugins_of(study)),
    ]  # fmt: skip
    if not study.section.half:
        return rows
    return [*rows, ["symmetry", "half section; heat, powers and forces are those of the whole tyre"]]
