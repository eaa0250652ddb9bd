"""Sliding in a report: the headline and one row per phase with slip."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.report.words import number

if TYPE_CHECKING:
    from tyrefem.result import Result


def sliding_card(result: Result) -> list[dict[str, str]]:
    """The hottest contact; nothing for a run without slip."""
    if result.sliding is None:
        return []
    phase = result.sliding.hottest
    limited = f", limited to {number(phase.friction_lowest, 2)} by decomposition" if phase.capped else ""
    return [
        {
            "label": "Sliding contact, exit edge",
            "value": f"{phase.exit_edge_highest:.1f} °C",
            "note": f"mean tread {phase.mean_highest:.1f} °C; phase {phase.name}, friction "
            f"{number(phase.friction, 2)}{limited}",
        }
    ]


def sliding_rows(result: Result) -> list[list[str]]:
    """One row per phase with slip, as the template's heads say."""
    if result.sliding is None:
        return []
    found = result.sliding.phases
    beside = {p.name: "–" if p.half_space_highest is None else f"{p.half_space_highest:.1f}" for p in found}
    return [
        [
            phase.name + (" (locked)" if phase.locked else ""), f"{phase.sliding_speed:.2f}",
            number(phase.pressure / 1e3), number(phase.friction, 3),
            f"{number(phase.friction_lowest, 3)}, decomposition" if phase.capped else "not limited",
            number(phase.friction_work / 1e3), number(phase.tread_heat / 1e3), f"{phase.tread_start:.1f}",
            f"{phase.tread_highest:.1f}", beside[phase.name], f"{phase.exit_edge_highest:.1f}",
        ]
        for phase in found
    ]  # fmt: skip
