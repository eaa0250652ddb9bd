"""The tables and the picture of docs/evidence/diagnosis.md, from finished blind cases.

    python benchmarks/blind_tables.py --ordinary results/blind/cases --structural results/blind-structural/cases

Reads the case files of ``tyrefem blind`` or the records of ``benchmarks/blind.py``; the test need not be finished.
Writes the rates and all failures as CSV below docs/evidence/tables, the picture, and the page's table of goals.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tyrefem.diagnose.blind.blind_case import DATA_MODELS
from tyrefem.diagnose.blind.criteria import Rate
from tyrefem.diagnose.blind.rates import Blind
from tyrefem.output import atomic_path
from tyrefem.reports.blind import picture
from tyrefem.reports.figures.style import png

PAGE, TABLES, PICTURES = Path("docs/evidence/diagnosis.md"), Path("docs/evidence/tables"), Path("docs/pictures")
BEGIN, END = "<!-- {name} cases: written by benchmarks/blind_tables.py -->", "<!-- end of {name} cases -->"
#: Headings of the failures.
FAILURE = (
    "case",
    "kind",
    "hidden",
    "amplitude [prior sd]",
    "strain energy",
    "fault",
    "verdict",
    "named",
    "leading",
    "why",
)


def main() -> None:
    """Write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in DATA_MODELS:
        parser.add_argument(f"--{name}", type=Path, help="Folder with case files, or a file of records.")
    parser.add_argument("--study", default="hidden-effect")
    parser.add_argument("--seed", type=int, default=1)
    given = vars(parser.parse_args())
    for name in DATA_MODELS:
        if given[name] is not None:
            blind = Blind(given["study"], given["seed"], finished(given[name]), data_model=name)
            write(blind)
            print("\n".join(blind.words()))


def finished(place: Path) -> tuple[dict[str, Any], ...]:
    """The cases in a folder or in a file of records, in order of their numbers."""
    if place.is_dir():
        rows = [json.loads(path.read_text(encoding="utf-8")) for path in place.glob("*.json")]
    else:
        rows = [json.loads(line) for line in place.read_text(encoding="utf-8").splitlines()]
    return tuple(sorted(rows, key=lambda row: row["number"]))


def write(blind: Blind) -> None:
    """Rates, failures and picture of one model of the data, and its table of goals in the page."""
    name = blind.data_model
    table(TABLES / f"diagnosis-blind-{name}.csv", RATE, [rate_row(*item) for item in blind.rates.items() if item[1].of])
    failed = [failure_row(each) for each in blind.failures] or [["none", *"-" * (len(FAILURE) - 1)]]
    table(TABLES / f"diagnosis-blind-{name}-failures.csv", FAILURE, failed)
    with atomic_path(PICTURES / f"blind-{name}.png") as temporary:
        temporary.write_bytes(png(picture(blind)))
    page = PAGE.read_text(encoding="utf-8")
    begin, end = BEGIN.format(name=name), END.format(name=name)
    before, _, rest = page.partition(begin)
    _, _, after = rest.partition(end)
    with atomic_path(PAGE) as temporary:
        temporary.write_text(f"{before}{begin}\n\n{goals(blind)}\n\n{end}{after}", encoding="utf-8")


#: Headings of the rates.
RATE = ("question", "right", "of", "rate [%]", "95 % interval low [%]", "95 % interval high [%]", "wanted [%]")


def rate_row(name: str, rate: Rate) -> list[str]:
    """A row of rates."""
    low, high = rate.interval
    wanted = "" if rate.goal is None else f"{'at most ' if rate.at_most else ''}{100 * rate.goal:g}"
    return [name, str(rate.right), str(rate.of), *(f"{100 * x:.1f}" for x in (rate.value, low, high)), wanted]


def failure_row(entry: dict[str, Any]) -> list[str]:
    """A row of failures."""
    amplitudes = ", ".join(f"{value:.2g}" for value in entry["amplitude"].values())
    leading = "; ".join(f"{key} ({100 * share:.3g} %)" for key, share in entry["leading"])
    model = entry.get("other_model")
    energy = "" if model is None else model["strain_law"] or f"modes {100 * model['strain_modes_rms']:.0f} % rms"
    named, hidden = ", ".join(entry["named"]), ", ".join(entry["hidden"]) or "nothing"
    case = str(entry["number"]), entry["kind"], hidden, amplitudes, energy
    return [*case, entry["fault"], entry["verdict"], named, leading, entry["why"]]


def goals(blind: Blind) -> str:
    """The rates that have a goal, and those of identifiable effects, as a table of the page."""
    counts = {kind: sum(row["kind"] == kind for row in blind.rows) for kind in ("one", "two", "none", "outside")}
    words = (
        f"{len(blind.rows)} cases, seed {blind.seed}: {counts['one']} with one hidden effect, {counts['two']} with "
        f"two, {counts['none']} with nothing hidden, {counts['outside']} with a cause outside the catalogue."
    )
    lines = [words, "", "| | of | rate | wanted |", "|---|---|---|---|"]
    for name, rate in blind.rates.items():
        if rate.of and (rate.goal is not None or name.startswith("identifiable")):
            low, high = (100 * x for x in rate.interval)
            share = f"{100 * rate.value:.0f} % ({low:.0f} to {high:.0f})"
            lines.append(
                f"| {name} | {rate.right} of {rate.of} | {share} | {'' if rate.goal is None else rate.wanted} |"
            )
    return "\n".join(lines)


def table(path: Path, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Write a table completely or not at all."""
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([headings, *rows])


if __name__ == "__main__":
    main()
