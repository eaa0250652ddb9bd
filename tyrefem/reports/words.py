"""Text of numbers, times and places in a report, and lines of text on sliding."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from tyrefem.boundaries.friction_tables import IceRow, WoodRow, ice_distance
from tyrefem.output.device_names import is_device

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.strain_harmonics import LinearisationError
    from tyrefem.simulation.sliding_outcome import SlidingOutcome


def number(value: float, significant: int = 4) -> str:
    """Format a number with ``significant`` digits, without an exponent between 1e-4 and 1e6.

    >>> number(539335.4), number(0.00698786), number(-0.0), number(2.5e8), number(1786)
    ('539 335', '0.006988', '0', '2.5e8', '1786')
    """
    value = float(value)
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if size >= 7 or size < -4:
        mantissa, _, exponent = f"{value:.{significant - 1}e}".partition("e")
        return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"
    text = f"{value:.{max(significant - 1 - size, 0)}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return f"{float(text):,.0f}".replace(",", " ") if size >= 4 else text


#: Bytes of a name in the name of a file; file systems allow 255 for the whole.
LONGEST_NAME = 200


def file_stem(name: object, instead: str) -> str:
    """A name for a file: letters, digits, ``_``, ``.`` and ``-`` of it stay; ``instead`` where nothing is left.

    >>> file_stem("taxi/1", "run"), file_stem("...", "run"), file_stem("aux", "run")
    ('taxi-1', 'run', 'run-aux')
    """
    plain = re.sub(r"[^\w.-]+", "-", str(name)).strip("-.")
    plain = plain.encode()[:LONGEST_NAME].decode(errors="ignore").rstrip("-.")
    return f"{instead}-{plain}" if is_device(plain) else plain or instead


def unlike(stem: str, taken: set[str]) -> str:
    """The stem, or with a number where it is in ``taken`` in small or capital letters; it is taken from then on."""
    free, again = stem, 2
    while free.casefold() in taken:
        free, again = f"{stem}-{again}", again + 1
    taken.add(free.casefold())
    return free


def history_files(runs: Iterable[object]) -> list[str]:
    """Names of the pictures of runs: letters, digits, ``_``, ``.`` and ``-`` of the run's name stay.

    All are different, also where small and capital letters are the same, and short enough for a file system.

    >>> history_files(["taxi 1", "taxi/1", "A", "a"])
    ['histories-taxi-1.png', 'histories-taxi-1-2.png', 'histories-A.png', 'histories-a-2.png']
    """
    taken: set[str] = set()
    return [f"histories-{unlike(file_stem(run, 'run'), taken)}.png" for run in runs]


def seconds(value: float) -> str:
    """Format a time in s, and long times also in minutes or hours.

    >>> seconds(600.0), seconds(45.0), seconds(7200.0)
    ('600 s (10 min)', '45 s', '7200 s (2 h)')
    """
    text = f"{number(value)} s"
    if value >= 7200:
        return f"{text} ({number(value / 3600, 3)} h)"
    return f"{text} ({number(value / 60, 3)} min)" if value >= 300 else text


def motion_words(motion: str, error: LinearisationError | None = None) -> str:
    """A footprint's motion, and what linear strains leave out.

    >>> motion_words("large"), motion_words("linear")
    ('large', 'linear about the inflated tyre: a quick look, too stiff')
    """
    linear = motion == "linear"
    words = "linear about the inflated tyre: a quick look, too stiff" if linear else "large"
    if error is None:
        return words
    return (
        f"{words}; linear strains {'' if linear else 'would '}leave out {error.mean:.0%} of themselves on average, "
        f"{error.greatest:.0%} in the {error.region}"
    )


def phase_lines(outcome: SlidingOutcome) -> Iterator[str]:
    """One line per phase with slip: temperatures of exit edge and sliding surface, friction and its limit."""
    for phase in outcome.phases:
        limited = f", limited to {phase.friction_lowest:.2f} by decomposition" if phase.capped else ""
        locked = ", locked" if phase.locked else ""
        yield (
            f"  sliding             {phase.exit_edge_highest:7.1f} degC at the exit edge of the contact, "
            f"{phase.surface} {phase.mean_highest:.1f} degC; {phase.name}{locked}: up to "
            f"{phase.sliding_speed:.2f} m/s, friction {phase.friction:.2f}{limited}"
        )


def wood_lines(rows: tuple[WoodRow, ...]) -> Iterator[str]:
    """Lines of table 2: deviation of equations 3 and 4 from the observed rise; check of the printed prediction.

    >>> from tyrefem.boundaries.friction_names import wood_rows
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
    """Lines of table 3: equation 4 with one distance for all rows; equation 12 with the first row's pressure.

    >>> from tyrefem.boundaries.friction_names import ice_rows
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


def shortened(reason: str, most: int = 4) -> str:
    """A reason with at most ``most`` items of its list.

    >>> shortened("cannot distinguish: a; b; c; d", 2)
    'cannot distinguish: a; b; and 2 more'
    """
    parts = reason.split("; ")
    return "; ".join([*parts[:most], f"and {len(parts) - most} more"]) if len(parts) > most + 1 else reason
