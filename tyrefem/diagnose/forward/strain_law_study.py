"""A study with another strain law in place of its own, and the heat of a tyre along the meridian."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.diagnose.forward.fixed_step import FixedStepRun, fixed_step_run
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_laws
from tyrefem.quantity import parse
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.answer_store import study_digest

Array = NDArray[np.float64]
#: Times of the readings, s, and sensor -> degC.
History = tuple[Array, dict[str, Array]]
#: Equal stretches of the meridian between crown and bead in which heat is compared.
STRETCHES = 12
#: Mesh for a strain law by finite elements in place of the study's; the study's mesh corrects its fits at x = 0.
COARSE_MESH = "8 mm"
#: Prior standard deviation of ln of the factor on another law's heat (estimate): a barrel has half the arcs' energy.
LEVEL_SD = 0.5
#: Temperature at which heat is compared, degC.
WARM = 60.0
#: Readings and heat by other laws, by study, law and mesh: all diagnoses of one layout share them. None: cannot run.
_READINGS: Cache[tuple[History, History] | None] = Cache(size=64)
_HEATS: Cache[Array] = Cache(size=16)


def by_law(study: StudyData, law: str, level: float) -> StudyData:
    """The study with another strain law, its heat times exp(level); `LEVEL_SD` is stated as its standard deviation.

    A law that presses the tyre on the road does so in linear motion, which takes seconds.
    """
    entries = [dict(entry) for entry in study.data.get("effects", [])]
    shapes = (entry for entry in entries if entry["name"] == SHAPE and not entry.get("runs"))
    known = next((entry for entry in shapes if str(entry.get("half_waves")) == "0"), None)
    if known is None:
        known = {"name": SHAPE, "half_waves": "0", "log_factor": 0.0}
        entries.append(known)
    known["log_factor"] = float(known.get("log_factor", 0.0)) + level
    known["sd"] = {"log_factor": LEVEL_SD}
    motion = {"mechanics.motion": "linear"} if strain_laws()[law].presses else {}
    return study.replace({"mechanics.strain": law, "effects": entries} | motion)


def mesh_of_law(law: str, mesh_size: str) -> str:
    """The mesh for diagnoses by a strain law: one by finite elements takes minutes on a mesh finer than `COARSE_MESH`.

    >>> mesh_of_law("barrel", "3.5 mm"), mesh_of_law("barrel", "12 mm"), mesh_of_law("arcs", "3.5 mm")
    ('8 mm', '12 mm', '3.5 mm')
    """
    fine = strain_laws()[law].by_elements and parse(mesh_size, "m") < parse(COARSE_MESH, "m")
    return COARSE_MESH if fine else mesh_size


def heat_along(tyre: RollingTyre) -> Array:
    """(`STRETCHES`,) W of hysteresis in equal stretches from crown to bead as the tyre begins to turn, at `WARM`.

    Zero for a drive without rolling. Effects on the heat are left out.
    """
    watts = np.zeros(STRETCHES)
    begin = next((t + 1e-6 for t in tyre.drive.starts if tyre.motion(t + 1e-6).turns), None)
    if begin is None:
        return watts
    operators, section = tyre.problem.operators, tyre.study.section
    for zone, source in tyre.hysteresis.items():
        x = operators.nodes(zone)
        heat = operators.mass_row(zone)[operators.dofs(zone)] * source(x, begin, np.full(x.shape[1], WARM))
        s, _ = section.locate(x.T)
        stretch = np.minimum((np.abs(s) / section.line.length * STRETCHES).astype(int), STRETCHES - 1)
        np.add.at(watts, stretch, heat)
    return watts


def readings_by_law(base: FixedStepRun, law: str, level: float, mesh: str = "") -> tuple[History, History] | None:
    """Readings of a drive by its own strain law and by another one; None if it cannot run.

    Parameters
    ----------
    level : ln of a factor on the heat by the other law. mesh : size of the elements for both; default: the drive's.
    """

    def compute() -> tuple[History, History] | None:
        try:
            stated = fixed_step_run(meshed(base.study, mesh), every=base.every) if mesh else base
            other = fixed_step_run(by_law(stated.study, law, level), every=base.every)
        except InputError:
            return None
        return (stated.grid, stated.readings), (other.grid, other.readings)

    return _READINGS.get((study_digest(base.study), base.every, law, level, mesh), compute)


def heats_by_law(study: StudyData, law: str, mesh: str) -> Array:
    """(2, n) W along the meridian by the study's law and by another one, see `heat_along`; NaN if it cannot run."""

    def compute() -> Array:
        driven = meshed(study, mesh)
        try:
            return np.array([heat_along(RollingTyre(each)) for each in (driven, by_law(driven, law, 0.0))])
        except InputError:
            return np.full((2, STRETCHES), np.nan)

    return _HEATS.get((study_digest(study), law, mesh), compute)


def meshed(study: StudyData, size: str) -> StudyData:
    """The study with another size of the elements; a mesh from a file stays."""
    return study if study.card.mesh.file is not None else study.replace({"mesh.size": size})
