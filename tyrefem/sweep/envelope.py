"""The safe operating envelope: the largest speed below a limit, over load and pressure.

The speed at which an answer reaches its limit comes from false position, safeguarded by bisection.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Unpack

from tyrefem.errors import InputError
from tyrefem.inputs.changes import scaled, value_at
from tyrefem.inputs.study import StudyData
from tyrefem.quantity import parse
from tyrefem.sweep.evaluation import Evaluator
from tyrefem.sweep.part import InSentences
from tyrefem.sweep.question import SweepQuestion
from tyrefem.variants.answer_units import name_of, shown
from tyrefem.variants.answers import check_answer, check_sensor_names
from tyrefem.variants.card import EnvelopeCard, SweepCard
from tyrefem.variants.execution import Execution, ExecutionOptions
from tyrefem.variants.outcomes import Failed, Outcome
from tyrefem.variants.plan import Plan, check_changes
from tyrefem.variants.varied import Varied

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.reduced.surrogate import SurrogateCertificate

#: Default loads, as shares of the study's load.
SHARES = (0.5, 0.75, 1.0, 1.25)


def checked_pairs(study: StudyData, card: EnvelopeCard) -> list[tuple[str, str]]:
    """Pairs of load and pressure of an envelope, as written; the study accepts each of them.

    Raises
    ------
    InputError : as in `envelope`.
    """
    check_sensor_names(study)
    _check_phases(study)
    try:
        check_answer(card.answer, study)
    except InputError as error:
        raise error.within(field="envelope.answer") from None
    speed_range(card)
    loads = card.loads or tuple(_shares(study))
    pressures = card.pressures or (str(_given(study, "pressure")),)
    for field, unit, values in (("loads", "N", loads), ("pressures", "Pa", pressures)):
        if len({_parsed(value, unit, field) for value in values}) < len(values):
            raise InputError("a value is given twice", field=f"envelope.{field}")
    pairs = [(load, pressure) for load in loads for pressure in pressures]
    check_changes(study, [("", operating_point(pair, card.fastest)) for pair in pairs])
    return pairs


def _check_phases(study: StudyData) -> None:
    """Raise `InputError` for a phase with a speed, load or pressure of its own, which an envelope would not change."""
    for number, phase in enumerate(study.data["drive"].get("phases", ())):
        for name in ("speed", "load", "deflection", "pressure"):
            if name in phase:
                label = phase.get("name", number)
                raise InputError(
                    f"an envelope has one speed, load and pressure, but the phase '{label}' has a {name} of its own:"
                    " take a study of one phase",
                    field=f"envelope: drive.phases.{label}.{name}",
                )


def speed_range(card: EnvelopeCard) -> tuple[float, float]:
    """Slowest and fastest speed searched, m/s."""
    low, high = (_parsed(text, "m/s", name) for name, text in (("slowest", card.slowest), ("fastest", card.fastest)))
    if not 0 < low < high:
        raise InputError(
            f"must be positive and below 'fastest'; '{card.slowest}' to '{card.fastest}' is no range of speeds",
            field="envelope.slowest",
        )
    return low, high


def _given(study: StudyData, name: str) -> Any:
    try:
        return value_at(study.data, f"drive.{name}", study.folder)
    except InputError as error:
        raise InputError(f"the study has no single {name}; give a list", field=f"envelope.{name}s") from error


def _shares(study: StudyData) -> list[str]:
    load = _given(study, "load")
    try:
        return [scaled(load, share, significant=4) for share in SHARES]
    except InputError as error:
        raise InputError(
            f"the study has no single load: {error.message}; give a list", field="envelope.loads"
        ) from None


def _parsed(text: str, unit: str, field: str) -> float:
    try:
        return parse(text, unit)
    except InputError as error:
        raise error.within(field=f"envelope.{field}") from None


def operating_point(pair: tuple[str, str], speed: str) -> dict[str, str]:
    """Changes of the study for a pair (load, pressure) and a speed."""
    return {"drive.load": pair[0], "drive.pressure": pair[1], "drive.speed": speed}


#: The search ends at this share of the range of speeds, or when the answer is this close to the limit (relative).
FINE = 1e-3


class SpeedSearch:
    """Search for the speed at which an answer reaches the limit."""

    def __init__(self, low: float, high: float, limit: float) -> None:
        self.low, self.high, self.limit, self.fine = low, high, limit, FINE * (high - low)
        self.at_low = self.at_high = math.nan
        self.failure, self.value, self._speed = "", math.nan, math.nan
        self.settled = self.bracketed = False
        self._kept = 0

    @property
    def next(self) -> float:
        """The next speed to evaluate, m/s."""
        if math.isnan(self.at_low):
            return self.low
        if math.isnan(self.at_high):
            return self.high
        a, b = self.at_low - self.limit, self.at_high - self.limit
        middle = self.low - a * (self.high - self.low) / (b - a)
        margin = 0.02 * (self.high - self.low)
        return min(max(middle, self.low + margin), self.high - margin)

    @property
    def speed(self) -> float:
        """The largest speed below the limit, m/s; NaN: none."""
        return self._speed

    def record(self, outcome: Outcome, answer: str) -> None:
        """Use the outcome at the speed `next`."""
        speed = self.next
        if isinstance(outcome, Failed) or answer not in outcome.answers:
            reason = outcome.reason if isinstance(outcome, Failed) else f"no answer '{answer}'"
            self.failure, self.settled, self._speed = reason, True, math.nan
            return
        value = float(outcome.answers[answer])
        if math.isnan(value):
            self.failure, self.settled, self._speed = f"no number for '{answer}'", True, math.nan
            return
        if math.isnan(self.at_low):
            self.at_low = self.value = value
            self.settled = value >= self.limit
            self._speed = math.nan if self.settled else self.low
        elif math.isnan(self.at_high):
            self.at_high = value
            if value < self.limit:
                self.settled, self.value, self._speed = True, value, self.high
        elif value < self.limit:
            self.low, self.at_low, self.value, self._speed = speed, value, value, speed
            # Illinois rule: if an end stays twice, its distance to the limit is halved.
            self.at_high = self.limit + (self.at_high - self.limit) / 2 if self._kept > 0 else self.at_high
            self._kept = max(self._kept, 0) + 1
        else:
            self.high, self.at_high = speed, value
            self.at_low = self.limit + (self.at_low - self.limit) / 2 if self._kept < 0 else self.at_low
            self._kept = min(self._kept, 0) - 1
        if not self.settled and not math.isnan(self.at_high):
            self.bracketed = True
            close = self.high - self.low < self.fine or abs(self.value - self.limit) < FINE * abs(self.limit)
            self.settled = close


#: Rounds of the search at most.
ROUNDS = 14


#: Expected runs per load and pressure, to decide whether to train a reduced model.
EXPECTED = 7


@dataclass(frozen=True, eq=False, repr=False)
class Envelope(InSentences):
    """The largest safe speeds of a tyre.

    Parameters
    ----------
    study : the study. card : the question. runs : number of runs. certificate : of the reduced model, if it was used.
    table : a row per load and pressure: both as written and in SI, ``speed_m_s`` (NaN: above the limit at all speeds),
        ``at_limit`` (False: below the limit even at the highest speed), ``settled`` (False: the search ended after
        `ROUNDS`, and a larger speed may be safe), the answer there, ``tkph`` = load x speed in t km/h, ``by``,
        ``error_K``, ``failure``.
    """

    study: StudyData
    card: EnvelopeCard
    table: pd.DataFrame
    runs: int
    certificate: SurrogateCertificate | None = None
    why_full: str = ""

    name = "envelope"
    heading = "Safe operating envelope"

    @property
    def rating(self) -> pd.DataFrame:
        """Per pressure: load x speed, t km/h, that is safe at every load (similar to a TKPH rating).

        It is the smallest product over the loads. NaN: at some load no speed is safe.
        """
        groups = self.table.groupby("pressure", sort=False)
        return groups["tkph"].min().where(groups["speed_m_s"].count() == groups.size()).rename("tkph").reset_index()

    @property
    def failed(self) -> dict[str, str]:
        """Load and pressure whose search failed -> reason."""
        rows = self.table.to_dict("records")
        return {f"{row['load']} at {row['pressure']}": row["failure"] for row in rows if row["failure"]}

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        answer, end = self.card.answer, self.study.card.drive.end
        kept = f"stays below {shown(answer, self.card.below)} in a drive of {end:g} s"
        sentences = [f"The {name_of(answer)} {kept} up to these speeds:"]
        for pressure, rows in self.table.groupby("pressure", sort=False):
            sentences.append(f"at {pressure}: {', '.join(map(_speed_words, rows.to_dict('records')))}.")
        safe = self.rating.dropna(subset=["tkph"]).to_dict("records")
        rated = [f"{row['tkph']:.0f} t km/h at {row['pressure']}" for row in safe]
        if rated:
            sentences.append(f"Load times speed that is safe at all of these loads: {', '.join(rated)}.")
        s = "" if self.runs == 1 else "s"
        by = f"{self.runs} full run{s}"
        if self.certificate is not None:
            by = f"{self.runs} variant{s} by a reduced model, error of temperatures {self.certificate.error:.2g} K"
        sentences.append(f"Computed by {by}.")
        return sentences

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {
            "asked": self.card.model_dump(),
            "rows": self.table.to_dict("records"),
            "rating_tkph": self.rating.to_dict("records"),
            "runs": self.runs,
            "why_full_runs": self.why_full,
            "words": self.words,
        }


def _speed_words(row: Mapping[Any, Any]) -> str:
    if row["failure"]:
        return f"(failed) with {row['load']}"
    if math.isnan(row["speed_m_s"]):
        return f"no speed with {row['load']}"
    beyond = " and more" if not row["at_limit"] else "" if row["settled"] else " or more (not settled)"
    return f"{row['speed_m_s'] * 3.6:.0f} km/h{beyond} with {row['load']}"


def envelope(
    study: StudyData, card: EnvelopeCard, execution: Execution | None = None, **options: Unpack[ExecutionOptions]
) -> Envelope:
    """The largest speed at which an answer stays below a limit, for every load and pressure.

    The answer must rise with speed. Each round runs a speed for every pair that is not settled, by false position with
    the Illinois rule, safeguarded by bisection. execution, options : as in `tyrefem.sweep.sweep.sweep`.

    Raises
    ------
    InputError : the speeds are no range, the answer is unknown, a phase of the drive has its own speed, load or
        pressure, or the study refuses a load or pressure.
    """
    import pandas as pd

    low, high = speed_range(card)
    pairs = checked_pairs(study, card)
    sizes = [(parse(load, "N"), parse(pressure, "Pa")) for load, pressure in pairs]
    searches = [SpeedSearch(low, high, card.below) for _ in pairs]
    plan = Plan(study, _box(sizes, low, high), (), (), {}, None, {"sample": "envelope"})
    execution = (execution or Execution()).given(options)
    by: list[str] = [""] * len(pairs)
    with Evaluator(plan, execution) as evaluate:
        evaluate.train(EXPECTED * len(pairs))
        for _ in range(ROUNDS):
            waiting = [n for n, search in enumerate(searches) if not search.settled]
            execution.report_progress("envelope", len(searches) - len(waiting), len(searches))
            if not waiting:
                break
            outcomes = evaluate([operating_point(pairs[n], f"{searches[n].next:.6g} m/s") for n in waiting])
            for n, outcome in zip(waiting, outcomes, strict=True):
                searches[n].record(outcome, card.answer)
                by[n] = "" if isinstance(outcome, Failed) else outcome.by
    error = {"reduced": evaluate.certificate.error if evaluate.certificate else math.nan, "full": 0.0}
    rows = [
        {
            "load": load,
            "pressure": pressure,
            "load_N": newton,
            "pressure_Pa": pascal,
            "speed_m_s": search.speed,
            "speed_km_h": search.speed * 3.6,
            "at_limit": search.bracketed,
            "settled": search.settled,
            card.answer: search.value,
            "tkph": newton / 9806.65 * search.speed * 3.6,
            "by": answered_by,
            "error_K": error.get(answered_by, math.nan),
            "failure": search.failure,
        }
        for (load, pressure), (newton, pascal), search, answered_by in zip(pairs, sizes, searches, by, strict=True)
    ]
    return Envelope(study, card, pd.DataFrame(rows), len(evaluate.outcomes), evaluate.certificate, evaluate.why_full)


def _box(sizes: list[tuple[float, float]], low: float, high: float) -> tuple[Varied, ...]:
    """The box of speeds, loads and pressures for a reduced model."""
    box = [Varied("drive.speed", "m/s", low=low, high=high)]
    for key, unit, values in (
        ("drive.load", "N", [a for a, _ in sizes]),
        ("drive.pressure", "Pa", [b for _, b in sizes]),
    ):
        if min(values) < max(values):
            box.append(Varied(key, unit, low=min(values), high=max(values)))
    return tuple(box)


class EnvelopeQuestion(SweepQuestion):
    """``[envelope]``: the largest speed below a limit, over loads and pressures."""

    key: ClassVar[str] = Envelope.name
    table: ClassVar[type[EnvelopeCard]] = EnvelopeCard
    place: ClassVar[int] = 2

    def __init__(self, study: StudyData, table: EnvelopeCard, card: SweepCard) -> None:
        self.study, self.limits, self.pairs = study, table, checked_pairs(study, table)

    @property
    def words(self) -> str:
        """The planned work: number of loads and pressures."""
        return f"an envelope of {len(self.pairs)} loads and pressures"

    def answered(self, execution: Execution) -> Envelope:
        """See `envelope`."""
        return envelope(self.study, self.limits, execution)
