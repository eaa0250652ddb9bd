"""The report of a run: one HTML file with main results, tables and pictures, without scripts or links."""

from __future__ import annotations

import base64
import datetime
import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.geometry.place_names import place
from tyrefem.inputs.study_plugins import plugins_of
from tyrefem.inputs.wheel_state import wheel_state
from tyrefem.output import atomic_path, versions
from tyrefem.reports.assumptions import assumptions
from tyrefem.reports.explore_link import ExploreLink, explore_link
from tyrefem.reports.inputs import boundary_rows, effect_rows, mechanics_rows, section_sources, study_text
from tyrefem.reports.materials import material_rows
from tyrefem.reports.run_files import loaded_cycle, of_run, summary
from tyrefem.reports.template import rendered
from tyrefem.reports.words import number, seconds

if TYPE_CHECKING:
    from tyrefem.inputs.drive import Drive
    from tyrefem.simulation.phases import PhaseState
    from tyrefem.simulation.result import ResultData


def sliding_card(result: ResultData) -> list[dict[str, str]]:
    """Card on the hottest contact; empty for a run without slip."""
    if result.sliding is None:
        return []
    phase = result.sliding.hottest
    limited = f", limited to {number(phase.friction_lowest, 2)} by decomposition" if phase.capped else ""
    return [
        {
            "label": "Sliding contact, exit edge",
            "value": f"{phase.exit_edge_highest:.1f} °C",
            "note": f"mean tread {phase.mean_highest:.1f} °C; phase {phase.name}, friction "
            f"{number(phase.friction, 2)}{limited}",
        }
    ]


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


Rows = list[list[str]]


def content(result: ResultData) -> dict[str, Any]:
    """All values of the template, as text."""
    study = result.study
    materials, estimates = material_rows(study)
    slip = slip_columns(study.card.drive)
    text, as_written = study_text(study)
    return {
        "title": study.title,
        "name": study.name,
        "written": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"),
        "interrupted": _interrupted(result),
        "warnings": result.warnings,
        "sliding": sliding_rows(result),
        "headline": headline(result),
        "published": [value.cells for value in of_run(result)],
        "sensors": _sensors(result),
        "extremes": _extremes(result),
        "phases": [
            [*cells[:SLIP_PLACE], *slips, *cells[SLIP_PLACE:]]
            for cells, *slips in zip((_phase(result, phase) for phase in result.phases), *slip.values(), strict=True)
        ],
        "slip": list(slip),
        "budget": _budget(result),
        "imbalance": f"{result.heat_budget.imbalance:.1e}",
        "materials": materials,
        "estimates": estimates,
        "boundaries": boundary_rows(study),
        "effects": effect_rows(study),
        "mechanics": mechanics_rows(study, loaded_cycle(result)),
        "sources": section_sources(study),
        "numerics": _numerics(result),
        "assumptions": assumptions(study, estimates),
        "study_text": text,
        "as_written": as_written,
    }


def _interrupted(result: ResultData) -> str:
    if not result.history.interrupted:
        return ""
    return f"{seconds(result.times[-1])} of {seconds(result.study.card.drive.end)}"


def headline(result: ResultData) -> list[dict[str, str]]:
    """Main results: label, value and note."""
    values = summary(result)
    hot, resistance, air = values["hottest"], values["rolling_resistance"], values["contained_air"]
    budget = result.heat_budget
    cards = [
        {
            "label": "Hottest point",
            "value": f"{hot['temperature_degC']:.1f} °C",
            "note": f"{hot['region']}, {place(result.study.section, hot['s_m'], hot['depth_m'], hot['region'])}; "
            f"after {seconds(hot['time_s'])}",
        }
    ]
    if resistance["force_N"] > 0:
        cards.append(
            {
                "label": "Rolling resistance",
                "value": f"{number(resistance['force_N'], 3)} N",
                "note": f"coefficient {number(resistance['coefficient'], 3)}; cold "
                f"{number(resistance['cold_force_N'], 3)} N, {number(resistance['cold_coefficient'], 3)}"
                f"{_at_end_of(result)}",
            }
        )
    cards.append(
        {
            "label": "Contained air at the end",
            "value": f"{air['temperature_degC']:.1f} °C",
            "note": f"{number(air['gauge_pressure_Pa'] / 1e3)} kPa gauge, "
            f"{number(result.gas_pressure[0] / 1e3)} kPa at the start",
        }
    )
    cards.append(
        {
            "label": "Heat generated",
            "value": f"{number(budget.total('generated') / 1e3)} kJ",
            "note": f"{_sliding_note(result)}stored {number(budget.total('stored') / 1e3)} kJ, "
            f"lost {number(budget.total('lost') / 1e3)} kJ; "
            f"{'' if budget.empty else 'the budget '}{budget.closing.replace('-', '−')}",
        }
    )
    cards += sliding_card(result)
    loaded = max((p for p in result.phases if p.start < result.times[-1]), key=lambda p: p.deflection, default=None)
    if loaded is not None and loaded.deflection > 0:
        several = f"; phase {loaded.name}" if len(result.phases) > 1 else ""
        cards.append(
            {
                "label": "Deflection",
                "value": f"{loaded.deflection * 1e3:.1f} mm",
                "note": f"{_feedback_note(result)}footprint {loaded.footprint_length * 1e3:.0f} mm, {_area(loaded)}"
                f"{100 * loaded.road_fraction:.1f} % of a "
                f"revolution on the road{several}",
            }
        )
    return cards


def _area(phase: PhaseState) -> str:
    return "" if phase.footprint_area is None else f"{phase.footprint_area * 1e4:.0f} cm² in contact, "


def _feedback_note(result: ResultData) -> str:
    """Text on the feedback of temperature; empty without feedback."""
    return "" if result.feedback is None else f"{result.feedback.words}; "


def _sliding_note(result: ResultData) -> str:
    return "" if result.sliding is None else f"sliding {number(result.heat_budget.total('sliding') / 1e3)} kJ; "


def _at_end_of(result: ResultData) -> str:
    """Time and phase of the rolling resistance, if there are several phases."""
    i = result.rolling_reading
    if i is None or len(result.phases) < 2:
        return ""
    name = next(phase.name for phase in result.phases if result.times[i] <= phase.end + 1e-6)
    return f"; after {seconds(result.times[i])}, phase {name}"


def _drag(result: ResultData, phase: PhaseState) -> str:
    """Rolling resistance at the end of a phase, N; none at rest."""
    end, drive = min(phase.end, float(result.times[-1])), result.study.card.drive
    rests = end == phase.end and drive.phases[drive.locate(phase.start)[0]].stops
    if rests or phase.speed <= 0 or phase.start >= result.times[-1]:
        return "–"
    i = int(np.searchsorted(result.times, end - 1e-6))
    speed = result.tyre.motion(end * (1 - 1e-12)).speed
    return number(float(result.heat_budget.power("generated")[i]) / speed, 3) if speed > 0 else "–"


def _sensors(result: ResultData) -> Rows:
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


def _extremes(result: ResultData) -> Rows:
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


def _phase(result: ResultData, phase: PhaseState) -> list[str]:
    reached = result.times[-1]
    state = "" if reached >= phase.end - 1e-6 else " (not reached)" if phase.start >= reached else " (cut short)"
    return [
        phase.name + state, f"{number(phase.start)} – {number(phase.end)}",
        f"{phase.speed:.2f}", number(phase.load / 1e3), number(phase.pressure / 1e3),
        f"{phase.deflection * 1e3:.1f}", f"{phase.footprint_length * 1e3:.0f}", f"{100 * phase.road_fraction:.1f}",
        number(phase.road_film), f"{phase.air_film:.1f}", _drag(result, phase),
    ]  # fmt: skip


def _budget(result: ResultData) -> list[dict[str, Any]]:
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
                f"{word} {name}",
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


def _numerics(result: ResultData) -> Rows:
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


#: Picture -> caption.
CAPTIONS = {
    "temperature.png": "Temperature on the section at the end of the run, with the thermocouples' readings.",
    "temperature-hottest.png": "Temperature on the section at the time of the highest temperature.",
    "histories.png": "Readings of the thermocouples and temperature of the contained air over time.",
    "sliding.png": "Contact temperatures in every phase with slip. The exit edge is the hottest place of a contact.",
    "heat-budget.png": "Left: generated heat (rising) equals stored and lost heat (falling). Right: powers over time.",
    "heat-source.png": "Heat source by zone, and strain energy per revolution where both sides are alike, at the end "
    "of the rolling phase with most heat.",
    "strain-cycle.png": "The section without load and under the largest load, and the strain cycle along the meridian.",
    "mesh.png": "The modelled mesh.",
    "3d": "Temperature of the tyre, a quarter cut away.",
}


def write_report(result: ResultData, path: Path, *, three_d: bool = False) -> Path:
    """Write the report; pictures already drawn for this result are reused.

    Parameters
    ----------
    three_d : add a 3D picture, if the machine can render it.

    Raises
    ------
    InputError : the file cannot be written.
    """
    path = Path(path)
    page = render(result, explore_link(result.study, path), three_d=three_d)
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def render(result: ResultData, explored: ExploreLink | None = None, *, three_d: bool = False) -> str:
    """The report's HTML."""
    from tyrefem.reports.figures import pictures

    drawn = dict(pictures(result))
    picture = _three_d(result) if three_d else None
    if picture is not None:
        drawn["3d"] = picture
    embedded = [
        {"data": base64.b64encode(png).decode("ascii"), "caption": CAPTIONS.get(name, ""), "name": name}
        for name, png in drawn.items()
    ]
    return rendered("run.html.j2", pictures=embedded, explored=explored, **content(result))


def _three_d(result: ResultData) -> bytes | None:
    from tyrefem.reports.view3d import screenshot
    from tyrefem.reports.vtk import write_series

    with tempfile.TemporaryDirectory() as folder:
        last = replace(result, field_times=result.times[-1:])
        collection = write_series(last, Path(folder), revolved=True)
        ring = collection.with_name(f"{collection.stem}-revolved.pvd")
        drawn = screenshot(ring, Path(folder) / "3d.png")
        return drawn.read_bytes() if drawn else None
