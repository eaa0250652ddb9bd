"""Files of a fatigue life: table of the first places, sensitivities, map as a picture and for ParaView."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.fatigue.places import FailurePlace, first_places
from tyrefem.inputs.origin import StudyOrigin, mesh_summary
from tyrefem.interruption import keeping
from tyrefem.output import atomic_folder, write_json
from tyrefem.reports.figures.style import png
from tyrefem.reports.vtu import VtuFile

if TYPE_CHECKING:
    from tyrefem.fatigue.life import LifeData
    from tyrefem.fatigue.sensitivity import LifeShift

#: Files of `write_files`, besides ``summary.json``.
FILES = ("life.csv", "sensitivity.csv", "life.png", "life.vtu")
#: What every file of lives says of them.
ABOUT = (
    "distance until a flaw of c_0 has grown to a crack of c_1; for comparing designs and drives: "
    "not compared with any measured life, and kilometres of small flaws are too few"
)
MINER = "damage of load cases and phases is summed by Miner's rule; the drive is repeated until the sum is 1"


def write_files(
    life: LifeData, folder: Path, shifts: Sequence[LifeShift] = (), *, pictures: bool = True, vtk: bool = True
) -> None:
    """``summary.json``, ``life.csv``, ``sensitivity.csv`` if there are shifts; ``life.png`` and ``life.vtu``."""
    import pandas as pd

    places = first_places(life)
    tables = {"life.csv": pd.DataFrame([{"number": n, **place.row()} for n, place in enumerate(places, start=1)])}
    if shifts:
        tables["sensitivity.csv"] = pd.DataFrame([_shift(shift) for shift in shifts])
    with atomic_folder(folder) as temporary:
        for name, table in tables.items():
            table.to_csv(temporary / name, index=False, float_format="%.8g", lineterminator="\n")
        write_json(summary(life, shifts), temporary / "summary.json")
    with keeping(f"{folder} has the tables, but not the pictures"), atomic_folder(folder) as temporary:
        if pictures:
            from tyrefem.reports.figures.life import life_figure

            (temporary / "life.png").write_bytes(png(life_figure(life, places)))
        if vtk:
            write_vtk(life, temporary / "life.vtu")


def summary(life: LifeData, shifts: Sequence[LifeShift] = ()) -> dict[str, Any]:
    """Contents of ``summary.json``."""
    places = first_places(life)
    drift = life.drift / np.maximum(life.peak, 1e-300)
    phases = [phase.name for phase in life.study.card.drive.phases]
    first = life.first, int(life.typical[life.first])
    mesh = {"elements": len(life.km), "nodes_of_nine_node_elements": life.rings.n_nodes}
    return StudyOrigin(life.study, simulated=life.temperature is None).summary() | {
        "about": ABOUT,
        "sum": MINER,
        "shortest_km": life.shortest,
        "shortest_point_km": float(np.nanmin(life.km)),
        "distance_of_the_drive_km": life.distance / 1e3,
        "temperatures": temperature_words(life),
        "motion": life.study.card.mechanics.motion,
        "regions": {region: float(life.element_km[life.members(region)].min()) for region in life.regions},
        "left_out_without_fatigue_table": list(life.left_out),
        "share_of_phases_at_the_shortest": dict(zip(phases, life.shares[(slice(None), *first)], strict=True)),
        "drift_of_the_energy_over_its_peak_median": float(np.nanmedian(drift)),
        "places": [place.row() for place in places],
        "sensitivity": [_shift(shift) for shift in shifts],
        "cards": {region: _card(life, region) for region in life.regions},
        "mesh": mesh_summary(life.study) | mesh,
    }


def temperature_words(life: LifeData) -> str:
    """Which temperatures a life has."""
    if life.temperature is not None:
        return f"{life.temperature:g} degC everywhere"
    return "of the run, each phase at its end" if life.plateau else "of the run over time"


def _card(life: LifeData, region: str) -> dict[str, Any]:
    table = life.study.materials[region].fatigue
    return {} if table is None else table.model_dump()


def _shift(shift: LifeShift) -> dict[str, Any]:
    row = asdict(shift)
    return {
        "change": row["change"],
        "shortest_km": row["km"],
        "over_the_life_before": row["ratio"],
        "region": row["region"],
        "temperature_degC": row["temperature"],
    }


def write_vtk(life: LifeData, path: Path) -> None:
    """Write the section's elements with their life; x = z (axial), y = r, metres, as the files of a run.

    Cell data: ``life_km`` and ``log10_life_km`` (NaN: no ``[fatigue]``), ``peak_J_m3``, ``valley_J_m3``,
    ``tearing_energy_J_m2``, ``temperature_degC``, ``normal`` of the plane in (x, y, circumference), ``region``.
    """
    rings = life.rings
    corners = rings.element_nodes[:, :4]
    at = np.arange(len(life.km)), life.typical
    names = list(rings.mesh.subdomains)
    region = np.zeros(len(life.km), dtype=np.int32)
    for number, name in enumerate(names, start=1):
        region[np.asarray(rings.mesh.subdomains[name])] = number
    with np.errstate(divide="ignore"):
        fields = {
            "life_km": life.element_km,
            "log10_life_km": np.log10(np.maximum(life.element_km, 1e-12)),
            "peak_J_m3": life.peak[at],
            "valley_J_m3": life.valley[at],
            "tearing_energy_J_m2": life.tearing_energy[at],
            "temperature_degC": life.temperatures[at],
        }
    normal = life.normals[at][:, [1, 0, 2]]
    points = np.stack([rings.nodes[1], rings.nodes[0], np.zeros(rings.n_nodes)], axis=1)
    cells = {name: np.asarray(values) for name, values in fields.items()} | {"normal": normal, "region": region}
    VtuFile(points, corners[:, ::-1], "quad").write(path, cell_data=cells, names={"region": names})


def words(life: LifeData, shifts: Sequence[LifeShift] = (), places: Sequence[FailurePlace] | None = None) -> str:
    """The table of the first places as text."""
    places = first_places(life) if places is None else places
    phases = life.study.card.drive.phases
    lines = [
        life.study.title,
        f"  temperatures        {temperature_words(life)}; motion {life.study.card.mechanics.motion}",
        f"  {'km':>9} {'W_c kJ/m3':>9} {'T J/m2':>7}  reason",
    ]
    lines += [
        f"  {_km(place.km):>9} {place.peak / 1e3:9.1f} {place.tearing_energy:7.2f}  {place.reason}" for place in places
    ]
    if len(phases) > 1:
        first = places[0]
        lines.append(
            f"  {len(phases)} phases are summed by Miner's rule; at the first place '{first.phase}' does "
            f"{first.phase_share:.0%} of the damage"
        )
    lines += [
        f"  {shift.change:16} shortest life {_km(shift.km)} km, {shift.ratio:.2f} times, in the {shift.region}"
        for shift in shifts
    ]
    if life.left_out:
        lines.append(f"  left out: {', '.join(life.left_out)} (cards without [fatigue])")
    lines.append(f"  {ABOUT}")
    return "\n".join(lines)


def _km(value: float) -> str:
    return f"{value:,.0f}" if value < 1e7 else f"{value:.2g}"
