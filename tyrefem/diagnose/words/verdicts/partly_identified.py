"""The verdict "partly identified" in words: effects with their amounts whatever else is wrong, and what else is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, NONE
from tyrefem.diagnose.fitting.pulls import improbable_pulls
from tyrefem.diagnose.numbers import at_least, extent, parameter_name
from tyrefem.diagnose.words.effects import LIKELY, effect_clause, effect_words, joined, possible_words
from tyrefem.diagnose.words.heat import NOT_CLEAR, heat_words
from tyrefem.diagnose.words.missing_heat import heat_clause, missing_heat_words
from tyrefem.diagnose.words.next_steps import draft_words, rest_clause
from tyrefem.diagnose.words.rms import closed_clause, closing_sentence
from tyrefem.diagnose.words.strain_energy import energy_words
from tyrefem.diagnose.words.support import alone_words, stated_words, support_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.unknowns.candidates import Candidate


def three_sentences(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next.

    Behind another strain law, which is told first, the effects are "besides".
    """
    clauses = joined([effect_clause(d, member, _ranges(d, member)) for member in d.best.members])
    sources = d.missing.clear
    in_heat = d.robustness is not None and d.robustness.models[0].name == HEAT and sources
    besides = f"besides it {heat_clause(d, sources)}" if in_heat else _besides(d)
    opening = "This is a part of it" if d.better_law is None else "Besides"
    wrong = f"{opening}: {clauses.rstrip('.')}; {besides}."
    likely = possible_words(d, LIKELY)
    wrong += f" Perhaps also: {likely}." if likely else ""
    stated = stated_words(d, d.best.members, _least_probable(d), at_least(_least_probable(d)))
    stated = stated if d.better_law is None else stated.replace("It is ", "The effect is ", 1)
    sure = f"{stated}, whatever else is wrong; {closed_clause(d)}."
    strained = improbable_pulls("the amended study", d.best, d.gap.settings)
    further = (f"{strained[0].upper()}{strained[1:]}.",) if strained else ()
    sure = " ".join((sure, *alone_words(d, further=True), *further))
    rest = rest_clause(d) or "look for the rest where the page shows what is left: strain energy, tan delta, drive"
    return wrong, sure, f"Check that you believe the range, then {rest}."


def paragraph(d: DiagnosisData) -> tuple[str, ...]:
    """The effects that act whatever else is wrong, with the range of their amounts, and what else is wrong."""
    besides, possible = _besides(d), possible_words(d)
    return (
        f"{'. And: '.join(effect_words(d, member, _ranges(d, member)) for member in d.best.members)}: this is part of "
        f"the cause, whatever else is wrong ({at_least(_least_probable(d))} probable).",
        f"{besides[0].upper()}{besides[1:]}.",
        *([f"Perhaps these act, too: {possible}. They are not sure enough to be named."] if possible else []),
        f"Tried beside it: {_tried(d)}.",
        *support_words(d),
        *missing_heat_words(d),
        *draft_words(d),
        *d.judgement.doubts,
        closing_sentence(d),
    )


def _ranges(d: DiagnosisData, member: Candidate) -> list[str]:
    """The range of each parameter of an effect over the discrepancy models."""
    robust = d.robustness
    if robust is None:
        return []
    clauses = []
    for unknown in member.unknowns:
        if not unknown.fixed and any(unknown.key in model.values for model in robust.models):
            low, high = (unknown.value(x) for x in robust.interval(unknown))
            # The sentence of an effect with an opposite tells the sign.
            if unknown in member.amplitudes[:1] and member.effect.opposite and low * high > 0:
                least, most = sorted((abs(low), abs(high)))
                clauses.append(f"by {extent(least, most, unknown.unit).replace('+', '')}")
            else:
                clauses.append(f"{parameter_name(unknown)}: {extent(low, high, unknown.unit)}")
    return clauses


def _least_probable(d: DiagnosisData) -> float:
    """The smallest probability of the effects over the discrepancy models."""
    robust = d.robustness
    assert robust is not None
    return min(robust.least(member.key) for member in d.best.members)


def _tried(d: DiagnosisData) -> str:
    """What else may be wrong, as it was tried."""
    robust = d.robustness
    assert robust is not None
    tried = (
        "; ".join(model.words for model in robust.counted if model.name != NONE) or "nothing else that the data allow"
    )
    left_out = [model.words for model in (*robust.models, *robust.laws) if model not in robust.counted]
    them = "them" if len(left_out) > 1 else "it"
    tried += f" (not counted, as the data exclude {them}: {'; '.join(left_out)})" if left_out else ""
    return f"{tried} (not tried: strain law {', '.join(robust.untried)})" if robust.untried else tried


def _besides(d: DiagnosisData) -> str:
    """What else is wrong, by the most probable discrepancy model; without the last full stop."""
    robust = d.robustness
    assert robust is not None
    leading = robust.models[0]
    if leading.name == NONE:
        return "besides it nothing else is clear"
    if leading.name == ENERGY and (shares := energy_words(d, d.best)):
        return f"besides it {shares}"
    if leading.name != HEAT:
        return f"besides it the data speak for {leading.words}"
    words = heat_words(d)
    return "besides it heat is missing at no clear place" if words == NOT_CLEAR else f"besides it: {words}"
