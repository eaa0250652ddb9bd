"""The table of docs/evidence/plan.md on plans, from finished cases.

    python benchmarks/plan_table.py results/plan results/plan-four

Reads what ``benchmarks/plan.py`` wrote; the test need not be finished. Writes every case as CSV below
docs/evidence/tables and the table of the page, with 95 % intervals.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem.diagnose.blind.criteria import Rate
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED
from tyrefem.output import atomic_path

PAGE, TABLE = Path("docs/evidence/plan.md"), Path("docs/evidence/tables/diagnosis-plan-cases.csv")
BEGIN, END = "<!-- plans: written by benchmarks/plan_table.py -->", "<!-- end of plans -->"
#: Most further runs; runs that count where they do not give the name.
MOST, NEVER = 2, 3
HEADINGS = (
    "layout", "case", "hidden", "amplitude [sd]", "closest effect", "identifiable by all drives",
    "first verdict's best set", "its probability", "first planned drive", "by plan", "runs by plan", "at random",
    "runs at random",
)  # fmt: skip
Row = dict[str, Any]


def read(folder: Path) -> list[Row]:
    """First verdicts with their layouts; the confounded ones with their courses by plan and at random."""
    rows = []
    for file in sorted(folder.glob("cases-*.jsonl")):
        layout = file.stem.removeprefix("cases-").rpartition("-")[0]
        random = {row["number"]: row["random"] for row in lines(file.with_name(f"random-{file.name[6:]}"))}
        for row in lines(file):
            course = {"random": random[row["number"]]} if row["number"] in random else {}
            rows.append(row | course | {"layout": layout})
    return rows


def lines(file: Path) -> list[Row]:
    """Rows of a file of JSON lines; none without the file."""
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()] if file.is_file() else []


def runs(steps: Sequence[Row]) -> int:
    """Further runs until the right name; `NEVER` without it."""
    return next((number for number, step in enumerate(steps[:MOST], start=1) if step["right"]), NEVER)


def wrong(steps: Sequence[Row]) -> bool:
    """Whether a wrong name is given on the way."""
    return any(step["verdict"] == IDENTIFIED and not step["right"] for step in steps[:MOST])


def share(rows: Sequence[bool]) -> str:
    """ "19 of 21 (90 %, 71 to 97)"."""
    rate = Rate(sum(rows), len(rows))
    low, high = (100 * x for x in rate.interval)
    return f"{rate.right} of {rate.of} ({100 * rate.value:.0f} %, {low:.0f} to {high:.0f})" if rows else "no case"


def mean(values: Sequence[int]) -> str:
    """Mean with its 95 % interval by resampled cases (10 000 bootstrap samples)."""
    if not values:
        return "no case"
    data = np.array(values, dtype=float)
    means = data[np.random.default_rng(0).integers(len(data), size=(10_000, len(data)))].mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return f"{data.mean():.2f} ({low:.2f} to {high:.2f})"


def rates(rows: Sequence[Row]) -> dict[str, tuple[str, str]]:
    """Rates by plan, and at random over the cases that have random runs."""
    courses = [[row[name] for row in rows if name in row] for name in ("plan", "random")]
    table = {
        f"right name after {words}": tuple(share([runs(steps) <= most for steps in course]) for course in courses)
        for most, words in ((1, "one further run"), (2, "two further runs"))
    }
    table["wrong name on the way"] = tuple(share([wrong(steps) for steps in course]) for course in courses)
    means = tuple(mean([runs(steps) for steps in course]) for course in courses)
    table[f"mean further runs to the right name (none after {MOST}: {NEVER})"] = means
    saved = mean([runs(row["random"]) - runs(row["plan"]) for row in rows if "random" in row])
    table["runs that the plan saves, a case"] = (saved, "")
    return {name: (cells[0], cells[1]) for name, cells in table.items()}


def summary(rows: Sequence[Row]) -> str:
    """The table of the page: all cases, those that all drives together identify, by layout, and the failures."""
    confounded = [row for row in rows if row["verdict"] == CONFOUNDED]
    groups = {
        "all": confounded,
        "identifiable by all nine drives": [row for row in confounded if row["identifiable"]],
        "layout four": [row for row in confounded if row["layout"] == "four"],
        "the other layouts": [row for row in confounded if row["layout"] != "four"],
    }
    first = Counter(row["verdict"] for row in rows)
    text = [f"{len(rows)} first verdicts: {', '.join(f'{count} {verdict}' for verdict, count in first.most_common())}."]
    text += ["", "| cases | | by plan | at random |", "|---|---|---|---|"]
    for name, group in groups.items():
        label = f"{name} ({len(group)})"
        for what, (planned, random) in rates(group).items():
            text.append(f"| {label} | {what} | {planned} | {random} |")
            label = ""
    hidden = Counter(row["hidden"][0] for row in confounded)
    text += ["", f"Hidden effects: {', '.join(f'{name} {count}' for name, count in hidden.most_common())}."]
    failures = [row for row in confounded if runs(row["plan"]) == NEVER or wrong(row["plan"])]
    for row in failures:
        steps = "; then ".join(
            f"{step['best']} ({step['verdict']}, {100 * step['probability']:.0f} %)" for step in row["plan"]
        )
        seen = "" if row["identifiable"] else ", not identifiable by all nine drives together"
        text += ["", f"- {row['layout']}, case {row['number']}: {row['hidden'][0]}{seen}: {steps}."]
    return "\n".join(text)


def cells(row: Row) -> list[Any]:
    """A case as a row of the CSV."""
    first = max(row["sets"].items(), key=lambda entry: entry[1])
    amplitude = " ".join(f"{value:.2f}" for value in row["amplitude"])
    courses = []
    for name in ("plan", "random"):
        if name not in row:
            courses += ["not run", ""]
            continue
        steps = row[name][:MOST]
        count = runs(steps)
        courses += [
            "; ".join(f"{step['best']} ({step['verdict']})" for step in steps),
            "none" if count == NEVER else count,
        ]
    head = [row["layout"], row["number"], row["hidden"][0], amplitude, row.get("rival", ""), row["identifiable"]]
    return [*head, first[0], f"{first[1]:.2f}", row["plan"][0]["drive"], *courses]


def main() -> None:
    """Write the CSV and the page's table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    rows = [row for folder in parser.parse_args().folders for row in read(folder)]
    kept = [cells(row) for row in rows if row["verdict"] == CONFOUNDED]
    with atomic_path(TABLE) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEADINGS, *kept])
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    after = rest.split(END)[1]
    with atomic_path(PAGE) as temporary:
        temporary.write_text(f"{before}{BEGIN}\n\n{summary(rows)}\n\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
