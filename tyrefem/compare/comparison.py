"""The result of a comparison: deviations by run, sensor and phase, residuals, and a summary of one line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from tyrefem.brief import Brief, counted
from tyrefem.compare.history import ALL, SensorHistory
from tyrefem.compare.uncertainty import COLUMNS, row
from tyrefem.output import jsonable

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.compare.reduced_inputs import ReducedInputCertificate
    from tyrefem.inputs.uncertain_numbers import UncertainNumber


#: Columns of `ComparisonData.inputs`.
INPUTS = ("run", "sensor", "phase", "key", "relative_sd", "sd", "change_K", "regions")


@dataclass(frozen=True, eq=False)
class ComparisonData(Brief):
    """Deviations of a study from measurements.

    Parameters
    ----------
    study : the study's name.
    table : one row per run, sensor and phase (and phase "all"): ``n, bias_K, rms_K, largest_K`` at ``at_s``,
        the uncertainties ``u_num_K, u_input_K, u_data_K, u_val_K`` of the mean and ``u_reading_K`` of single
        readings, ``beyond`` and ``verdict``.
    residuals : one row per reading: ``run, time_s, sensor, phase, measured_degC, computed_degC, error_K`` and
        ``u_val_K``, the standard validation uncertainty of that reading.
    inputs : one row per run, sensor, phase and uncertain input ``key``: ``relative_sd``, ``sd`` as text, the
        ``regions`` in which the input changes (a number of a card changes in all regions with this card) and
        ``change_K``, the change of the mean when the input is one standard deviation higher.
    curves : run -> computed readings at the saved times (``time_s``, degC).
    notes : sentences on omitted data and uncertainties; those beginning with "ERROR" also stand in the summary.
    k : coverage factor. reduced : certificate of the reduced model for changed inputs; None: full runs only.
    plugins : the user's own effects and laws in the study, as in a ``summary.json``.
    """

    study: str
    table: pd.DataFrame
    residuals: pd.DataFrame
    inputs: pd.DataFrame
    curves: Mapping[str, pd.DataFrame]
    notes: tuple[str, ...] = ()
    k: float = 2.0
    reduced: ReducedInputCertificate | None = None
    plugins: tuple[Mapping[str, Any], ...] = ()

    def _title(self) -> str:
        return f"of {self.study}"

    def _facts(self) -> Mapping[str, Any]:
        runs = list(dict.fromkeys(self.residuals["run"]))
        worst = [f"{name} {value:.2f} K" for name, value in self.by_sensor.items()]
        all_phases = self.table[self.table["phase"] == ALL]
        return {
            "runs": runs,
            "readings": f"{len(self.residuals):,} of {counted(len(self.by_sensor), 'sensor')}",
            "computed - measured": f"{self.bias_K:+.2f} K on average, {self.rms_K:.2f} K rms",
            "rms by sensor": worst,
            "beyond uncertainty": f"{int(all_phases['beyond'].sum())} of {len(all_phases)} sensor histories "
            f"(k = {self.k:g})",
            "uncertain inputs": f"{self.inputs['key'].nunique()}",
            "notes": f"{len(self.notes)}",
        }

    @property
    def bias_K(self) -> float:
        """Mean deviation over all readings."""
        return float(self.residuals["error_K"].mean())

    @property
    def rms_K(self) -> float:
        """Root mean square deviation over all readings."""
        return _rms(self.residuals)

    @cached_property
    def by_sensor(self) -> pd.Series:
        """Root mean square deviation (K) of each sensor over all runs, worst first."""
        groups = self.residuals.groupby("sensor", sort=False)["error_K"]
        squares = groups.agg(lambda errors: math.sqrt(float((errors**2).mean())))
        return squares.sort_values(ascending=False, kind="stable")

    @property
    def has_phases(self) -> bool:
        """Whether any run has readings in more than one phase of its drive."""
        phases = self.table[self.table["phase"] != ALL].groupby("run")["phase"].nunique()
        return bool((phases > 1).any())

    @cached_property
    def by_input(self) -> pd.DataFrame:
        """Change (K) of each sensor's mean with each uncertain input, rms over the runs, largest change first."""
        all_phases = self.inputs[self.inputs["phase"] == ALL]
        squares = all_phases.assign(square=all_phases["change_K"] ** 2)
        changes = squares.pivot_table(index="key", columns="sensor", values="square", sort=False) ** 0.5
        strongest = (changes**2).sum(axis="columns").sort_values(ascending=False, kind="stable").index
        return changes.loc[strongest]

    def part(self, *, hold_out: bool) -> pd.DataFrame:
        """The residuals of the held-out runs, or of the other runs."""
        marked = self.table.loc[self.table["hold_out"] == hold_out, "run"].unique()
        return self.residuals[self.residuals["run"].isin(marked)]

    @property
    def summary(self) -> str:
        """One line: overall deviation, worst sensor, and number of histories beyond the uncertainty."""
        runs, sensors = self.residuals["run"].nunique(), self.residuals["sensor"].nunique()
        count = f"{counted(runs, 'run')}, {counted(sensors, 'sensor')}, {counted(len(self.residuals), 'reading')}"
        overall = f"computed - measured {self.bias_K:+.2f} K on average, {self.rms_K:.2f} K rms"
        fitted, held = self.part(hold_out=False), self.part(hold_out=True)
        if len(held):
            parts = [f"held out {held['error_K'].mean():+.2f}, {_rms(held):.2f} K rms"]
            if len(fitted):
                parts.insert(0, f"fitted {fitted['error_K'].mean():+.2f}, {_rms(fitted):.2f} K rms")
            overall += f" ({'; '.join(parts)})"
        all_phases = self.table["phase"] == ALL
        beyond = self.table["beyond"]
        judged = (
            f"beyond validation uncertainty (k = {self.k:g}): {int((beyond & all_phases).sum())} of "
            f"{int(all_phases.sum())} sensor histories"
        )
        if self.has_phases:
            judged += f", {int((beyond & ~all_phases).sum())} of {int((~all_phases).sum())} sensor phases"
        worst = f"worst sensor {self.by_sensor.index[0]}: {self.by_sensor.iloc[0]:.2f} K rms"
        errors = "".join(f"{note}. " for note in self.notes if note.startswith("ERROR"))
        return f"{errors}{self.study}: {count}: {overall}; {worst}; {judged}."

    def to_dict(self) -> dict[str, Any]:
        """The comparison without single readings as plain data for JSON; NaN becomes null."""
        parts = {
            name: {"bias_K": float(part["error_K"].mean()), "rms_K": _rms(part), "n": len(part)}
            for name, part in (
                ("overall", self.residuals),
                ("fitted", self.part(hold_out=False)),
                ("held_out", self.part(hold_out=True)),
            )
            if len(part)
        }
        data = {
            "study": self.study,
            "summary": self.summary,
            "notes": list(self.notes),
            "k": self.k,
            "reduced": None if self.reduced is None else vars(self.reduced),
            **parts,
            "rms_by_sensor_K": {str(name): float(value) for name, value in self.by_sensor.items()},
            "rows": self.table.to_dict(orient="records"),
            "inputs": self.inputs.to_dict(orient="records"),
            "plugins": list(self.plugins),
        }
        plain: dict[str, Any] = jsonable(data)
        return plain


def comparison_of(
    study: str,
    histories: Sequence[SensorHistory],
    *,
    curves: Mapping[str, pd.DataFrame],
    relative_sd: Mapping[str, float],
    numbers: Mapping[str, UncertainNumber] | None = None,
    notes: tuple[str, ...] = (),
    k: float = 2.0,
    reduced: ReducedInputCertificate | None = None,
) -> ComparisonData:
    """The comparison of measured and computed histories; ``numbers``: the uncertain inputs by name."""
    import pandas as pd

    rows, inputs = [], []
    places = {key: ", ".join(number.regions) for key, number in (numbers or {}).items()}
    spreads = {key: f"±{100 * sd:.3g} %" for key, sd in relative_sd.items()}
    spreads |= {key: number.deviation for key, number in (numbers or {}).items()}
    for history in histories:
        for phase, mask in history.stretches():
            values, changes = row(history, phase, mask, k)
            rows.append(values)
            inputs += [
                (history.run, history.sensor, phase, key, relative_sd[key], spreads[key], change, places.get(key, ""))
                for key, change in changes.items()
            ]
    residuals = pd.concat(
        [
            pd.DataFrame(
                {
                    "run": history.run,
                    "time_s": history.times,
                    "sensor": history.sensor,
                    "phase": history.phases,
                    "measured_degC": history.measured,
                    "computed_degC": history.computed,
                    "error_K": history.error,
                    "u_val_K": history.reading_uncertainty,
                }
            )
            for history in histories
        ],
        ignore_index=True,
    )
    return ComparisonData(
        study=study,
        table=pd.DataFrame(rows, columns=list(COLUMNS)),
        residuals=residuals,
        inputs=pd.DataFrame(inputs, columns=list(INPUTS)),
        curves=dict(curves),
        notes=notes,
        k=k,
        reduced=reduced,
    )


def _rms(residuals: pd.DataFrame) -> float:
    return math.sqrt(float((residuals["error_K"] ** 2).mean()))
