"""`summary.json` and the tables of a run, from which it can be checked and repeated."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.origin import StudyOrigin
from tyrefem.inputs.published import PublishedComparison, compared, of_footprint
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import versions, write_json
from tyrefem.output.csv_table import columns_of, write_csv

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.stored_cycles import PressedCycle
    from tyrefem.simulation.result import ResultData


def of_run(result: ResultData) -> tuple[PublishedComparison, ...]:
    """Compare a run with its study's published ranges: rolling resistance at the end, and with finite elements
    (``mechanics.strain = "fem"``) the footprint under the last load of the first loaded phase."""
    values = {"rolling_resistance_coefficient": result.rolling_resistance.coefficient}
    cycle = loaded_cycle(result)
    if cycle is not None and cycle.footprint is not None:
        values |= of_footprint(cycle.footprint)
    return compared(result.study.card.published, values)


def loaded_cycle(result: ResultData) -> PressedCycle | None:
    """The strain cycle under the last load of the first loaded phase; None without finite elements or without load."""
    for cycle in (cycles[-1] for cycles in result.tyre.schedule.cycles):
        if getattr(cycle, "footprint", None) is not None:
            pressed: PressedCycle = cycle  # type: ignore[assignment]
            return pressed
    return None


def footprint_summary(cycle: PressedCycle | None) -> dict[str, Any]:
    """Numbers of a strain cycle's footprint, SI; for a linear one also what its strains leave out."""
    if cycle is None or cycle.footprint is None:
        return {}
    footprint = cycle.footprint
    numbers: dict[str, Any] = {
        "motion": footprint.motion,
        "load_N": footprint.load,
        "deflection_m": footprint.deflection,
        "tangent_stiffness_N_m": footprint.stiffness,
        "length_m": footprint.length,
        "width_m": footprint.width,
        "area_m2": footprint.area,
        "rolling_radius_m": footprint.rolling_radius,
        "harmonics": footprint.contact_harmonics,
        "error": footprint.error,
    }
    if footprint.motion == "linear" and cycle.linearisation_error is not None:
        numbers["left_out_by_linear_strains"] = asdict(cycle.linearisation_error)
    return {"footprint": numbers}


#: Tables of a run, as CSV files.
TABLES = ("readings.csv", "extremes.csv", "heat_budget.csv", "heat_power.csv", "sliding.csv")


def summary(result: ResultData) -> dict[str, Any]:
    """Numbers of the run; each key names its unit: SI or degC."""
    study, history = result.study, result.history
    readings, peak = result.reading_columns, result.extreme_rows[0]
    resistance = result.rolling_resistance
    return {
        "study": study.name,
        "title": study.title,
        "complete": not history.interrupted,
        "hottest": {
            "temperature_degC": peak["temperature_degC"],
            "time_s": peak["time_s"],
            "region": _hottest_region(result),
            "r_m": peak["r_m"],
            "z_m": peak["z_m"],
            "s_m": peak["s_m"],
            "depth_m": peak["depth_m"],
        },
        "rolling_resistance": {
            "phase": resistance.phase,
            "force_N": resistance.force,
            "coefficient": resistance.coefficient,
            "cold_force_N": resistance.cold_force,
            "cold_coefficient": resistance.cold_coefficient,
        },
        "published": [value.to_dict() for value in of_run(result)],
        **footprint_summary(loaded_cycle(result)),
        "contained_air": {
            "temperature_degC": float(result.gas_temperature[-1]),
            "gauge_pressure_Pa": float(result.gas_pressure[-1]),
        },
        **({} if not result.states else {"states": _states(result)}),
        "sensors": {
            name: {"end_degC": float(readings[name][-1]), "max_degC": float(readings[name].max())}
            for name in study.sensors
        },
        "extremes": result.extreme_rows,
        "heat_budget": result.heat_budget.to_dict(),
        **({} if result.sliding is None else {"sliding": result.sliding.to_dict()}),
        **({} if result.feedback is None else {"feedback": result.feedback.to_dict()}),
        "warnings": list(result.warnings),
        "phases": [asdict(phase) for phase in result.phases],
        "mesh": result.tyre.mesh.summary() | {"element": study.card.mesh.element},
        "numerics": {"tolerance_K": study.tolerance, **asdict(history.steps)},
        "section": study.section.summary(),
        "wall_time_s": result.wall_time,
        "versions": versions(),
        **plugin_summary(study),
        "random_seed": None,
        "input": dict(study.data),
    }


def _states(result: ResultData) -> dict[str, Any]:
    """States of effects at the end; the mean of a state with a value per place."""
    return {
        name: {
            "unit": state.unit,
            "meaning": state.meaning,
            "start": float(state.values[0].mean()),
            "end": float(state.values[-1].mean()),
            "min": float(state.values.min()),
            "max": float(state.values.max()),
        }
        for name, state in result.states.items()
    }


def _hottest_region(result: ResultData) -> str:
    peaks = result.history.region_maximum
    return max(peaks, key=lambda region: peaks[region].temperature)


def table_files() -> list[str]:
    """The files that `write_tables` may write, besides the study's."""
    from tyrefem.simulation.stored_result import FILE

    return [*TABLES, *(name.replace(".csv", ".parquet") for name in TABLES), FILE]


def run_files(study: StudyData, folder: Path) -> list[str]:
    """The files that a run of ``study`` may write, relative to its folder."""
    from tyrefem.reports.figures import PICTURES
    from tyrefem.reports.vtk import file_names

    whole = [*table_files(), *StudyOrigin(study).names(folder), "report.html"]
    return [*whole, *(f"pictures/{name}" for name in PICTURES),
            *(f"vtk/{name}" for name in file_names(study.name))]  # fmt: skip


def write_tables(result: ResultData, folder: Path, *, parquet: bool = False) -> Path:
    """``readings.csv``, ``extremes.csv``, ``heat_budget.csv``, ``heat_power.csv``, ``study.toml``, ``summary.json``,
    and ``result.npz``, from which the result can be made again.

    With slip also ``sliding.csv``: the contact over time. ``parquet``: the tables as Parquet files, too.
    """
    from tyrefem.simulation.stored_result import FILE, write_result

    if parquet:
        import pandas as pd

        from tyrefem.reports.parquet import write_parquet

    readings: dict[str, Any] = {f"{name} [degC]": values for name, values in result.reading_columns.items()}
    readings = {"time [s]": readings.pop("time_s [degC]"), **readings}
    readings["contained-air pressure [kPa]"] = result.gas_pressure / 1e3
    tables = {
        "readings.csv": readings,
        "extremes.csv": columns_of(result.extreme_rows),
        "heat_budget.csv": columns_of(result.heat_budget.rows),
        "heat_power.csv": result.heat_budget.columns,
    }
    if result.sliding is not None:
        tables["sliding.csv"] = {str(name): values for name, values in result.sliding.series.items()}
    for name, table in tables.items():
        write_csv(table, folder / name)
        if parquet:
            # Full digits, and the columns' names of the Python table.
            whole = pd.DataFrame(table)
            if table is readings:
                whole = result.readings.assign(**{"contained-air_pressure_Pa": result.gas_pressure})
            write_parquet(whole, (folder / name).with_suffix(".parquet"))
    write_result(result, folder / FILE)
    StudyOrigin(result.study).write(folder)
    return write_json(summary(result), folder / "summary.json")
