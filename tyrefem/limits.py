"""Where a run left the range of its own assumptions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.phase_state import PhaseState
    from tyrefem.section import Section

#: Largest part of the tread at the crown that one contact may reach before the result warns (a judgement).
SHALLOW = 0.2


def deep_contacts(section: Section, phases: Iterable[PhaseState]) -> tuple[str, ...]:
    """One line for every phase in which one contact cools more of the tread than an averaged film stands for."""
    tread = float(section.thickness("tread", 0.0))
    return tuple(
        f"phase '{state.name}': one contact cools the tread {state.propagation_depth * 1e3:.2g} mm deep, "
        f"{100 * state.propagation_depth / tread:.0f} % of its thickness at the crown; a film averaged over "
        f"the revolution holds below {100 * SHALLOW:.0f} %"
        for state in phases
        if state.propagation_depth > SHALLOW * tread
    )
