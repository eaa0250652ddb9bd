"""The law of the missing heat on the page of a diagnosis: one block of HTML."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from tyrefem.diagnose.law.terms import LOAD, PRESSURE, SPEED
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.law import law_words

if TYPE_CHECKING:
    from markupsafe import Markup

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.law.signatures import LawSignature

#: Number of effects in the table; mechanisms are all shown.
SHOWN = 8
_TEMPLATE = """<h2>The law of the missing heat</h2>
{% for sentence in sentences %}<p>{{ sentence }}.</p>
{% endfor %}
{% macro table(rows) %}<div class="scroll"><table>
<thead><tr><th class="word">what it would do over these runs</th><th>likeness</th><th>speed^</th><th>load^</th>
<th>pressure^</th><th class="word">like heat at</th></tr></thead>
<tbody>
{% for row in rows %}<tr><td class="word">{{ row.name }}</td><td>{{ row.likeness }}</td><td>{{ row.speed }}</td>
<td>{{ row.load }}</td><td>{{ row.pressure }}</td><td class="word">{{ row.place }}</td></tr>
{% endfor %}</tbody></table></div>{% endmacro %}
{% if rows %}{{ table(rows) }}
<p class="quiet">Likeness of an effect: share of the law's readings that it can make up, beside base numbers and
sensors. Likeness of a mechanism: its evidence below that of the best law. Exponents of an effect: those of the heat
that resembles it. Of an effect with variants the most alike is shown.</p>
{% endif %}
{% if others %}<details><summary>{{ others|length }} more effects and variants</summary>
{{ table(others) }}
</details>{% endif %}
{% for file in drafts %}<p>Draft effect: <code>{{ file }}</code>. Judge it by
<code>tyrefem diagnose STUDY --effects {{ folder }}</code>, best with runs that were not fitted.</p>
{% endfor %}
"""


def law_block(d: DiagnosisData) -> Markup:
    """The law in sentences, a table of effects and mechanisms, and the draft effect; empty without a law."""
    from jinja2 import Environment
    from markupsafe import Markup

    if d.law is None:
        return Markup("")
    template = Environment(autoescape=True).from_string(_TEMPLATE)
    drafts = [f"{EFFECTS}/{name}" for name in draft_effects(d)]
    first = leading_signatures(d.signatures)
    rows = [_row(row) for row in first]
    others = [_row(row) for row in d.signatures if row not in first]
    return Markup(template.render(sentences=law_words(d), rows=rows, others=others, drafts=drafts, folder=EFFECTS))


def leading_signatures(signatures: Sequence[LawSignature]) -> list[LawSignature]:
    """The effects most alike, each by its best variant, and all mechanisms; most alike first."""
    by_name: dict[str, LawSignature] = {}
    for row in signatures:
        if row.effect:
            by_name.setdefault(row.name.split(" (")[0], row)
    effects = list(by_name.values())[:SHOWN]
    return [row for row in signatures if not row.effect or row in effects]


def _row(row: LawSignature) -> dict[str, str]:
    exponents = {
        name: f"{row.exponents[name]:z.1f}" if name in row.exponents else "" for name in (SPEED, LOAD, PRESSURE)
    }
    others = [f"{name}^{value:.0f}" for name, value in row.exponents.items() if name not in exponents]
    place = f"s = {row.station * 1e3:.0f} mm, {row.where}" if math.isfinite(row.station) else ", ".join(others)
    likeness = f"{100 * row.likeness:.0f} %" if row.effect else (
        "equal" if row.below < 1 else f"{row.below:.0f} nats below"
    )  # fmt: skip
    return {"name": row.name, "likeness": likeness, "place": place, **exponents}
