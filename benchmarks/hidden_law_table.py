"""The tables of hidden laws in docs/evidence/missing-heat.md, from the records of `missing_heat_laws.py`.

    python benchmarks/hidden_law_table.py [--records results/missing-heat-laws]

The benchmark need not be finished. An exponent or a time is covered if it is within two standard deviations.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.diagnose.numbers import percent
from tyrefem.output import atomic_path

RECORDS, PAGE = Path("results/missing-heat-laws"), Path("docs/evidence/missing-heat.md")
TABLE = Path("docs/evidence/tables/diagnosis-laws.csv")
BEGIN, END = "<!-- hidden laws: written by benchmarks/hidden_law_table.py -->", "<!-- end of hidden laws -->"
#: Deflection of `hidden-effect` at its rated load and pressure, m: the Payne-like loss refers to it.
RATED_DEFLECTION = 0.027635
#: d ln(deflection)/d ln(variable) of `hidden-effect` at 13.9 kN and 6.5 bar: a law of load and pressure says the same.
OF_DEFLECTION: Mapping[str, float] = {"deflection": 1.0, "load": 0.91, "pressure": -0.80}


@dataclass(frozen=True)
class HiddenLaw:
    """A hidden law in words, its exponents, and the time of its switch (s; NaN without one)."""

    words: str
    exponents: Mapping[str, float]
    time: float = math.nan


LAWS: Mapping[str, HiddenLaw] = {
    "payne": HiddenLaw(
        "Payne-like loss: all hysteresis in proportion to x/(1 + x²), x = D/(0.4 D_rated); slope -0.77",
        {},
    ),
    "delamination": HiddenLaw(
        "delamination, carcass at s = 97 mm: speed × deflection², from 300 s on", {"speed": 1.0, "deflection": 2.0}, 300
    ),
    "evaporation": HiddenLaw("evaporation on the tread: -speed^0.8, until 400 s", {"speed": 0.8}, 400.0),
    "belt-edge": HiddenLaw("belt edge: speed^1.8 × load^0.7, 8 mm × 2.5 mm", {"speed": 1.8, "load": 0.7}),
}


@dataclass(frozen=True)
class Number:
    """An exponent, slope or time: the hidden value, and that of a diagnosis with its standard deviation."""

    name: str
    hidden: float
    mean: float
    sd: float

    @property
    def covered(self) -> bool:
        """Whether the hidden value is within two standard deviations."""
        return abs(self.mean - self.hidden) <= 2 * self.sd

    @property
    def words(self) -> str:
        """ "speed 1.83 ± 0.04"; "none" without a value."""
        if math.isnan(self.mean):
            return f"{self.name} none"
        digits = 0 if self.name == "time" else 2
        return f"{self.name} {self.mean:.{digits}f} ± {self.sd:.{digits}f}{' s' if self.name == 'time' else ''}"


def numbers_of_law(case: str, law: Mapping[str, Any]) -> list[Number]:
    """What the first diagnosis says of each hidden exponent and of the time."""
    stated = {entry["name"]: entry for entry in law["exponents"] if entry["in_law"]}
    values = {name: (entry["mean"], entry["sd"]) for name, entry in stated.items()}
    amplitude = law.get("amplitude_1"), law.get("amplitude_sd_1")
    reference = next((e["reference"] for e in law["exponents"] if e["name"] == "deflection"), math.nan)
    return _numbers(case, values, (law["time_s"], law["time_sd_s"]), amplitude, reference)


def numbers_of_draft(case: str, effect: Mapping[str, Any], law: Mapping[str, Any]) -> list[Number]:
    """The same by the second diagnosis, whose fit varies the draft's exponents; a switch keeps its time."""
    parameters = effect["parameters"]
    values = {
        name.removesuffix("_exponent"): (entry["value"], entry["sd"])
        for name, entry in parameters.items()
        if name.endswith("_exponent")
    }
    gain = parameters.get("gain", {"value": None, "sd": None})
    reference = next((e["reference"] for e in law["exponents"] if e["name"] == "deflection"), math.nan)
    return _numbers(case, values, (None, None), (gain["value"], gain["sd"]), reference)


def _numbers(
    case: str,
    values: Mapping[str, tuple[float, float]],
    time: tuple[float | None, float | None],
    gain: tuple[float | None, float | None],
    reference: float,
) -> list[Number]:
    hidden, nothing = LAWS[case], (math.nan, math.nan)
    numbers = [Number(name, value, *values.get(name, nothing)) for name, value in hidden.exponents.items()]
    if case == "payne":
        terms = [term for term in OF_DEFLECTION if term in values] or ["deflection"]
        numbers += [_slope(term, values.get(term, nothing), gain, reference) for term in terms]
    if math.isfinite(hidden.time) and time[0] is not None and time[1] is not None:
        numbers.append(Number("time", hidden.time, time[0], max(time[1], 1.0)))
    return numbers


def _slope(
    term: str, exponent: tuple[float, float], gain: tuple[float | None, float | None], reference: float
) -> Number:
    """d ln(loss)/d ln(term) at the reference: A p/(1 + A) of a share A (term/reference)^p, whatever the base value."""
    x = reference / (0.4 * RATED_DEFLECTION)
    hidden = (1 - x**2) / (1 + x**2) * OF_DEFLECTION[term]
    name = f"slope of the loss over {term}"
    if gain[0] is None or gain[1] is None or math.isnan(exponent[0]):
        return Number(name, hidden, math.nan, math.nan)
    (p, p_sd), A, A_sd = exponent, gain[0], gain[1]
    return Number(name, hidden, A * p / (1 + A), math.hypot(A / (1 + A) * p_sd, p / (1 + A) ** 2 * A_sd))


@dataclass(frozen=True)
class Row:
    """One case and seed: records of the first and, if there was a draft, of the second diagnosis."""

    case: str
    seed: int
    first: Mapping[str, Any]
    second: Mapping[str, Any] | None

    @property
    def law(self) -> Mapping[str, Any] | None:
        """The law of the missing heat, if it holds."""
        law = (self.first["missing_heat"] or {}).get("law")
        return law if law and law["holds"] else None

    @property
    def draft(self) -> Mapping[str, Any] | None:
        """The draft among the effects that the second diagnosis names."""
        effects = self.second["effects"] if self.second else []
        return next((effect for effect in effects if effect["name"].startswith("inferred-")), None)

    @property
    def of_law(self) -> list[Number]:
        """Numbers of the law."""
        return [] if self.law is None else numbers_of_law(self.case, self.law)

    @property
    def of_draft(self) -> list[Number]:
        """Numbers of the draft's fit."""
        return [] if self.draft is None or self.law is None else numbers_of_draft(self.case, self.draft, self.law)

    @property
    def wrong(self) -> list[str]:
        """Effects of the catalogue that either diagnosis names with at least 90 %."""
        named = [effect for record in (self.first, self.second) if record for effect in record["effects"]
                 if record["verdict"] in ("identified", "partly identified")]  # fmt: skip
        names = [effect["name"] for effect in named if effect["probability"] >= 0.9]
        return sorted({name for name in names if not name.startswith("inferred-")})

    def cells(self) -> dict[str, str]:
        """A row of the CSV table."""
        law, second = self.law, self.second
        gap = self.first["gap"]["before"]
        after = second["gap"]["after"] if second else {"rms_K": math.nan, "held_out_rms_K": math.nan}
        seconds = self.first["processor_s"] + (second["processor_s"] if second else 0.0)
        return {
            "hidden": self.case, "hidden law": LAWS[self.case].words, "seed": str(self.seed),
            "first verdict": self.first["verdict"],
            "law": law["sentences"][0] if law else "none",
            "law: hidden values": _list(f"{n.name} {n.hidden:.4g}" for n in self.of_law),
            "law: values": _list(n.words for n in self.of_law),
            "law: covered": _covered(self.of_law),
            "second verdict": second["verdict"] if second else "none",
            "draft named": f"{self.draft['probability']:.4f}" if self.draft else "no",
            "draft: values": _list(n.words for n in self.of_draft),
            "draft: covered": _covered(self.of_draft),
            "fitted rms before [K]": f"{gap['rms_K']:.2f}", "fitted rms after [K]": f"{after['rms_K']:.2f}",
            "held-out rms before [K]": f"{gap['held_out_rms_K']:.2f}",
            "held-out rms after [K]": f"{after['held_out_rms_K']:.2f}",
            "wrong names": _list(self.wrong) or "none", "processor time [s]": f"{seconds:.0f}",
        }  # fmt: skip

    def page_cells(self) -> list[str]:
        """A row of the page's table."""
        cells = self.cells()
        name = percent(self.draft["probability"]) if self.draft else "no"
        before_after = [f"{cells[f'{which} rms before [K]']} → {cells[f'{which} rms after [K]']}"
                        for which in ("fitted", "held-out")]  # fmt: skip
        marks = [f"{n.words}{'' if n.covered else ' (!)'}" for n in self.of_law]
        fitted = [f"{n.words}{'' if n.covered else ' (!)'}" for n in self.of_draft]
        return [self.case, str(self.seed), _list(marks) or f"none ({cells['first verdict']})",
                f"{cells['second verdict']}, {name}", _list(fitted) or "-", *before_after,
                cells["processor time [s]"]]  # fmt: skip


def _list(words: Any) -> str:
    return "; ".join(words)


def _covered(numbers: Sequence[Number]) -> str:
    return f"{sum(number.covered for number in numbers)} of {len(numbers)}"


def rows_of(records: Path) -> list[Row]:
    """The finished cases below a folder, in the order of `LAWS`."""
    rows = []
    for case in LAWS:
        for folder in sorted(records.glob(f"{case}-*"), key=lambda path: int(path.name.rpartition("-")[2])):
            files = [folder / f"{name}.json" for name in ("first", "second")]
            contents = [json.loads(file.read_text(encoding="utf-8")) if file.exists() else None for file in files]
            if contents[0] is not None:
                rows.append(Row(case, int(folder.name.rpartition("-")[2]), contents[0], contents[1]))
    return rows


def page_table(rows: Sequence[Row]) -> str:
    """The table of the page, with the hidden laws and a summary above it."""
    laws, drafts = [n for row in rows for n in row.of_law], [n for row in rows for n in row.of_draft]
    closed = sum(bool(row.draft) for row in rows)
    wrong = sorted({name for row in rows for name in row.wrong})
    words = [
        f"{len(rows)} cases. Named is the draft in {closed} of {len(rows)}; wrong names: {_list(wrong) or 'none'}. "
        f"Hidden exponents and times within two standard deviations: {_covered(laws)} of the laws, {_covered(drafts)} "
        "of the drafts' fits; (!) marks the others.",
        "",
        *(f"- {case}: {LAWS[case].words}" for case in dict.fromkeys(row.case for row in rows)),
        "",
        "| hidden | seed | law by the first diagnosis | second diagnosis, draft named with | fitted exponents "
        "| fitted runs [K] | held-out run [K] | processor time [s] |",
        "|---|---|---|---|---|---|---|---|",
        *("| " + " | ".join(row.page_cells()) + " |" for row in rows),
    ]
    return "\n".join(words)


def write(rows: Sequence[Row]) -> None:
    """The CSV table, and the table of the page."""
    cells = [row.cells() for row in rows]
    with atomic_path(TABLE) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(cells[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(cells)
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    with atomic_path(PAGE) as temporary:
        temporary.write_text(f"{before}{BEGIN}\n\n{page_table(rows)}\n\n{END}{after}", encoding="utf-8")


def main() -> None:
    """Write the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=Path, default=RECORDS)
    rows = rows_of(parser.parse_args().records)
    if not rows:
        raise SystemExit(f"no finished diagnosis in {RECORDS}: run benchmarks/missing_heat_laws.py first")
    write(rows)
    print(page_table(rows))


if __name__ == "__main__":
    main()
