"""How often the diagnosis is right: blind cases on the layout of studies/hidden-effect.

It has 8 histories, three runs and one that is held out.

    python benchmarks/blind.py --cases 200 --seed 1 --out results/blind
    python benchmarks/blind.py --cases 200 --seed 1 --truth structural --out results/blind-structural

Prints a table for people and, as its last line, one JSON object with the rates. Interrupted, it goes on where it was.
``--records`` names a file of finished cases (a JSON object a line): they are not run again, and new ones are added when
the program ends or is interrupted. Those behind docs/evidence/diagnosis.md are in benchmarks/records. ``--only`` runs
some cases again, by number, in place of their records; without a number it runs none.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import tyrefem as tf
from tyrefem.diagnose.blind.rates import run_blind, tag_of
from tyrefem.output import atomic_path
from tyrefem.reports.blind import save


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", default="hidden-effect")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("results/blind"))
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--truth", choices=("ordinary", "structural"), default="ordinary")
    parser.add_argument("--records", type=Path, help="File of finished cases, a JSON object a line.")
    parser.add_argument("--only", type=int, nargs="*", help="Numbers of the cases to run, again if they are recorded.")
    parser.add_argument("--reduced", choices=("auto", "never"), default="auto")
    given = parser.parse_args()
    began = time.perf_counter()
    rows = {} if given.records is None else recorded(given.records)
    finished = {number: row for number, row in rows.items() if number not in (given.only or ())}
    study, options = tf.study(given.study), {"reduced": given.reduced, "truth": given.truth}
    only = {} if given.only is None else {"only": given.only}
    try:
        result = run_blind(
            study, given.cases, given.seed, given.out, given.workers, **options, **only, finished=finished
        )
    finally:
        if given.records is not None:
            tag = tag_of(study, given.cases, given.seed, **options)
            record(given.records, rows, (given.out / "cases").glob(f"{tag}-*.json"))
    save(result, given.out)
    for line in result.words():
        print(line)
    print()
    for row in result.by_effect:
        print(f"{row['effect']:30s} {row['cases']:3d} cases, {row['identifiable']:3d} identifiable, "
              f"{row['named']:3d} named  {'; '.join(row['else'])}")  # fmt: skip
    for entry in result.failures:
        print(f"case {entry['number']} ({entry['kind']}; {', '.join(entry['hidden']) or 'nothing'}): {entry['fault']}; "
              f"{entry['verdict']} {', '.join(entry['named'])}; {entry['why']}")  # fmt: skip
    for row in result.reliability:
        print(f"stated {row['stated']:.3f}: {row['right']} of {row['of']} right")
    rates = {name: rate.to_dict() for name, rate in result.rates.items()}
    print(json.dumps({"cases": len(result.rows), "seconds": time.perf_counter() - began, "rates": rates}))


def recorded(path: Path) -> dict[int, dict[str, Any]]:
    """Rows of a file of finished cases, by number."""
    if not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return {row["number"]: row for row in rows}


def record(path: Path, rows: Mapping[int, dict[str, Any]], cases: Iterable[Path]) -> None:
    """Write known rows and those of the files of cases to a file of finished cases."""
    new = [json.loads(each.read_text(encoding="utf-8")) for each in cases]
    every = {**rows, **{row["number"]: row for row in new}}
    with atomic_path(path) as temporary:
        temporary.write_text("".join(json.dumps(every[number]) + "\n" for number in sorted(every)), encoding="utf-8")


if __name__ == "__main__":
    main()
