"""Estimates of memory and time before work starts: an error if it does not fit, a warning if it is long.

All constants were measured with this code: processor time of one core (Xeon, 2.1 GHz class), one thread, peaks of
resident memory. Estimates are within a factor of two to three; docs/performance.md compares them with measured runs.
"""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

from tyrefem.errors import InputError
from tyrefem.estimates import memory

GIB = 2.0**30
#: s; longer work gives a warning.
LONG = 600.0
#: Smaller amounts of memory, bytes, are not checked.
SMALL = 64 * 2**20
#: Largest number of readings of a run: spreadsheets cannot open larger tables.
MOST_READINGS = 1_000_000

# Conduction: 22x5.5 8PR at mesh sizes 12 to 0.35 mm (767 to 248 000 unknowns), P2: 4.1 to 4.6 kB an unknown for the
# operators; six factors of 1.1 kB (banded, or sparse below 30 000 unknowns), growing by 0.2 kB with every doubling.
OPERATORS, FACTORS, FACTOR, GROWTH, WIDE = 4.4e3, 6, 1.1e3, 0.2e3, 2**15
#: Copies of the history in memory together: list, array, and input of the readings (measured 2.8).
COPIES = 3
# s: per step and unknown (1.4e-6 for the report's tyres, 4e-6 with tan delta over frequency), per factorisation and
# unknown^1.5, per reading and per reading and unknown (8 and 3 mm, 0.02 to 5 s), per written field and unknown.
STEP, FACTORISATION, READING, READ_UNKNOWN, FIELD = 2e-6, 3e-8, 3.5e-4, 8e-8, 1.5e-6
#: Steps of a phase at 0.01 K (41 to 138 in the shipped studies; cube root of the tolerance: ROS34PW2 is of order 3
#: with an error estimate of order 2, measured from 1 to 1e-7 K), and factorisations of a phase.
STEPS, STEPS_AT, FACTORISATIONS = 60.0, 0.01, 12.0
# Mechanics per node of nine-node elements: inflation and footprint of the radials (1500 to 9800 nodes): 38 to 45 kB,
# 1 ms (the truck, inflated in 4 load steps: 2 ms), a further load 0.2 ms; in large motion 0.16 to 0.47 MB, 6 to
# 12 ms, more where its load steps are many.
BODY, INFLATE, LOAD, LARGE_BODY, LARGE = 45e3, 2e-3, 2e-4, 0.47e6, 0.015
# s per node of rolling with friction (passenger, full section, 3500 nodes, 80 harmonics): compliances, and a state.
ROLLING_TYRE, ROLLING_STATE = 3e-3, 2e-3
#: Bytes per node that an inflated tyre keeps (nine pressures of the passenger), and the number of tyres kept.
KEPT, REMEMBERED = 25e3, 16
# A variant of a sweep with all its 43 answers in a table, joined from parts, and each changed number: bytes (4 000 to
# 80 000 variants of four numbers: 1.2 kB a variant; without the table 0.3 kB, on disk or packed).
VARIANT, CHANGE = 1.0e3, 100.0
#: s, a variant of a reduced model; number of full runs for training and certification.
REDUCED, TRAINING = 3e-3, 30
#: Bytes of memory per byte of a table (200 000 rows: 17 for temperatures, 40 for cases).
TEXT = 20.0
#: Number of steps for the rounding limit: 2e5 steps lose sqrt(2e5) units in the last place (measured: 75 after 6000).
ROUNDINGS = 450.0


class LongWorkWarning(UserWarning):
    """The next work takes long."""


@dataclass(frozen=True)
class Estimate:
    """Estimate of work: ``memory``, bytes at its peak, and ``time``, s on one core.

    >>> (Estimate(2 * GIB, 60.0) + Estimate(1 * GIB, 840.0)).words
    'about 3.0 GiB and 15 minutes'
    """

    memory: float = 0.0
    time: float = 0.0

    def __add__(self, other: Estimate) -> Estimate:
        return Estimate(self.memory + other.memory, self.time + other.time)

    @property
    def words(self) -> str:
        """Memory and time as text."""
        return f"about {gib(self.memory)} and {duration(self.time)}"


def gib(size: float) -> str:
    """Bytes as text.

    >>> gib(3.2e9), gib(1.5e14), gib(1e6)
    ('3.0 GiB', '140,000 GiB', '0.00093 GiB')
    """
    value = size / GIB
    if value >= 1000:
        return f"{float(f'{min(value, 1e300):.2g}'):,.0f} GiB" if value < 1e15 else f"{value:.1g} GiB"
    return f"{value:.2g} GiB" if value < 1 else f"{value:.1f} GiB"


def duration(seconds: float) -> str:
    """A time as text, with two digits.

    >>> duration(25), duration(1500), duration(7e4), duration(1e7)
    ('25 s', '25 minutes', '19 hours', '120 days')
    """
    for limit, size, unit in ((120.0, 1.0, "s"), (7200.0, 60.0, "minutes"), (172800.0, 3600.0, "hours")):
        if seconds < limit:
            return f"{float(f'{seconds / size:.2g}'):g} {unit}"
    return f"{float(f'{min(seconds, 1e300) / 86400:.2g}'):,.0f} days"


# -- checks and warnings ---------------------------------------------------------------------------------------------


def check_memory(needed: float, what: str, fits: Callable[[float], str] | str = "") -> None:
    """Raise an error for work that does not fit into the free memory.

    Parameters
    ----------
    needed : bytes. what : the number and its result, e.g. ``"0.3 mm makes 330,000 unknowns"``.
    fits : text with a value that would fit, or a function of the free bytes that returns it.

    Raises
    ------
    InputError : more than `tyrefem.estimates.memory.free_memory`.
    """
    if needed < SMALL:
        return
    free = memory.free_memory()
    if needed > free:
        raise_memory_error(needed, free, what, fits(free) if callable(fits) else fits)


def check_readings(span: float, every: float, field: str, most: int = MOST_READINGS) -> None:
    """Raise `InputError` if a span (s) has more readings of an interval (s) than a table may have.

    >>> check_readings(600.0, 5.0, "output.every")
    """
    if every > 0 and span / every <= most:
        return
    allowed = f"allowed: {_rounded_up(span / most):g} s or more, at most {most:,} readings of {span:g} s"
    made = f"{every:g} s makes {span / every:.3g} readings" if every > 0 else f"must be more than 0 s, not {every:g} s"
    raise InputError(f"{made}; {allowed}", field=field)


def raise_memory_error(needed: float, free: float, what: str, fits: str = "", workers: int = 1) -> NoReturn:
    """Raise the `InputError` of `check_memory`; ``free``: bytes for each of the ``workers``."""
    each = "" if workers == 1 else f" for each of {workers} workers"
    remedies = [fits] if fits else []
    remedies += ["fewer workers have more each"] if workers > 1 else []
    room = "".join(f"; {remedy}" for remedy in remedies)
    raise InputError(f"{what}; that takes about {gib(needed)} of memory, and {gib(free)} are free{each}{room}")


def warn_if_long(seconds: float, what: str, more: Callable[[], str] = str) -> None:
    """Warn of work that takes longer than `LONG`; the command line prints one line on stderr. ``more``: its end."""
    if seconds > LONG:
        warnings.warn(f"{what} will take about {duration(seconds)}{more()}", LongWorkWarning, stacklevel=3)


def smallest(fits: Callable[[float], bool], low: float, high: float, digits: int = 2) -> float | None:
    """The smallest number between low and high that fits, rounded up to some digits; None: no number fits.

    >>> smallest(lambda size: 1 / size**2 < 90, 0.01, 1.0)
    0.11
    """
    if not fits(high):
        return None
    for _ in range(12):
        middle = math.sqrt(low) * math.sqrt(high)
        low, high = (low, middle) if fits(middle) else (middle, high)
    return _rounded_up(high, digits)


def rounded_down(value: float, digits: int = 2) -> float:
    """A positive number rounded down to some digits.

    >>> rounded_down(1234567.0)
    1200000.0
    """
    if not value > 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return float(f"{math.floor(value / unit + 1e-9) * unit:.{digits}g}")


def _rounded_up(value: float, digits: int = 2) -> float:
    unit = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return float(f"{math.ceil(value / unit - 1e-9) * unit:.{digits}g}")


# -- estimates -------------------------------------------------------------------------------------------------------


def matrices(unknowns: float) -> float:
    """Bytes of operators and factors of a conduction problem."""
    doublings = max(math.log2(max(unknowns, 1.0) / WIDE), 0.0)
    return unknowns * (OPERATORS + FACTORS * (FACTOR + GROWTH * doublings))


def history(unknowns: float, times: float) -> float:
    """Bytes of the temperatures of a run at its output times."""
    return COPIES * 8.0 * unknowns * times


def steps(phases: int, tolerance: float) -> float:
    """Number of time steps of a drive with some phases, for a tolerance in K."""
    return STEPS * phases * (STEPS_AT / tolerance) ** (1 / 3)


def transient_run(unknowns: float, times: float, phases: int, tolerance: float, fields: int = 0) -> Estimate:
    """A transient run of a conduction problem: matrices, steps, readings, and written fields."""
    time = steps(phases, tolerance) * unknowns * STEP + FACTORISATIONS * phases * FACTORISATION * unknowns**1.5
    time += times * (READING + READ_UNKNOWN * unknowns) + fields * FIELD * unknowns
    return Estimate(matrices(unknowns) + history(unknowns, times), time)


def mechanics(nodes: float, inflations: int = 1, loads: int = 1, *, large: bool = False) -> Estimate:
    """Inflation and footprint by finite elements with ``nodes`` nodes; ``large``: in large motion."""
    kept = min(inflations, REMEMBERED) - 1
    body, load = (LARGE_BODY, LARGE) if large else (BODY, LOAD)
    return Estimate(nodes * (body + kept * KEPT), nodes * (inflations * INFLATE + loads * load))


def rolling(nodes: float, tyres: int, states: int) -> Estimate:
    """Rolling with friction beyond inflation and footprint: compliances of ``tyres``, and ``states`` of rolling."""
    return Estimate(0.0, nodes * (tyres * ROLLING_TYRE + states * ROLLING_STATE))


def contact(nodes: float, harmonics: float, angles: float, components: int = 2) -> float:
    """Bytes of a footprint's compliance: of tread nodes in every harmonic, and of all points of possible contact."""
    loaded = components * nodes
    return 8.0 * (2 * (harmonics + 1) * loaded**2 + 3 * (loaded * angles) ** 2)


def variants(count: int, numbers: int) -> float:
    """Bytes of the variants of a sweep with their answers."""
    return min(count, 10**15) * (VARIANT + CHANGE * numbers)


def smallest_tolerance(hottest: float) -> float:
    """Smallest possible error, K, of a time integration of temperatures up to ``hottest``, degC, in double precision.

    Every step rounds; the rounding errors of N steps add up to sqrt(N) units in the last place. At 1e-11 K a drive
    has about 1e5 steps.

    >>> f"{smallest_tolerance(100.0):.0e}"
    '1e-11'
    """
    return ROUNDINGS * sys.float_info.epsilon * max(abs(hottest), 100.0)
