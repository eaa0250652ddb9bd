"""The file of a finished run: its study with all cards, mesh, temperatures, heat and strain cycles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tyrefem
from tyrefem.conduction.budget import Budget
from tyrefem.conduction.field import History, Peak, Steps
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import TyreMesh
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_copy import copied, study_of
from tyrefem.mechanics import stored_cycles
from tyrefem.output.arrays import read_arrays, write_arrays
from tyrefem.simulation.feedback_outcome import FeedbackOutcome, InflationState
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import RollingTyre

Arrays = dict[str, NDArray[Any]]

#: Name of the file in a folder of results.
FILE = "result.npz"
#: Format of the file: raised when older files can no longer be read.
FORMAT = 1
#: Fields of a budget that are arrays, (n_times,) each; all others are tables of them, by name.
SERIES = ("times", "residual", "throughput")


def write_result(result: ResultData, path: Path) -> Path:
    """Write a result as a file for `read_result`. Temperatures are rounded to 1e-9 K.

    Raises
    ------
    InputError : the file cannot be written.
    """
    history, tyre = result.history, result.tyre
    mesh, arrays = _mesh(tyre.mesh)
    cycles, of_cycles = stored_cycles.stored(tyre.schedule)
    budget, of_budget = _tables(history.budget)
    data = {
        "format": FORMAT,
        "version": tyrefem.__version__,
        "study": copied(result.study),
        "mesh": mesh,
        "cycles": cycles,
        "feedback": None if result.feedback is None else asdict(result.feedback),
        "wall_time": result.wall_time,
        "interrupted": history.interrupted,
        "steps": asdict(history.steps),
        "maximum": asdict(history.maximum),
        "region_maximum": {region: asdict(peak) for region, peak in history.region_maximum.items()},
        "reservoirs": list(history.reservoirs),
        "budget": budget,
    }
    arrays |= of_cycles | of_budget
    arrays["field_times"] = np.asarray(result.field_times)
    arrays["states"] = np.asarray(history.states)
    arrays |= {f"reservoir-{name}": np.asarray(values) for name, values in history.reservoirs.items()}
    return write_arrays(path, data, arrays, {"temperatures": np.asarray(history.values)})


def read_result(path: Path, study_kind: type[StudyData] = StudyData) -> ResultData:
    """The result of a file of `write_result`; ``study_kind``: class of its study.

    Raises
    ------
    InputError : the file is damaged, or of another format; its study has an error here, e.g. an unknown effect.
    """
    data, arrays = read_arrays(path)
    if data.get("format") != FORMAT:
        raise InputError(
            f"has the format {data.get('format')}, written by tyrefem {data.get('version', 'of another version')}; "
            f"tyrefem {tyrefem.__version__} reads format {FORMAT}: run the study again",
            file=path,
        )
    try:
        return _result(data, arrays, study_kind)
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise InputError(f"is damaged: {error!r:.80}; run the study again", file=path) from error


def _result(data: Mapping[str, Any], arrays: Arrays, study_kind: type[StudyData]) -> ResultData:
    study = study_of(study_kind, data["study"])
    schedule = stored_cycles.restored(study, data["cycles"], arrays)
    # The problem of a study with feedback needs cycles at its temperatures.
    warmed = None if data["feedback"] is None else schedule
    tyre = RollingTyre(study, cycles=warmed, parts=(schedule, _meshed(study, data["mesh"], arrays)))
    budget = _budget(data["budget"], arrays)
    history = History(
        tyre.problem.operators,
        tyre.problem.regions,
        budget.times,
        arrays["temperatures"],
        {name: arrays[f"reservoir-{name}"] for name in data["reservoirs"]},
        budget,
        _peak(data["maximum"]),
        {region: _peak(peak) for region, peak in data["region_maximum"].items()},
        Steps(**data["steps"]),
        data["interrupted"],
        arrays["states"],
    )
    if history.values.shape != (len(budget.times), tyre.problem.operators.size):
        raise InputError(f"temperatures of {history.values.shape[1]} nodes do not belong to the mesh")
    if tyre.states is not None:
        tyre.states.record(history.times, history.states)
    return ResultData(study, tyre, history, arrays["field_times"], data["wall_time"], _feedback(data["feedback"]))


def _peak(data: Mapping[str, Any]) -> Peak:
    return Peak(data["temperature"], tuple(data["point"]), data["time"])


def _feedback(data: Mapping[str, Any] | None) -> FeedbackOutcome | None:
    if data is None:
        return None
    start, end = (InflationState(**data[key]) for key in ("start", "end"))
    softened, friction = data["softened"], data.get("friction_temperature")
    return FeedbackOutcome(data["tolerance"], tuple(data["changes"]), start, end, softened, friction)


def _mesh(mesh: TyreMesh) -> tuple[dict[str, Any], Arrays]:
    """Plain data and arrays of a mesh with its names."""
    inner = mesh.mesh
    groups = {"region": inner.subdomains or {}, "boundary": inner.boundaries or {}}
    arrays = {"mesh-points": inner.p, "mesh-cells": inner.t}
    arrays |= {f"{kind}-{name}": np.asarray(part) for kind, parts in groups.items() for name, part in parts.items()}
    names = {kind: list(parts) for kind, parts in groups.items()}
    return {"mesher": mesh.mesher, "size": mesh.size, "cell": mesh.cell, **names}, arrays


def _meshed(study: StudyData, data: Mapping[str, Any], arrays: Arrays) -> TyreMesh:
    import skfem

    kind = {"quad": skfem.MeshQuad1, "tri": skfem.MeshTri1}[data["cell"]]
    regions, boundaries = ({name: arrays[f"{what}-{name}"] for name in data[what]} for what in ("region", "boundary"))
    inner = kind(arrays["mesh-points"], arrays["mesh-cells"], boundaries, regions)
    return TyreMesh(inner, study.section, data["mesher"], data["size"], data["cell"])


def _tables(budget: Budget) -> tuple[dict[str, Any], Arrays]:
    """The names in every table of a budget, and the tables as arrays (n_names, n_times)."""
    arrays: Arrays = {f"budget-{name}": np.asarray(getattr(budget, name)) for name in SERIES}
    names: dict[str, Any] = {"floor": budget.floor}
    for name in _table_names():
        table: Mapping[Any, Any] = getattr(budget, name)
        names[name] = [list(key) if isinstance(key, tuple) else key for key in table]
        arrays[f"budget-{name}"] = np.array(list(table.values())).reshape(len(table), len(budget.times))
    return names, arrays


def _table_names() -> list[str]:
    return [field.name for field in fields(Budget) if field.name not in (*SERIES, "floor")]


def _budget(names: Mapping[str, Any], arrays: Arrays) -> Budget:
    series: dict[str, Any] = {name: arrays[f"budget-{name}"] for name in SERIES}
    for name in _table_names():
        keys = [tuple(key) if isinstance(key, list) else key for key in names[name]]
        series[name] = dict(zip(keys, arrays[f"budget-{name}"], strict=True))
    return Budget(**series, floor=names["floor"])
