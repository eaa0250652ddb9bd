"""Whether stated probabilities are right: fitted cases on the layout of studies/hidden-effect, kept over many sittings.

    python benchmarks/calibration.py --cases 400 --records benchmarks/records/calibration.jsonl

The cases of ``tyrefem isolability hidden-effect --calibrate 400 --fitted``. Finished ones are in ``--records``, a JSON
object a line; they are not run again, and new ones are added when the program ends or is interrupted. With a number of
cases below that of the records none is run. Writes calibration.json and calibration.png to ``--out``.
"""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import Any

import tyrefem as tf
from tyrefem.diagnose.blind.fitted_cases import fitted_cases, fitted_tag
from tyrefem.diagnose.blind.kept_cases import kept_cases
from tyrefem.diagnose.layout.calibration import calibrated
from tyrefem.diagnose.layout.planned_runs import planned_sensitivities
from tyrefem.output import atomic_path
from tyrefem.reports.calibration import save

#: Sets with a smaller probability are not recorded; they follow the others.
LEAST = 1e-9


def main() -> None:
    """Run what is left and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", default="hidden-effect")
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("results/calibration"))
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--records", type=Path, help="File of finished cases, a JSON object a line.")
    given = parser.parse_args()
    study = tf.study(given.study)
    folder, tag = given.out / "cases", fitted_tag(study, given.seed)
    if given.records is not None:
        restore(given.records, folder, tag)
    known = planned_sensitivities(study, workers=given.workers)
    try:
        cases = fitted_cases(study, known, given.cases, given.seed, folder, given.workers)
    finally:
        if given.records is not None:
            record(given.records, folder, tag)
    result = calibrated(study, known, given.cases, given.seed, fitted=cases)
    save(result, given.out)
    print("\n".join(result.words()))
    print(json.dumps({"cases": len(cases), "seed": given.seed}))


def restore(records: Path, folder: Path, tag: str) -> None:
    """Write recorded cases to a folder of finished ones, except those that it has."""
    known = kept_cases(folder, tag)
    folder.mkdir(parents=True, exist_ok=True)
    for line in records.read_text(encoding="utf-8").splitlines() if records.exists() else ():
        row: dict[str, Any] = json.loads(line)
        if (number := row.pop("number")) not in known:
            (folder / f"{tag}-{number:05d}.json").write_text(json.dumps(row), encoding="utf-8")


def record(records: Path, folder: Path, tag: str) -> None:
    """Write the finished cases of a folder to a file, in order of their numbers."""
    rows = sorted(kept_cases(folder, tag).items())
    with atomic_path(records) as temporary:
        lines = (json.dumps({"number": number, **short(row)}) + "\n" for number, row in rows)
        temporary.write_text("".join(lines), encoding="utf-8")


def short(row: dict[str, Any]) -> dict[str, Any]:
    """A row without the hundreds of sets of less than `LEAST`, probabilities to five digits."""
    return row | {"leading": [float(f"{share:.5g}") for share in row["leading"] if share >= LEAST]}


if __name__ == "__main__":
    main()
