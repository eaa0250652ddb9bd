"""Numbers of a verification case beside their references, with deviation and badge."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field
from html import escape
from pathlib import Path

#: What the references of a case are -> what its badge says of it.
KINDS = {
    "closed form": "an exact formula",
    "benchmark": "published values of a benchmark",
    "balance": "a law of conservation",
    "other formulation": "another model or code of the same physics",
    "report": "values printed in a report or paper",
    "measurement": "a measured tyre",
}


@dataclass(frozen=True)
class Row:
    """A computed number, its reference, and how far they may be apart."""

    quantity: str
    computed: float
    reference: float
    unit: str
    within: float

    @property
    def deviation(self) -> float:
        """Computed minus reference, in the row's unit."""
        return self.computed - self.reference

    @property
    def relative(self) -> float | None:
        """The deviation over the reference; None for a reference of zero."""
        return self.deviation / abs(self.reference) if self.reference else None


@dataclass
class ReferenceTable:
    """A case's results beside its references: every row is checked when it is added.

    ``kind`` is one of `KINDS`; ``source`` says where the references are from.
    """

    title: str
    kind: str
    source: str
    rows: list[Row] = field(default_factory=list)

    def __post_init__(self) -> None:
        assert self.kind in KINDS, f"kind is one of {', '.join(KINDS)}"

    def add(
        self, quantity: str, computed: float, reference: float, unit: str = "",
        *, within: float | None = None, percent: float | None = None,
    ) -> None:  # fmt: skip
        """Add a row, whose deviation must stay ``within`` so much of the unit, or ``percent`` of the reference."""
        assert (within is None) != (percent is None), "say 'within' or 'percent'"
        allowed = within if within is not None else abs(reference) * percent / 100  # type: ignore[operator]
        row = Row(quantity, float(computed), float(reference), unit, float(allowed))
        assert abs(row.deviation) <= row.within, f"{quantity}: {row.computed:.6g}, not {row.reference:.6g} {unit}"
        self.rows.append(row)

    def _repr_html_(self) -> str:
        self.keep()
        heading = "".join(f"<th>{name}</th>" for name in ("quantity", "tyrefem", "reference", "deviation", "allowed"))
        body = "".join(map(_row_in_html, self.rows))
        badge = f'<p class="case-badges">{kind_badge(self.kind)} {result_badge(self.rows)}</p>'
        table = table_in_html("case-table", heading, body)
        return badge + table + f'<p class="case-source">Reference: {escape(self.source)}</p>'

    def keep(self) -> None:
        """Write the case for the overview of all cases, where the site is being built."""
        folder, example = os.environ.get("TYREFEM_SITE_RESULTS"), os.environ.get("TYREFEM_SITE_EXAMPLE")
        if folder and example:
            Path(folder).mkdir(parents=True, exist_ok=True)
            Path(folder, f"{example}.json").write_text(json.dumps(asdict(self), indent=1), encoding="utf-8")


def table_in_html(kind: str, heading: str, body: str) -> str:
    """A table of the theme, with a scroll bar where the page is narrow."""
    rows = f"<thead><tr>{heading}</tr></thead><tbody>{body}</tbody>"
    return f'<div class="pst-scrollable-table-container"><table class="table {kind}">{rows}</table></div>'


def number(value: float) -> str:
    """Five figures, without an exponent where it reads well."""
    return f"{value:.5g}".replace("e-0", "e-").replace("e+0", "e")


def deviation_in_words(row: Row) -> str:
    """The deviation in the row's unit, and relative where that means something."""
    words = f"{row.deviation:+.2g}".replace("e-0", "e-").replace("e+0", "e")
    relative = row.relative
    share = "" if relative is None or row.unit in ("degC", "%", "") else f" ({100 * relative:+.2g} %)"
    return words + share


def _row_in_html(row: Row) -> str:
    cells = (
        number(row.computed), number(row.reference), deviation_in_words(row), f"± {row.within:.2g}",
    )  # fmt: skip
    unit = f" [{row.unit}]" if row.unit else ""
    numbers = "".join(f"<td>{escape(cell)}</td>" for cell in cells)
    return f"<tr><td>{escape(row.quantity)}{escape(unit)}</td>{numbers}</tr>"


def kind_badge(kind: str) -> str:
    """A badge that says what the reference is."""
    return f'<span class="case-badge case-kind" title="{KINDS[kind]}">{kind}</span>'


def result_badge(rows: list[Row], *, short: bool = False) -> str:
    """A badge that says that every row holds, and how near the nearest row is to what it may deviate."""
    used = max(abs(row.deviation) / row.within if row.within else 0.0 for row in rows)
    share = "" if short else f": at most {100 * used:.0f} % of the allowed deviation"
    words = f"passed {len(rows)}/{len(rows)}{share}"
    return f'<span class="case-badge case-passed">{words}</span>'
