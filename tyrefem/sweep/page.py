"""A sweep as one self-contained HTML page: what it says first, then pictures, then every variant."""

from __future__ import annotations

import base64
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.output import atomic_path
from tyrefem.sweep.sweep import Sweep

if TYPE_CHECKING:
    import pandas as pd

#: Rows of the page's table; all are in sweep.csv.
ROWS = 500
#: Answers in the page's table.
COLUMNS = (
    "hottest_degC", "hottest_region", "contained-air_degC", "rolling_resistance_coefficient", "gradient_K_m", "mass_kg",
    "time_to_limit_s",
)  # fmt: skip


def write_page(found: Sweep, best: pd.DataFrame, summary: dict[str, Any], path: Path) -> Path:
    """Write the page."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    table = found.table
    certificate = found.certificate
    errors = {} if certificate is None else dict(certificate.errors)
    columns = [name for name in COLUMNS if name in table]
    headings = [one.heading for one in found.plan.varied] or [key for key in found.plan.keys if key in table]
    page = environment.get_template("page.html").render(
        title=found.plan.study.title,
        words=summary["words"][1:],
        pictures=[(words, base64.b64encode(png).decode("ascii")) for words, png in pictures(found, best)],
        headings=headings,
        columns=columns,
        errors=errors,
        rows=table.head(ROWS).to_dict("records"),
        total=len(table),
        front=set(best["variant"]) if len(best) else set(),
        failed=found.failed,
        certificate=certificate,
        versions=summary["versions"],
    )
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def pictures(found: Sweep, best: pd.DataFrame) -> Iterator[tuple[str, bytes]]:
    """(what it shows, PNG) of a sweep."""
    from tyrefem.plotting.style import png
    from tyrefem.sweep.pictures import curves, numeric, pareto, response_map

    table = found.table
    done = table[table["failure"] == ""]
    if len(done) < 2:
        return
    answers = [name for name in ("hottest_degC", "rolling_resistance_coefficient") if done[name].nunique() > 1]
    if "time_to_limit_s" in done and done["time_to_limit_s"].nunique() > 1:
        answers.append("time_to_limit_s")
    if len(best) and len(answers) >= 2:
        yield "Temperature against rolling resistance", png(pareto(found, best, answers[1], answers[0]))
    names = numeric(found)
    if len(names) >= 2:
        for x, y in itertools.islice(itertools.combinations(names, 2), 3):
            yield f"Highest temperature over {x} and {y}", png(response_map(found, x, y, "hottest_degC"))
    for answer in answers:
        for x in names[:4]:
            yield f"{answer} over {x}", png(curves(found, x, answer))
