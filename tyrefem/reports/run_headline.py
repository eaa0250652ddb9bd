"""Main results of a run at the head of its report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.geometry.place_names import place
from tyrefem.reports.run_files import summary
from tyrefem.reports.words import number, seconds

if TYPE_CHECKING:
    from tyrefem.simulation.phases import PhaseState
    from tyrefem.simulation.result import ResultData


def headline(result: ResultData) -> list[dict[str, str]]:
    """Main results: label, value and note."""
    values = summary(result)
    hot, resistance, air = values["hottest"], values["rolling_resistance"], values["contained_air"]
    budget = result.heat_budget
    cards = [
        {
            "label": "Hottest point",
            "value": f"{hot['temperature_degC']:.1f} °C",
            "note": f"{hot['region']}, {place(result.study.section, hot['s_m'], hot['depth_m'], hot['region'])}; "
            f"after {seconds(hot['time_s'])}",
        }
    ]
    if resistance["force_N"] > 0:
        cards.append(
            {
                "label": "Rolling resistance",
                "value": f"{number(resistance['force_N'], 3)} N",
                "note": f"coefficient {number(resistance['coefficient'], 3)}; cold "
                f"{number(resistance['cold_force_N'], 3)} N, {number(resistance['cold_coefficient'], 3)}"
                f"{_at_end_of(result)}",
            }
        )
    cards.append(
        {
            "label": "Contained air at the end",
            "value": f"{air['temperature_degC']:.1f} °C",
            "note": f"{number(air['gauge_pressure_Pa'] / 1e3)} kPa gauge, "
            f"{number(result.gas_pressure[0] / 1e3)} kPa at the start",
        }
    )
    cards.append(
        {
            "label": "Heat generated",
            "value": f"{number(budget.total('generated') / 1e3)} kJ",
            "note": f"{_sliding_note(result)}stored {number(budget.total('stored') / 1e3)} kJ, "
            f"lost {number(budget.total('lost') / 1e3)} kJ; "
            f"{'' if budget.empty else 'the budget '}{budget.closing.replace('-', '−')}",
        }
    )
    cards += sliding_card(result)
    loaded = max((p for p in result.phases if p.start < result.times[-1]), key=lambda p: p.deflection, default=None)
    if loaded is not None and loaded.deflection > 0:
        several = f"; phase {loaded.name}" if len(result.phases) > 1 else ""
        cards.append(
            {
                "label": "Deflection",
                "value": f"{loaded.deflection * 1e3:.1f} mm",
                "note": f"{_feedback_note(result)}footprint {loaded.footprint_length * 1e3:.0f} mm, {_area(loaded)}"
                f"{100 * loaded.road_fraction:.1f} % of a "
                f"revolution on the road{several}",
            }
        )
    return cards


def _area(phase: PhaseState) -> str:
    return "" if phase.footprint_area is None else f"{phase.footprint_area * 1e4:.0f} cm² in contact, "


def _feedback_note(result: ResultData) -> str:
    """Text on the feedback of temperature; empty without feedback."""
    return "" if result.feedback is None else f"{result.feedback.words}; "


def _sliding_note(result: ResultData) -> str:
    return "" if result.sliding is None else f"sliding {number(result.heat_budget.total('sliding') / 1e3)} kJ; "


def _at_end_of(result: ResultData) -> str:
    """Time and phase of the rolling resistance, if there are several phases."""
    i = result.rolling_reading
    if i is None or len(result.phases) < 2:
        return ""
    name = next(phase.name for phase in result.phases if result.times[i] <= phase.end + 1e-6)
    return f"; after {seconds(result.times[i])}, phase {name}"


def sliding_card(result: ResultData) -> list[dict[str, str]]:
    """Card on the hottest contact; empty for a run without slip."""
    if result.sliding is None:
        return []
    phase = result.sliding.hottest
    limited = f", limited to {number(phase.friction_lowest, 2)} by decomposition" if phase.capped else ""
    return [
        {
            "label": "Sliding contact, exit edge",
            "value": f"{phase.exit_edge_highest:.1f} °C",
            "note": f"{phase.surface} {phase.mean_highest:.1f} °C; phase {phase.name}, friction "
            f"{number(phase.friction, 2)}{limited}",
        }
    ]
