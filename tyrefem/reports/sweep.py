"""A sweep as one self-contained HTML page: answers in words, then pictures and tables.

Files that an earlier sweep wrote into the folder are removed; a user's files and finished variants stay.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import counted
from tyrefem.output import atomic_path, jsonable
from tyrefem.output.folder import BOOKKEEPING

# Registers the pictures of tornado, indices, optimum and envelope.
from tyrefem.reports import sweep_answer_figures as sweep_answer_figures
from tyrefem.reports.explore_link import explore_link
from tyrefem.reports.figures.style import png
from tyrefem.reports.sweep_figures import figures
from tyrefem.reports.template import rendered
from tyrefem.reports.words import file_stem, number, unlike
from tyrefem.sweep.pareto import DEFAULT_AIMS
from tyrefem.sweep.sweep import Sweep
from tyrefem.variants.answer_units import difference_unit, name_of, shown

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.sweep.design import DesignData
    from tyrefem.sweep.part import DesignPart

#: File name of the page.
PAGE = "sweep.html"


#: Largest number of rows of the page's tables, and of failures; the files have all.
ROWS, ROWS_OF_VARIANTS = 60, 500
#: Significant digits of the tables of answers.
DIGITS = 4


#: Answers in the page's table of variants.
COLUMNS = (
    "hottest_degC", "hottest_region", "contained-air_degC", "rolling_resistance_coefficient", "gradient_K_m", "mass_kg",
    "time_to_limit_s",
)  # fmt: skip


def write_page(design: DesignData, summary: Mapping[str, Any], folder: Path) -> list[str]:
    """Write ``sweep.html``, and the pictures as PNG files in ``pictures``; return the names of these files."""
    swept = design.swept or (design.optimum.swept if design.optimum is not None else None)
    taken: set[str] = set()
    parts = [_part(part, folder, taken) for part in design.parts]
    page = rendered(
        "sweep.html",
        title=summary["title"],
        study=design.study,
        how="" if design.swept is None else summary["words"][1].strip(),
        interrupted=design.interrupted,
        numbers=_numbers(design),
        parts=parts,
        variants=None if swept is None else _variants(design, swept),
        failed=design.failed,
        assumed=_assumed(design),
        versions=summary["versions"],
        explored=explore_link(design.study, folder / PAGE),
    )
    with atomic_path(folder / PAGE) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return [PAGE, *(picture["file"] for part in parts for picture in part["pictures"])]


def _part(part: DesignPart, folder: Path, taken: set[str]) -> dict[str, Any]:
    """Heading, words, pictures and table of an answer; ``taken``: names of pictures so far."""
    drawn = []
    for name, caption, picture in figures(part):
        content = png(picture)
        file = f"pictures/{unlike(file_stem(name, part.name), taken)}.png"
        with atomic_path(folder / file) as temporary:
            temporary.write_bytes(content)
        drawn.append({"file": file, "caption": caption, "data": base64.b64encode(content).decode("ascii")})
    # The variants have a separate table at the end.
    table = None if part.name in ("sweep", "optimum", "pareto") else _cells(part.table)
    return {"name": part.name, "heading": part.heading, "words": part.words, "pictures": drawn, "table": table}


def _cells(table: pd.DataFrame) -> dict[str, Any]:
    table = table.drop(columns=[name for name in ("failure",) if name in table and not table[name].any()])
    rows = [[cell(value, DIGITS) for value in row] for row in table.head(ROWS).itertuples(index=False)]
    return {"columns": list(table.columns), "rows": rows, "total": len(table)}


def cell(value: Any, digits: int = 5) -> str:
    """Text of a table's cell: short numbers, whole numbers in full, empty for NaN."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float):
        return "" if value != value else str(value) if isinstance(value, int) else number(value, digits)
    return "" if value is None else str(value)


def _variants(design: DesignData, swept: Sweep) -> dict[str, Any]:
    whole, certificate = swept.overview(tuple(_aims(design))), swept.certificate
    errors = {} if certificate is None else dict(certificate.errors)
    best = set(design.pareto["variant"]) if design.swept is not None and "hottest_degC" in whole else set()
    if design.swept is None and design.optimum is not None and design.optimum.best is not None:
        best = {swept.plan.names[design.optimum.best]}
    places = chosen_rows(whole, best, [name for name in _aims(design) if name in whole])
    table = swept.rows(swept.packed.numbers[places])
    wanted = dict.fromkeys((*design.card.answers, *design.card.limits, *COLUMNS))
    columns = [name for name in wanted if name in table]
    headings = [heading for heading in swept.plan.headings if heading in table]
    rows = []
    for row in table.to_dict("records"):
        cells = [row["variant"], *(cell(row[name]) for name in headings)]
        for name in columns:
            error = errors.get(name) if row["by"] == "reduced" else None
            stated = f" ± {error:.1g}" if error is not None else ""
            cells.append(cell(row[name]) + stated if cell(row[name]) else "")
        kind = "front" if row["variant"] in best else "" if row["feasible"] else "out"
        rows.append({"cells": [*cells, row["by"] or "failed"], "kind": kind})
    return {
        "columns": ["variant", *headings, *columns, "by"],
        "rows": rows,
        "total": len(whole),
        "certificate": certificate,
        "file": "sweep" if design.swept is not None else "optimum",
    }


def _aims(design: DesignData) -> dict[str, None]:
    """Answers whose extreme variants are of interest."""
    return dict.fromkeys((*design.card.answers, *design.card.limits, *design.card.pareto, *DEFAULT_AIMS))


def chosen_rows(table: pd.DataFrame, best: Collection[str], answers: Sequence[str]) -> NDArray[np.intp]:
    """Places of the page's rows, increasing: all if they are few, else the best, then those with extreme answers.

    At most `ROWS_OF_VARIANTS`, half of which for the best; of each answer as many with low as with high values.
    """
    if len(table) <= ROWS_OF_VARIANTS:
        return np.arange(len(table), dtype=np.intp)
    front = np.flatnonzero(table["variant"].isin(list(best)))
    chosen = set(front[np.linspace(0, len(front) - 1, min(len(front), ROWS_OF_VARIANTS // 2)).astype(int)].tolist())
    each = (ROWS_OF_VARIANTS - len(chosen)) // (2 * max(len(answers), 1))
    for answer in answers:
        values = table[answer].to_numpy(dtype=float)
        known = np.flatnonzero(~np.isnan(values))
        order = known[np.argsort(values[known], kind="stable")]
        chosen |= {*order[:each].tolist(), *order[max(len(order) - each, 0) :].tolist()}
    return np.array(sorted(chosen), dtype=np.intp)


def _numbers(design: DesignData) -> list[dict[str, str]]:
    """Main results: label, value and note."""
    cards: list[dict[str, str]] = []
    if design.optimum is not None and design.optimum.best is not None:
        answer = design.optimum.answer
        label = f"{'smallest' if design.optimum.card.minimise else 'largest'} {name_of(answer)}"
        value = shown(answer, design.optimum.full[answer])
        cards.append({"label": label, "value": value, "note": design.optimum.where})
    if design.swept is not None and design.swept.outcomes:
        from tyrefem.sweep.responses import extreme, finished, judged

        table = finished(design.swept, design.card.answers)
        for answer in judged(design.swept, design.card.answers)[:3]:
            low, high = (float(extreme(table, answer, least=least)[answer]) for least in (True, False))
            certificate = design.swept.certificate
            error = None if certificate is None else certificate.errors.get(answer)
            note = f"over {counted(len(table), 'variant')}"
            note += "" if error is None else f"; each ± {shown(answer, error, 1)}"
            first = f"{low:.4g}" if high == high else shown(answer, low)
            cards.append({"label": name_of(answer), "value": f"{first} – {shown(answer, high)}", "note": note})
    if design.tornado is not None:
        for answer in design.tornado.answers[:2]:
            rows = design.tornado.of(answer).dropna(subset=["range"])
            if len(rows):
                value = f"± {rows.iloc[0]['range'] / 2:.2g} {difference_unit(answer)}".strip()
                cards.append(
                    {"label": f"{name_of(answer)}: widest tolerance", "value": value, "note": rows.iloc[0]["number"]}
                )
    if design.envelope is not None:
        rated = design.envelope.rating.dropna(subset=["tkph"]).head(2).to_dict("records")
        cards += [
            {
                "label": "safe load × speed",
                "value": f"{row['tkph']:.0f} t km/h",
                "note": f"at {row['pressure']}, over all loads of the sweep",
            }
            for row in rated
        ]
    return cards


def _assumed(design: DesignData) -> list[str]:
    """Sentences on the assumptions of the sweep."""
    sentences = [
        "Every variant is the study with some values changed: the assumptions of its cards and laws hold here too.",
        f"Time integration to {design.study.tolerance:g} K; mesh of {design.study.card.mesh.size * 1e3:g} mm.",
    ]
    for name, keys in ({} if design.swept is None else design.swept.plan.sampling.get("linked", {})).items():
        sentences.append(f"Linked: {name} sets {'; '.join(f'{key}: {what}' for key, what in keys.items())}.")
    if design.indices is not None:
        sentences.append("Sobol indices: every number is uniform in its range and independent of the others.")
    if design.tornado is not None:
        sentences.append(
            "Tornado: each number changes by one standard deviation unless given. Together: numbers are independent "
            "and the answer is linear in them."
        )
    if design.envelope is not None:
        sentences.append(
            "Envelope: the answer must rise with speed. Earth-mover tyres are rated by load times speed in t km/h. "
            "Here it holds for this model, ambient temperature and duration: it is no maker's rating."
        )
    if design.optimum is not None and not design.optimum.exhaustive:
        sentences.append("Optimum: a random search with a seed; a better variant may exist.")
    return sentences


#: Key of `summary.json` that lists the other files; files of other names are never removed.
FILES = "files"
LIKE_OURS = re.compile(r"(pictures/)?[^/\\]+\.(csv|parquet|png|html)")


#: Keys that are not results.
NOT_RESULTS = (*BOOKKEEPING, "words")


#: Keys that identify a question.
QUESTION = ("study", "asked", "input", "versions")


def earlier(folder: Path) -> dict[str, Any]:
    """The summary in a folder; empty if there is none, or if it is not of a sweep."""
    try:
        data = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) and isinstance(data.get(FILES), list) else {}


def still_valid(
    folder: Path, before: Mapping[str, Any], summary: Mapping[str, Any], written: Sequence[str]
) -> list[str]:
    """The files of an earlier sweep, of the summary ``before``, that are not out of date.

    For the same question, all files stay until it is finished. Page and pictures stay if they are not drawn again
    and no result has changed.
    """
    listed = [name for name in before.get(FILES, []) if isinstance(name, str) and LIKE_OURS.fullmatch(name)]
    left = [name for name in listed if name not in written and (folder / name).is_file()]
    now = json.loads(json.dumps(jsonable(summary)))
    same = all(before.get(key) == now[key] for key in QUESTION)
    return [
        name
        for name in left
        if same and (not now["complete"] or (name.endswith((".png", ".html")) and _results(before) == _results(now)))
    ]


def _results(summary: Mapping[str, Any]) -> dict[str, Any]:
    """A summary without the entries that differ each time, such as run times."""
    results = {key: value for key, value in summary.items() if key not in NOT_RESULTS}
    sample = {key: value for key, value in results.pop("sample", {}).items() if key not in ("seconds", "taken_up")}
    return results | {"sample": sample}
