"""The verdict in sentences: effects, and their amounts with uncertainty and unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from tyrefem.compare.sensors import OUTSIDE_THE_RUBBER
from tyrefem.diagnose.beside.discrepancy import NONE
from tyrefem.diagnose.fitting.pulls import pulls
from tyrefem.diagnose.numbers import amount, correction_words, parameter_name, percent, run_words
from tyrefem.diagnose.unknowns.candidates import Candidate
from tyrefem.diagnose.verdicts.prior_sensitivity import prior_words
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED, certain_members
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.heat import heat_words
from tyrefem.diagnose.words.law import law_words
from tyrefem.diagnose.words.partly import (
    beside_it_words,
    besides_words,
    effects_alone,
    effects_of,
    explaining_words,
    least_words,
    or_outside_words,
    ranges,
    tried_words,
)
from tyrefem.diagnose.words.result_tables import clearest, competing_sets, inclusion_probability
from tyrefem.diagnose.words.strain_laws import law_sentences
from tyrefem.diagnose.words.support import support_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.fits import FittedSet
    from tyrefem.diagnose.fitting.materiality import Movement

#: Companions of a certain effect are shown from this probability on, and so many of them.
LEAST_SHOWN, MOST_SHOWN = 0.05, 3
#: Folder of a further look, within the folder of the look before it.
AGAIN = "again"


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


def effect_sentence(candidate: Candidate, fit: FittedSet) -> str:
    """The effect's sentence, that of its opposite for a negative amplitude; after the runs in which it acts, if few."""
    first = next(iter(candidate.amplitudes), None)
    negative = first is not None and first.value(fit.values.get(first, 0.0)) < 0
    sentence = candidate.effect.opposite if negative and candidate.effect.opposite else candidate.effect.sentence
    return f"In {' and '.join(map(run_words, candidate.runs))} only: {sentence}" if candidate.runs else sentence


def effect_words(candidate: Candidate, fit: FittedSet, move: Movement | None = None) -> str:
    """An effect in one clause: its sentence, its variant, its amounts, and what it moves at the sensors."""
    sentence = effect_sentence(candidate, fit).rstrip(".")
    parts = [value for _, value in candidate.choice] + effect_amounts(candidate, fit)
    parts += [move.words] if move is not None else []
    return f"{sentence} ({'; '.join(parts)})"


def verdict_words(d: DiagnosisData) -> tuple[str, ...]:
    """The verdict in a few sentences, the most important first."""
    again = again_words(d) if d.verdict == IDENTIFIED else ()
    priors = () if d.verdict == UNEXPLAINED else prior_words(d.prior_sensitivity, d.verdict, d.named_effects)
    conformal = () if d.conformal is None else (d.conformal.words(d.judgement.ranking),)
    return (*law_sentences(d), *_verdict_sentences(d), *conformal, *priors, *noise_words(d), *again)


def noise_words(d: DiagnosisData) -> tuple[str, ...]:
    """What the readings say of their noise, if it is not the stated one; empty otherwise."""
    stated, scatter, used = d.stated_noise, d.noise_of_data, d.noise
    if abs(used - stated) > 0.01 * stated:
        return (
            f"The readings scatter by {scatter:.2g} K; the stated noise is {stated:.2g} K. "
            f"The diagnosis uses {used:.2g} K.",
        )
    if d.correlated_noise and scatter < stated:
        return (
            f"Neighbouring readings share noise: they scatter by {scatter:.2g} K. The stated noise, {stated:.2g} K, "
            "is kept; if it is too large, misfits go unnoticed.",
        )
    return ()


def _verdict_sentences(d: DiagnosisData) -> tuple[str, ...]:
    closing = _closing(d)
    if d.verdict == NO_GAP:
        extent = f"rms {_kelvin(d, after=False)}, noise {d.noise:.1f} K"
        first = f"Noise and the uncertainty of base numbers and sensors explain the deviation ({extent})."
        return (first, *_corrected(d))
    clauses = [effect_words(member, d.best, d.movements.get(member)) for member in d.best.members]
    if d.verdict == IDENTIFIED:
        sure = f"Probability {percent(d.judgement.probability)}."
        return _joined(clauses, [sure, *support_words(d)], closing)
    if d.verdict == CONFOUNDED:
        return _confounded(d, closing)
    if d.verdict == PARTLY:
        return _partly(d, closing)
    return _unexplained(d, closing)


def _unexplained(d: DiagnosisData, closing: str) -> tuple[str, ...]:
    if d.better_law is not None and d.better_law.alone:
        return ("With this strain law no effect is missing.", *_corrected(d), closing)
    named = " and ".join(member.key for member in d.best.members)
    partly = (f"These effects explain part of the deviation: {named}.",) if named else ()
    entries = {change.unknown.key for change in d.changes if change.missing}
    many = f"{len(entries)} entries" if len(entries) > 1 else "an entry"
    describe = "describe" if len(entries) > 1 else "describes"
    alone = effects_alone(d)
    explains, instead = "explains", list[str]()
    if alone is not None:
        explains = "is sure to explain"
        instead = [f"Or effects alone explain it ({percent(alone.probability)} probable): {effects_of(alone)}."]
    described = f"The amended study has {many} of missing heat, which {describe} the deviation without a cause."
    return (
        f"No effect in the catalogue {explains} the deviation.",
        *d.judgement.doubts,
        *missing_heat_words(d)[:1],
        *(sentence for sentence in (explaining_words(d), beside_it_words(d)) if sentence),
        *instead,
        *missing_heat_words(d)[1:],
        *partly,
        *([described] if entries else []),
        closing,
        *_next_step(d),
    )


def missing_heat_words(d: DiagnosisData) -> tuple[str, ...]:
    """Heat of unknown origin and its law over the runs, in sentences; empty where the verdict leaves none."""
    if d.verdict == UNEXPLAINED and not (d.better_law is not None and d.better_law.alone):
        return (f"{heat_words(d)}.", *(f"{sentence}." for sentence in law_words(d)))
    return tuple(f"{sentence}." for sentence in law_words(d)) if d.verdict == PARTLY else ()


def part_words(d: DiagnosisData, member: Candidate) -> str:
    """An effect with its range whatever else is wrong, and what it moves; without the last full stop."""
    sentence = effect_sentence(member, d.best).rstrip(".")
    parts = [value for _, value in member.choice] + ranges(d, member)
    parts += [d.movements[member].words] if member in d.movements else []
    return f"{sentence} ({'; '.join(parts)})"


def _partly(d: DiagnosisData, closing: str) -> tuple[str, ...]:
    """The effects that act whatever else is wrong, with the range of their amounts, and what else is wrong."""
    besides = besides_words(d)
    return (
        f"{'. And: '.join(part_words(d, member) for member in d.best.members)}: this is part of the cause, "
        f"whatever else is wrong ({least_words(d)} probable).",
        f"{besides[0].upper()}{besides[1:]}.",
        *([perhaps] if (perhaps := beside_it_words(d)) else []),
        f"Tried beside it: {tried_words(d)}.",
        *support_words(d),
        *missing_heat_words(d),
        *draft_words(d),
        *d.judgement.doubts,
        closing,
    )


def _next_step(d: DiagnosisData) -> tuple[str, ...]:
    """What to do if no effect explains the deviation: where it is clearest, and how to go on."""
    row = clearest(d)
    return (
        f"Next: check {row['sensor']} in {run_words(str(row['run']))}, where the deviation is clearest "
        f"({row['mean_K']:+z.1f} K on average {phase_words(str(row['phase']))}): its "
        f"{'' if row['sensor'] in OUTSIDE_THE_RUBBER else 'place and '}channel, the run's drive, and the stated "
        "uncertainties.",
        "A cause outside the catalogue can be written as an effect (docs/effects.md) and diagnosed again.",
        *draft_words(d),
    )


def draft_words(d: DiagnosisData) -> tuple[str, ...]:
    """Where the draft effect is, and how it is judged; empty without a law that holds."""
    return tuple(
        f"A draft with this law is in {EFFECTS}/{name} in the folder of the results: check it, then diagnose again "
        f"with --effects FOLDER/{EFFECTS}."
        for name in draft_effects(d)
    )


def phase_words(phase: str) -> str:
    """A stretch of time of a history in words.

    >>> phase_words("plateau")
    'on the plateau'
    """
    return {"heating": "while it heats", "plateau": "on the plateau", "cooling": "while it cools"}[phase]


def _corrected(d: DiagnosisData, most: int = 6) -> tuple[str, ...]:
    """The corrections that move a reading, and by how many prior standard deviations, largest first."""
    kept = {change.unknown for change in d.changes}
    shown = [pull for pull in pulls(d.best) if pull.unknown in kept]
    if not shown:
        return ()
    items = [f"{correction_words(each.unknown, each.x, each.sd)} ({each.pull:+z.1f} sd)" for each in shown[:most]]
    more = f"; and {len(shown) - most} more" if len(shown) > most else ""
    return (f"Corrected for it, in standard deviations of what was stated: {'; '.join(items)}{more}.",)


def _confounded(d: DiagnosisData, closing: str) -> tuple[str, ...]:
    best, certain = d.judgement.best, certain_members(d.judgement, d.gap.settings)
    clauses = " And: ".join(
        effect_words(member, d.best, d.movements.get(member)) for member in (certain or best.members)
    )
    if d.judgement.doubts and best.members:
        chance = percent(inclusion_probability(d, best))
        first = f"The fitted runs alone speak for {best.key} ({chance}), but this is not certain: {clauses}."
    elif d.judgement.doubts:
        first = f"The fitted runs alone need no effect ({percent(best.probability)}), but this is not certain."
    elif certain:
        first = f"{clauses}: {percent(min(d.judgement.named[member.key] for member in certain))} probable."
        first += "" if d.best.at_bound else besides(d, certain)
    else:
        sets = competing_sets(d)
        names = ["a cause outside the catalogue" if entry.outside else entry.key for entry in sets[:4]]
        shown = [
            f"{name} ({percent(inclusion_probability(d, entry))})" for name, entry in zip(names, sets, strict=False)
        ]
        more = len(sets) - len(shown)
        shown += [f"one of {more} less probable sets" if more > 1 else "a less probable set"] if more else []
        first = f"{missing_words(d)}, but these sensors and runs cannot show which: {', or '.join(shown)}."
        if best.members:
            first += f" Most probable: {clauses}."
    if d.best.at_bound:
        first += " Its best value lies beyond a physical bound, so it is not certain."
    further = [sentence for sentence in (or_outside_words(d), next_words(d)) if sentence]
    return (first, *d.judgement.doubts, *support_words(d), *further, closing)


def missing_words(d: DiagnosisData) -> str:
    """Whether an effect is missing: only "perhaps" if a discrepancy that needs no effect is the most probable.

    Or if no effect at all is among the sets that are left.
    """
    none = any(not entry.members and not entry.outside for entry in competing_sets(d))
    leading = d.robustness.models[0] if d.robustness is not None else None
    perhaps = none or d.judgement.best.outside or (leading is not None and leading.name != NONE and not leading.best)
    return "Perhaps an effect is missing" if perhaps else "An effect is missing"


def besides(d: DiagnosisData, certain: Sequence[Candidate]) -> str:
    """What may act besides the certain effects, each with its probability."""
    keys = [member.key for member in certain]
    alone = sum(
        entry.probability for entry in d.judgement.ranking if {member.key for member in entry.members} == set(keys)
    )
    others = [
        f"{key} ({percent(chance)})"
        for key, chance in d.judgement.named.items()
        if key not in keys and chance > LEAST_SHOWN
    ]
    it = "it acts" if len(keys) == 1 else "they act"
    first = f" These sensors and runs cannot show whether {it} alone (probability {percent(alone)})"
    return f"{first} or with {', or '.join(others[:MOST_SHOWN])}." if others else f"{first}."


def next_words(d: DiagnosisData) -> str:
    """The best next experiment in one sentence; empty without a proposal."""
    if not d.next_experiment:
        return ""
    sensor = next(iter(d.next_experiment.get("sensors", ())), None)
    drive = next(iter(d.next_experiment.get("drives", ())), None)
    odds = 1.0
    offers = []
    if sensor and sensor["gain"] > odds:
        offers.append(f"a thermocouple at {sensor['place']} (difference up to {sensor['largest_K']:.1f} K)")
    if drive and drive["gain"] > odds:
        offers.append(f"a run at {drive['drive']} (difference up to {drive['largest_K']:.1f} K, {drive['sensor']})")
    between = " and ".join(f"“{key}”" for key in d.next_experiment["between"])
    if not offers:
        return f"No tested sensor place or drive would distinguish {between}."
    sentence = f"{' or '.join(offers)} would best distinguish {between}."
    return sentence[0].upper() + sentence[1:]


def _closing(d: DiagnosisData) -> str:
    if not d.changes:
        return f"The rms of measured - computed is {_kelvin(d, after=False)}; the noise is {d.noise:.1f} K."
    parts = []
    for held_out, name in ((False, "fitted"), (True, "held-out")):
        before, after = d.rms(after=False, held_out=held_out), d.rms(after=True, held_out=held_out)
        if math.isfinite(before):
            parts.append(f"from {before:.1f} to {after:.1f} K on the {name} runs")
    amended = d.best.members or any(change.missing for change in d.changes)
    study = "In the amended study" if amended else "With corrections of base numbers and sensors alone"
    changes = " and ".join(parts)
    unchecked = "" if d.gap.held_out else " No run is held out, so no run checks the fit independently."
    return f"{study} the rms of measured - computed changes {changes}; the noise is {d.noise:.1f} K.{unchecked}"


def _kelvin(d: DiagnosisData, *, after: bool) -> str:
    parts = [(d.rms(after=after, held_out=joint), name) for joint, name in ((False, "fitted"), (True, "held out"))]
    return ", ".join(f"{value:.1f} K {name}" for value, name in parts if math.isfinite(value))


def _joined(clauses: Sequence[str], further: Sequence[str], closing: str) -> tuple[str, ...]:
    return (". And: ".join(clauses) + ". " + " ".join(further), closing)


def again_words(d: DiagnosisData) -> tuple[str, ...]:
    """One sentence for each further look at the same data."""
    sentences = []
    for number, diagnosis in enumerate(d.looks[1:], start=2):
        if diagnosis.verdict == NO_GAP:
            sentences.append("The amended study was diagnosed with the same data: no gap is left.")
            continue
        named = f": {diagnosis.judgement.best.key}" if diagnosis.verdict in (IDENTIFIED, CONFOUNDED) else ""
        sentences.append(
            f"The amended study was diagnosed with the same data: {diagnosis.verdict}{named}; see the folder "
            f"{look_folder(number)}."
        )
    return tuple(sentences)


def look_folder(number: int) -> str:
    """Folder of the second, third... look, within the folder of the first."""
    return "/".join([AGAIN] * (number - 1))


def shortened(reason: str, most: int = 4) -> str:
    """A reason with at most ``most`` items of its list.

    >>> shortened("cannot distinguish: a; b; c; d", 2)
    'cannot distinguish: a; b; and 2 more'
    """
    parts = reason.split("; ")
    return "; ".join([*parts[:most], f"and {len(parts) - most} more"]) if len(parts) > most + 1 else reason
