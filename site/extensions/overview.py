"""``.. case-overview::``: every verification case with its source, its largest deviation and its badge."""

from __future__ import annotations

import json
import os
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from reference_table import Row, deviation_in_words, kind_badge, result_badge, table_in_html
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


class CaseOverview(SphinxDirective):
    """A table of the cases that ran, in the order of the book."""

    def run(self) -> list[nodes.Node]:
        """The table as HTML; without results, a sentence."""
        folder = Path(os.environ.get("TYREFEM_SITE_RESULTS", ""))
        book = Path(self.env.srcdir) / Path(self.env.docname).parent
        lines = []
        for page in sorted(book.rglob("*.rst")):
            kept = folder / f"{page.stem}.json"
            if kept.is_file():
                self.env.note_dependency(str(kept))
                place = page.relative_to(book).with_suffix(".html").as_posix()
                lines.append(_line(place, json.loads(kept.read_text(encoding="utf-8"))))
        if not lines:
            return [nodes.paragraph(text="The cases were not run for this build.")]
        heading = "".join(f"<th>{name}</th>" for name in ("case", "reference", "deviation", "result"))
        return [nodes.raw("", table_in_html("case-overview", heading, "".join(lines)), format="html")]


def _line(place: str, case: dict[str, Any]) -> str:
    rows = [Row(**row) for row in case["rows"]]
    worst = max(rows, key=lambda row: abs(row.deviation) / row.within if row.within else 0.0)
    unit = f" {worst.unit}" if worst.unit else ""
    cells = (
        f'<a href="{place}">{escape(case["title"])}</a>',
        f"{kind_badge(case['kind'])}<br>{escape(case['source'])}",
        f"{escape(worst.quantity)}: <strong>{escape(deviation_in_words(worst))}{escape(unit)}</strong>",
        result_badge(rows, short=True),
    )
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive."""
    app.add_directive("case-overview", CaseOverview)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
