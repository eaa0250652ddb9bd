"""The safe operating envelope: over load and pressure, the largest speed that keeps the tyre below a limit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

from tyrefem.quantity import parse
from tyrefem.studies import Study
from tyrefem.sweep.answer_words import name_of, shown
from tyrefem.sweep.asked import Asked
from tyrefem.sweep.card import EnvelopeCard
from tyrefem.sweep.execution import Execution, Said
from tyrefem.sweep.operating_points import checked_pairs, operating, speed_range
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.speed_search import SpeedSearch
from tyrefem.sweep.varied import Varied

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.reduced.surrogate import Certificate

#: Rounds of bisection and interpolation at most.
ROUNDS = 14
#: Runs per load and pressure that are expected, to judge whether training pays.
EXPECTED = 7


@dataclass(frozen=True, eq=False)
class Envelope:
    """What a tyre may be driven at.

    Parameters
    ----------
    study : the study. card : what was asked. runs : how many. certificate : of a reduced model, if one answered.
    table : a row per load and pressure: as written and in SI, ``speed_m_s`` (NaN: the limit is broken at any speed
        searched), ``at_limit`` (False: it is kept even at the highest), the answer there, ``tkph`` = load x speed in
        t km/h, ``by``, ``error_K``, ``failure``.
    """

    study: Study
    card: EnvelopeCard
    table: pd.DataFrame
    runs: int
    certificate: Certificate | None = None
    why_full: str = ""

    name = "envelope"
    heading = "Safe operating envelope"

    @property
    def rating(self) -> pd.DataFrame:
        """Per pressure: the load x speed, t km/h, that is safe at every load tried (a TKPH-like rating).

        The product is smallest at one of the loads; below it the tyre is below the limit at all of them. NaN: at some
        load no speed is.
        """
        groups = self.table.groupby("pressure", sort=False)
        return groups["tkph"].min().where(groups["speed_m_s"].count() == groups.size()).rename("tkph").reset_index()

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        answer, end = self.card.answer, self.study.card.drive.end
        kept = f"stays below {shown(answer, self.card.below)} in a drive of {end:g} s"
        told = [f"The {name_of(answer)} {kept} up to these speeds:"]
        for pressure, rows in self.table.groupby("pressure", sort=False):
            told.append(f"at {pressure}: {', '.join(map(_speed_words, rows.to_dict('records')))}.")
        safe = self.rating.dropna(subset=["tkph"]).to_dict("records")
        rated = [f"{row['tkph']:.0f} t km/h at {row['pressure']}" for row in safe]
        if rated:
            told.append(f"Load times speed that is safe at every one of these loads: {', '.join(rated)}.")
        by = f"{self.runs} full runs"
        if self.certificate is not None:
            by = f"{self.runs} variants by a reduced model, temperatures good to {self.certificate.worst:.2g} K"
        told.append(f"Found by {by}.")
        return told

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
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
    beyond = "" if row["at_limit"] else " and more"
    return f"{row['speed_m_s'] * 3.6:.0f} km/h{beyond} with {row['load']}"


def envelope(study: Study, card: EnvelopeCard, how: Execution | None = None, **said: Unpack[Said]) -> Envelope:
    """The largest speed at which an answer stays below a limit, for every load and pressure.

    The answer must rise with speed. All pairs are searched at once: each round runs one speed of every pair that is not
    settled, by false position kept within bisection (the Illinois rule). how, said : as of `tyrefem.sweep.sweep.sweep`.

    Raises
    ------
    InputError : speeds that are no range, an unknown answer, a load or pressure that the study refuses.
    """
    import pandas as pd

    low, high = speed_range(card)
    pairs = checked_pairs(study, card)
    sizes = [(parse(load, "N"), parse(pressure, "Pa")) for load, pressure in pairs]
    searches = [SpeedSearch(low, high, card.below) for _ in pairs]
    plan = Plan(study, _box(sizes, low, high), (), (), {}, None, {"sample": "envelope"})
    how = (how or Execution()).given(said)
    by: list[str] = [""] * len(pairs)
    with Asked(plan, how) as asked:
        asked.train(EXPECTED * len(pairs))
        for _ in range(ROUNDS):
            waiting = [n for n, one in enumerate(searches) if not one.settled]
            how.tick("envelope", len(searches) - len(waiting), len(searches))
            if not waiting:
                break
            found = asked([operating(pairs[n], f"{searches[n].next:.6g} m/s") for n in waiting])
            for n, outcome in zip(waiting, found, strict=True):
                searches[n].take(outcome, card.answer)
                by[n] = outcome.get("by", "")
    error = {"reduced": asked.certificate.worst if asked.certificate else math.nan, "full": 0.0}
    rows = [
        {
            "load": load,
            "pressure": pressure,
            "load_N": newton,
            "pressure_Pa": pascal,
            "speed_m_s": one.speed,
            "speed_km_h": one.speed * 3.6,
            "at_limit": one.bracketed,
            card.answer: one.value,
            "tkph": newton / 9806.65 * one.speed * 3.6,
            "by": how,
            "error_K": error.get(how, math.nan),
            "failure": one.failure,
        }
        for (load, pressure), (newton, pascal), one, how in zip(pairs, sizes, searches, by, strict=True)
    ]
    return Envelope(study, card, pd.DataFrame(rows), len(asked.outcomes), asked.certificate, asked.why_full)


def _box(sizes: list[tuple[float, float]], low: float, high: float) -> tuple[Varied, ...]:
    """What a reduced model would have to cover."""
    found = [Varied("drive.speed", "m/s", low=low, high=high)]
    for key, unit, values in (
        ("drive.load", "N", [a for a, _ in sizes]),
        ("drive.pressure", "Pa", [b for _, b in sizes]),
    ):
        if min(values) < max(values):
            found.append(Varied(key, unit, low=min(values), high=max(values)))
    return tuple(found)
