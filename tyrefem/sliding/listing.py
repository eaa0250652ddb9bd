"""Sliding as lines of text: Roberts' tables, measured beside predicted, and the phases of a run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from tyrefem.sliding.tables import IceRow, WoodRow, ice_distance

if TYPE_CHECKING:
    from tyrefem.sliding.outcome import SlidingOutcome


def phase_lines(outcome: SlidingOutcome) -> Iterator[str]:
    """One line per phase with slip of a run: mean tread and exit edge, friction and where it was limited."""
    for phase in outcome.phases:
        limited = f", limited to {phase.friction_lowest:.2f} by decomposition" if phase.capped else ""
        locked = ", locked" if phase.locked else ""
        yield (
            f"  sliding             {phase.exit_edge_highest:7.1f} degC at the exit edge of the contact, mean tread "
            f"{phase.mean_highest:.1f} degC; {phase.name}{locked}: up to {phase.sliding_speed:.2f} m/s, friction "
            f"{phase.friction:.2f}{limited}"
        )


def wood_lines(rows: tuple[WoodRow, ...]) -> Iterator[str]:
    """Table 2: deviation of equations 3 and 4 from the observed rise, and whether the printed prediction follows.

    >>> from tyrefem.sliding import wood_rows
    >>> sum("does NOT follow" in line for line in wood_lines(wood_rows()))
    2
    """
    yield "Rubber on wood, table 2: rise behind the pad, equations 3 and 4"
    yield f"{'row':14}{'observed K':>14}{'predicted K':>13}{'deviation K':>13}{'%':>7}{'printed K':>11}  printed"
    for row in rows:
        seen = f"{row.observed:g} ± {row.uncertainty:g}"
        verdict = "follows" if row.follows else f"does NOT follow ({row.printed / row.predicted - 1:+.0%})"
        yield (
            f"{row.name:14}{seen:>14}{row.predicted:13.2f}{row.deviation:+13.2f}"
            f"{100 * row.deviation / row.observed:+7.0f}{row.printed:11g}  {verdict}"
        )


def ice_lines(rows: tuple[IceRow, ...]) -> Iterator[str]:
    """Table 3: equation 4 at one distance for all rows, and equation 12 at the pressure that the first row needs.

    >>> from tyrefem.sliding import ice_rows
    >>> print(next(ice_lines(ice_rows())))
    Rubber on ice, table 3: rise at the exit edge from the measured one by equation 4
    """
    distance, pressure = ice_distance(rows), rows[0].needed_pressure
    yield "Rubber on ice, table 3: rise at the exit edge from the measured one by equation 4"
    yield f"distance behind the pad, inferred from the corrections: {distance * 1e3:.0f} mm"
    yield (
        f"{'row':8}{'measured K':>12}{'corrected K':>13}{'equation 4 K':>14}{'deviation K':>13}{'%':>6}"
        f"{'same load K':>13}{'needs kPa':>11}"
    )
    for row in rows:
        off = row.predicted(distance) - row.corrected
        note = "  above the melting point" if row.corrected > row.to_melting else ""
        yield (
            f"{row.name:8}{row.measured:12g}{row.corrected:13g}{row.predicted(distance):14.2f}{off:+13.2f}"
            f"{100 * off / row.corrected:+6.1f}{row.rise_at(pressure):13.1f}{row.needed_pressure / 1e3:11.0f}{note}"
        )
    yield "same load: equation 12 with the pressure of the first row; needs: pressure for the corrected rise"
