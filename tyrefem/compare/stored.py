"""A comparison read from its folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.compare.comparison import INPUTS, ComparisonData
from tyrefem.compare.reduced_inputs import ReducedInputCertificate
from tyrefem.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

#: Deviations by run, sensor and phase; all readings; computed readings at the saved times; all but readings.
TABLE, RESIDUALS, CURVES, RECORD = "comparison.csv", "residuals.csv", "curves.csv", "comparison.json"


def curves_table(comparison: ComparisonData) -> pd.DataFrame:
    """Computed readings of all runs: ``run, time_s``, then a column per sensor, degC."""
    import pandas as pd

    tables = [curve.assign(run=name) for name, curve in comparison.curves.items()]
    table = pd.concat(tables, ignore_index=True)
    return table[["run", *(column for column in table if column != "run")]]


def read_comparison(folder: Path) -> ComparisonData:
    """The comparison of a folder that `tyrefem compare` has written.

    Raises
    ------
    InputError : a file is damaged.
    """
    import pandas as pd

    try:
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        table, residuals, curves = (
            pd.read_csv(
                folder / name, dtype={"run": str, "sensor": str, "phase": str}, keep_default_na=False, na_values=[""]
            )
            for name in (TABLE, RESIDUALS, CURVES)
        )
        return ComparisonData(
            study=record["study"],
            table=table,
            residuals=residuals,
            inputs=pd.DataFrame(record["inputs"], columns=list(INPUTS)),
            curves={
                str(name): curve.drop(columns="run").dropna(axis="columns", how="all").reset_index(drop=True)
                for name, curve in curves.groupby("run", sort=False)
            },
            notes=tuple(record["notes"]),
            k=float(record["k"]),
            reduced=None if record["reduced"] is None else ReducedInputCertificate(**record["reduced"]),
            plugins=tuple(record["plugins"]),
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"is damaged: run the command again ({error!s:.60})", file=folder) from None
