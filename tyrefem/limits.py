"""Where a run left the range of its own assumptions."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.result import Result

#: Largest part of the tread at the crown that one contact may reach before the result warns (a judgement).
SHALLOW = 0.2


def warnings_of(result: Result) -> tuple[str, ...]:
    """One line each, for people: those of the study first."""
    tread = float(result.study.section.thickness("tread", 0.0))
    deep = tuple(
        f"phase '{state.name}': one contact cools the tread {state.propagation_depth * 1e3:.2g} mm deep, "
        f"{100 * state.propagation_depth / tread:.0f} % of its thickness at the crown; a film averaged over "
        f"the revolution holds below {100 * SHALLOW:.0f} %"
        for state in result.phases
        if state.propagation_depth > SHALLOW * tread
    )
    apart = () if result.feedback is None else result.feedback.warnings
    return (
        tuple(map(str, result.study.warnings))
        + apart
        + deep
        + (() if result.sliding is None else result.sliding.warnings)
    )
