"""The diagnosis in three sentences: what is wrong, how sure, what to do next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.brief import Brief
from tyrefem.compare.omitted import ERROR
from tyrefem.compare.sensors import OUTSIDE_THE_RUBBER
from tyrefem.diagnose.beside.discrepancy import ENERGY, HEAT, READINGS
from tyrefem.diagnose.fitting.materiality import Movement, largest_change
from tyrefem.diagnose.fitting.pulls import Pull, improbable_pulls
from tyrefem.diagnose.heat.sources import STATED, UnknownSource
from tyrefem.diagnose.numbers import correction_subject, correction_words, percent, run_words
from tyrefem.diagnose.unknowns.candidates import Candidate
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, RankedSet, certain_members
from tyrefem.diagnose.words.discrepancy_record import possible_effects
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.heat import course_words, source_amount, source_place
from tyrefem.diagnose.words.law import one_law_words
from tyrefem.diagnose.words.partly import (
    LIKELY,
    besides_words,
    effects_alone,
    effects_of,
    explaining_words,
    heat_before_errors,
    least_probable,
    least_words,
    or_outside_words,
    ranges,
)
from tyrefem.diagnose.words.result_tables import better_held_out, clearest, competing_sets, inclusion_probability
from tyrefem.diagnose.words.sentences import (
    besides,
    effect_amounts,
    effect_sentence,
    look_folder,
    missing_words,
    next_words,
    phase_words,
)
from tyrefem.diagnose.words.strain_laws import law_in_short, law_sure
from tyrefem.diagnose.words.support import alone_words, stated_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: What each sentence answers.
QUESTIONS = ("What is wrong", "How sure", "What to do next")
#: A gap is more than noise if its rms is so many times that of noise and discrepancy.
CLEAR_GAP = 1.5
#: Largest number of corrections and of sets of effects in a sentence.
CORRECTIONS, SETS = 3, 3


def headline(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next: a sentence each, for every verdict."""
    wrong, sure, next_step = _of_verdict(d)
    errors = [f"{note}." for note in dict.fromkeys(d.notes) if note.startswith(ERROR)]
    if errors:
        times = "Check the unit of the times, and the drive; then diagnose again. "
        return " ".join((*errors, wrong)), sure, f"{times}Else: {next_step[0].lower()}{next_step[1:]}"
    return wrong, sure, next_step


def _of_verdict(d: DiagnosisData) -> tuple[str, str, str]:
    """The three sentences of a verdict, after another strain law if the data prefer it."""
    wrong, sure, next_step = {
        IDENTIFIED: _identified,
        CONFOUNDED: _confounded,
        NO_GAP: _no_gap,
        PARTLY: _partly,
    }.get(d.verdict, _unexplained)(d)
    if d.better_law is None:
        return wrong, sure, next_step
    first, law = law_in_short(d), f"{law_sure(d.better_law)}."
    if d.better_law.alone:
        closed = _closed(d)
        wrong, sure = "With it no effect is missing.", f"{closed[0].upper()}{closed[1:]}."
        next_step = (
            f"Go on with amended.toml, which has the strain law {d.better_law.trial.law}; compare strain laws, section "
            "and cards where the heat differs (tyrefem strain STUDY)."
        )
    elif d.verdict == PARTLY:
        wrong = wrong.replace("This is a part of it: ", "Besides: ", 1)
        sure = sure.replace("It is ", "The effect is ", 1)
    else:
        wrong = wrong.replace("explains the deviation", "explains the rest", 1)
    return f"{first} {wrong}", f"{law} {sure}", next_step


def label(d: DiagnosisData) -> str:
    """The verdict as people read it: "no gap after corrections" if the original study deviates clearly."""
    return f"{NO_GAP} after corrections" if d.verdict == NO_GAP and deviates(d) else d.verdict


def deviates(d: DiagnosisData) -> bool:
    """Whether the original study deviates by more than noise and discrepancy, in the fitted or the held-out runs."""
    level = CLEAR_GAP * math.hypot(d.noise, d.original.card.diagnosis.discrepancy)
    return any(d.rms(after=False, held_out=held_out) > level for held_out in (False, True))


@dataclass(frozen=True)
class CorrectionMove(Brief):
    """A correction of a base number, film or sensor, and the largest change of a reading by it."""

    pull: Pull
    move: Movement

    def _title(self) -> str:
        return self.words

    @property
    def words(self) -> str:
        """The correction, its standard deviations of what was stated, and what it moves."""
        name = correction_words(self.pull.unknown, self.pull.x, self.pull.sd)
        return f"{name} ({self.pull.pull:+z.1f} sd of what was stated, {self.move.kelvin:+z.1f} K at the most)"


def corrections(d: DiagnosisData) -> tuple[CorrectionMove, ...]:
    """The corrections of the amended study, those that move a reading most first."""
    made = []
    for change in d.changes:
        if not change.missing:
            pull = Pull(change.unknown, change.x, change.sd, change.x / change.unknown.sd)
            made.append(CorrectionMove(pull, _moved(d, pull)))
    return tuple(sorted(made, key=lambda each: -abs(each.move.kelvin)))


def _moved(d: DiagnosisData, pull: Pull) -> Movement:
    """The largest change of a reading by a correction, by the sensitivities about x = 0."""
    column = d.gap.unknowns.index(pull.unknown)
    return largest_change(d.gap.sensitivities.drives, [J[:, column] * pull.x for J in d.gap.sensitivities.jacobians])


def _identified(d: DiagnosisData) -> tuple[str, str, str]:
    wrong = _joined([effect_clause(d, member) for member in d.best.members])
    chance = d.judgement.probability
    sure = f"{stated_words(d, d.best.members, chance, percent(chance))}, among all that was tried; {_closed(d)}."
    sure = " ".join((sure, *alone_words(d, further=True)))
    amounts = [clause for member in d.best.members for clause in effect_amounts(member, d.best)]
    what = "the values" if len(amounts) > 1 else "the value" if amounts else "this"
    step = f"Check that you believe {what}, then go on with amended.toml"
    if d.again is not None and d.again.verdict != NO_GAP:
        return wrong, sure, f"{step}; a second look at it says: {d.again.verdict} (folder {look_folder(2)})."
    return wrong, sure, f"{step}{'' if d.again is None else ', in which no gap is left'}."


def _confounded(d: DiagnosisData) -> tuple[str, str, str]:
    best, certain = d.judgement.best, certain_members(d.judgement, d.gap.settings)
    step = next_words(d) or "Measure at more places or in other runs, or state what you know of these effects."
    if not d.next_experiment or step.startswith("No tested"):
        step = f"{step} Exclude what you know to be absent (exclude in [diagnosis]), then diagnose again."
    if d.judgement.doubts and not best.members:
        better = better_held_out(d)
        wrong = "Perhaps an effect is missing" + ("." if better is None else f": {_set_words(better)}.")
        return wrong, f"{_opened(d.judgement.doubts[0])} (fitted runs alone: {percent(best.probability)}).", step
    if d.judgement.doubts or d.best.at_bound:
        doubt = d.judgement.doubts[0] if d.judgement.doubts else "Its best value lies beyond a physical bound."
        clause = _joined([effect_clause(d, member) for member in best.members])
        chance = percent(inclusion_probability(d, best))
        return f"Something is missing, perhaps this: {clause}", f"{_opened(doubt)} (fitted runs alone: {chance}).", step
    if certain:
        least = min(d.judgement.named[member.key] for member in certain)
        stated = stated_words(d, certain, least, percent(least))
        sure = " ".join((f"{stated}; {_closed(d)}.{besides(d, certain)}", *alone_words(d, further=True)))
        return _joined([effect_clause(d, member) for member in certain]), f"{sure} {or_outside_words(d)}".rstrip(), step
    sets = competing_sets(d)
    described = ", or ".join(_set_words(entry) for entry in sets[:SETS])
    rest = len(sets) - SETS
    more = "" if rest < 1 else ", or a less probable set" if rest == 1 else f", or one of {rest} less probable sets"
    shares = ", ".join(f"{entry.key} {percent(inclusion_probability(d, entry))}" for entry in sets[:SETS])
    wrong = f"{missing_words(d)}, but these sensors and runs cannot show which: {described}{more}."
    both = sum(inclusion_probability(d, entry) for entry in sets[:SETS]) > 1.0
    together = " (several may act together)" if both else ""
    sure = f"Each acts with this probability: {shares}{together}; {_closed(d)}."
    return wrong, f"{sure} {or_outside_words(d)}".rstrip(), step


def _partly(d: DiagnosisData) -> tuple[str, str, str]:
    clauses = _joined([part_clause(d, member) for member in d.best.members])
    sources = d.missing.clear
    in_heat = d.robustness is not None and d.robustness.models[0].name == HEAT and sources
    besides_it = f"besides it {heat_clause(d, sources)}" if in_heat else besides_words(d)
    wrong = f"This is a part of it: {clauses.rstrip('.')}; {besides_it}."
    likely = _likely(d)
    wrong += f" Perhaps also: {likely}." if likely else ""
    stated = stated_words(d, d.best.members, least_probable(d), least_words(d))
    sure = f"{stated}, whatever else is wrong; {_closed(d)}."
    strained = improbable_pulls("the amended study", d.best, d.gap.settings)
    sure = " ".join((sure, *alone_words(d, further=True), *([f"{_upper(strained)}."] if strained else [])))
    rest = _rest(d) or "look for the rest where the page shows what is left: strain energy, tan delta, drive"
    return wrong, sure, f"Check that you believe the range, then {rest}."


def _rest(d: DiagnosisData) -> str:
    """How to go on with what no effect explains: by strain laws, stated errors, or the draft effect; else empty."""
    leading = d.robustness.models[0] if d.robustness is not None else None
    if leading is not None and leading.name == ENERGY:
        return "compare strain laws and tan delta where the heat differs (tyrefem strain STUDY)"
    if leading is not None and leading.name == READINGS and not leading.refuted and not heat_before_errors(d):
        return (
            f"state such errors if readings or model may have them (discrepancy in [diagnosis], about {leading.size:g} "
            "K), and diagnose again"
        )
    files = list(draft_effects(d))
    if not files:
        return ""
    return f"judge the draft {files[0]}: tyrefem diagnose STUDY --effects FOLDER/{EFFECTS}, FOLDER that of the results"


def _unexplained(d: DiagnosisData) -> tuple[str, str, str]:
    sources = d.missing.clear
    other = explaining_words(d)
    cause = f"{other[0].lower()}{other[1:].rstrip('.')}" if other else heat_clause(d, sources)
    alone = effects_alone(d)
    explains = "explains" if alone is None else "is sure to explain"
    wrong = f"No effect in the catalogue {explains} the deviation; {cause}."
    wrong += "" if other or not (law := one_law_words(d)) else f" {law}"
    likely = _likely(d)
    if likely and other:
        wrong += f" If that holds, beside it may act: {likely}."
    elif likely and d.robustness is not None:
        wrong += f" Beside {d.robustness.models[0].words} may act: {likely}."
    wrong += f" Or effects alone explain it: {effects_of(alone)}." if alone is not None else ""
    if d.judgement.doubts:
        sure = f"{_opened(d.judgement.doubts[0])}; {_gap(d)}."
    elif other and alone is not None and d.robustness is not None:
        leading = d.robustness.models[0]
        chances = f"{percent(leading.probability)} probable, effects alone {percent(alone.probability)}"
        sure = f"{_upper(leading.words)}: {chances}, of all that was tried beside effects; {_gap(d)}."
    else:
        chance = percent(d.judgement.best.probability)
        sure = f"A cause outside the catalogue is {chance} probable against every set of effects tried; {_gap(d)}."
    row = clearest(d)
    rest = _rest(d) or "write the cause as an effect (docs/effects.md) and diagnose again"
    if alone is not None:
        rest = f"find out whether {' and '.join(member.key for member in alone.best)} acted, or {rest}"
    place = f"{row['sensor']} in {run_words(str(row['run']))}"
    step = (
        f"Check {place} first, where measured - computed is {row['mean_K']:+z.1f} K {phase_words(str(row['phase']))}: "
        f"{'' if row['sensor'] in OUTSIDE_THE_RUBBER else 'its place, '}its channel and the drive; if they are right, "
        f"{rest}."
    )
    return wrong, sure, step


def _likely(d: DiagnosisData) -> str:
    """Effects that are more likely than not beside what else is wrong, but are not named; empty without any."""
    return ", ".join(f"{key} ({percent(share)})" for key, share in possible_effects(d).items() if share >= LIKELY)


def _no_gap(d: DiagnosisData) -> tuple[str, str, str]:
    chance = percent(d.judgement.best.probability)
    other = next((entry for entry in d.judgement.ranking[1:] if not entry.outside), None)
    against = "" if other is None else f" (next: {other.key}, {percent(other.probability)})"
    sure = f"That no effect is missing is {chance} probable{against}"
    if not deviates(d):
        wrong = f"Nothing is wrong beyond noise and what the study states as uncertain: {_gap(d)}."
        step = "Nothing needs to be done; smaller effects need better measurements (tyrefem isolability)."
        return wrong, f"{sure}.", step
    sure = f"{sure}; {_closed(d)}."
    shown = corrections(d)
    wrong = f"The study deviates ({_gap(d)}), but no effect is needed: corrections of stated numbers explain it"
    if not shown:
        return f"{wrong}.", sure, "Measure the uncertain numbers of the study more exactly, then diagnose again."
    items = "; ".join(each.words for each in shown[:CORRECTIONS])
    more = f"; and {len(shown) - CORRECTIONS} more" if len(shown) > CORRECTIONS else ""
    first = correction_subject(shown[0].pull.unknown)
    step = f"Measure what was corrected most ({first}), or go on with amended.toml, which has the corrections."
    return f"{wrong}. {items[0].upper()}{items[1:]}{more}.", sure, step


# -- clauses -----------------------------------------------------------------------------------------------------------


def effect_clause(d: DiagnosisData, member: Candidate) -> str:
    """An effect with its amounts, and what it moves at which sensor; without the last full stop."""
    sentence = effect_sentence(member, d.best).rstrip(".")
    return f"{sentence}{_with_amounts(member, effect_amounts(member, d.best))}{_moves(d.movements.get(member))}"


def part_clause(d: DiagnosisData, member: Candidate) -> str:
    """An effect with the range of its amounts whatever else is wrong, and what it moves; without the last full stop."""
    sentence = effect_sentence(member, d.best).rstrip(".")
    return f"{sentence}{_with_amounts(member, ranges(d, member))}{_moves(d.movements.get(member))}"


def _with_amounts(member: Candidate, clauses: Sequence[str]) -> str:
    """The variant of an effect and its amounts, as they follow its sentence."""
    variant = ", ".join(value for _, value in member.choice)
    amounts = "; ".join(clauses)
    amounts = "" if not amounts else f", {amounts}" if amounts.startswith("by ") else f": {amounts}"
    return f"{f' ({variant})' if variant else ''}{amounts}"


def heat_clause(d: DiagnosisData, sources: Sequence[UnknownSource]) -> str:
    """The largest clear source of missing heat, and how many more there are."""
    if not sources:
        return "no place of missing heat is clear"
    first = sources[0]
    sign = "heat is missing" if first.amount > 0 else "the model has too much heat, cooling is missing,"
    course = course_words(first)
    course = f"; {course[0].lower()}{course[1:]}" if first.kinds[first.kind] >= STATED else ""
    left = len(sources) - 1
    more = f"; and {left} more place{'s' if left > 1 else ''}" if left else ""
    return f"{sign} {source_place(d, first)}: {source_amount(first)}{_moves(first.move)}{course}{more}"


def _moves(move: Movement | None) -> str:
    if move is None or not math.isfinite(move.kelvin):
        return ""
    return f", which moves {move.sensor} by up to {move.kelvin:+z.1f} K ({run_words(move.run)})"


def _joined(clauses: Sequence[str]) -> str:
    return f"{'. And: '.join(clauses)}."


def _upper(clause: str) -> str:
    return f"{clause[0].upper()}{clause[1:]}"


def _opened(sentence: str) -> str:
    return sentence.rstrip(".")


def _set_words(entry: RankedSet) -> str:
    """A set of effects in words, with the signs of its fit: "the road is colder than stated (hot-road)"."""
    if entry.outside or not entry.members:
        return "a cause outside the catalogue" if entry.outside else "no effect at all"
    sentences = []
    for member in entry.members:
        sentence = member.effect.sentence if entry.fit is None else effect_sentence(member, entry.fit)
        sentence = sentence.rstrip(".")
        sentences.append(f"{sentence[0].lower()}{sentence[1:]} ({member.key})")
    return " and ".join(sentences)


def _gap(d: DiagnosisData) -> str:
    """Rms of the original study's deviation, and the noise."""
    parts = []
    for held_out, name in ((False, "fitted"), (True, "held-out")):
        value = d.rms(after=False, held_out=held_out)
        if math.isfinite(value):
            parts.append(f"{value:.1f} K in the {name} runs")
    return f"rms {' and '.join(parts)}, noise {d.noise:.1f} K"


def _closed(d: DiagnosisData) -> str:
    """What the amended study makes of the deviation: of the held-out runs if there are any."""
    held_out = bool(d.gap.held_out)
    name = "held-out" if held_out else "fitted"
    before, after = (d.rms(after=after, held_out=held_out) for after in (False, True))
    checked = "" if held_out else "; no run is held out, so nothing checks it independently"
    if not d.changes:
        return f"measured - computed is {before:.1f} K rms in the {name} runs, noise {d.noise:.1f} K{checked}"
    by = "the amended study brings" if any(change.missing for change in d.changes) else "corrections bring"
    return f"{by} the {name} runs from {before:.1f} to {after:.1f} K rms, noise {d.noise:.1f} K{checked}"
