"""Effects in words: their sentences, their amounts with uncertainty and unit, and what they move at the sensors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from tyrefem.diagnose.numbers import amount, parameter_name, percent, run_words
from tyrefem.diagnose.unknowns.candidates import Candidate
from tyrefem.diagnose.words.discrepancy_record import possible_effects

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.fits import FittedSet
    from tyrefem.diagnose.fitting.materiality import Movement

#: Effects that may act stand in the first sentence from this probability on.
LIKELY = 0.5


def effect_sentence(candidate: Candidate, fit: FittedSet) -> str:
    """The effect's sentence, that of its opposite for a negative amplitude; after the runs in which it acts, if few."""
    first = next(iter(candidate.amplitudes), None)
    negative = first is not None and first.value(fit.values.get(first, 0.0)) < 0
    sentence = candidate.effect.opposite if negative and candidate.effect.opposite else candidate.effect.sentence
    return f"In {' and '.join(map(run_words, candidate.runs))} only: {sentence}" if candidate.runs else sentence


def effect_amounts(candidate: Candidate, fit: FittedSet) -> list[str]:
    """Meaning and amount of each fitted parameter of an effect.

    The sentence of an effect with an opposite tells the sign of its amplitude: "the road is colder than stated", "by
    24.0 ± 2.0 K".
    """
    known = [unknown for unknown in candidate.unknowns if unknown in fit.values and not unknown.fixed]
    signed = set(candidate.amplitudes[:1]) if candidate.effect.opposite else set()
    clauses = []
    for unknown in known:
        x, sd = fit.total(unknown)
        size = amount(unknown.value(x), sd, unknown.unit)
        clauses.append(f"by {size.lstrip('+-')}" if unknown in signed else f"{parameter_name(unknown)}: {size}")
    return clauses


def effect_clause(d: DiagnosisData, member: Candidate, amounts: Sequence[str] | None = None) -> str:
    """An effect of the best set as a clause of a first sentence; without the last full stop.

    Its sentence, its variant, its amounts, and what it moves at which sensor. ``amounts``: in place of the fitted ones.
    """
    sentence = effect_sentence(member, d.best).rstrip(".")
    variant = ", ".join(value for _, value in member.choice)
    stated = "; ".join(effect_amounts(member, d.best) if amounts is None else amounts)
    stated = "" if not stated else f", {stated}" if stated.startswith("by ") else f": {stated}"
    return f"{sentence}{f' ({variant})' if variant else ''}{stated}{moves_clause(d.movements.get(member))}"


def moves_clause(move: Movement | None) -> str:
    """What an effect or a heat moves, as it follows its amounts; empty if that is not known or not finite."""
    if move is None or not math.isfinite(move.kelvin):
        return ""
    return f", which moves {move.sensor} by up to {move.kelvin:+z.1f} K ({run_words(move.run)})"


def effect_words(d: DiagnosisData, member: Candidate, amounts: Sequence[str] | None = None) -> str:
    """An effect of the best set as a clause of the paragraph; without the last full stop.

    The same as `effect_clause`, but in brackets after its sentence. ``amounts``: in place of the fitted ones.
    """
    sentence = effect_sentence(member, d.best).rstrip(".")
    parts = [value for _, value in member.choice]
    parts += effect_amounts(member, d.best) if amounts is None else amounts
    parts += [d.movements[member].words] if member in d.movements else []
    return f"{sentence} ({'; '.join(parts)})"


def joined(clauses: Sequence[str]) -> str:
    """Clauses of several effects as sentences."""
    return f"{'. And: '.join(clauses)}."


def possible_words(d: DiagnosisData, least: float = 0.0) -> str:
    """Effects that may act beside what else is wrong, from a probability ``least`` on; empty without any."""
    return ", ".join(f"{key} ({percent(share)})" for key, share in possible_effects(d).items() if share >= least)
