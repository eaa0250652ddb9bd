"""The law of missing heat in sentences."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.beside.discrepancy import HEAT, NONE, READINGS
from tyrefem.diagnose.heat.courses import BEGINS, ENDS, PHASE, RUN
from tyrefem.diagnose.heat.sources import CLEAR, STATED
from tyrefem.diagnose.law.places import FILM, FLUX, LOSS, SIDEWALL, UNITS, WHOLE_SURFACES, LawPlace
from tyrefem.diagnose.law.search import MOSTLY
from tyrefem.diagnose.law.terms import (
    ABOVE,
    DEFLECTION,
    HARDLY,
    LOAD,
    MECHANICAL,
    NO_SWITCH,
    PRESSURE,
    REST,
    ROLLING,
    SPEED,
    WARM,
)
from tyrefem.diagnose.numbers import amount, chance, percent, time_with_sd, with_sd
from tyrefem.diagnose.unknowns.heat_patches import SURFACES, place_of
from tyrefem.diagnose.verdicts.verdict import PARTLY
from tyrefem.diagnose.words.heat import is_told, source_place, station_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.law.evidence import LawFit
    from tyrefem.diagnose.law.heat_law import Exponent, PlaceLaw
    from tyrefem.diagnose.law.search import HeatLaw

#: Unit and factor of a reference in sentences.
REFERENCES = {
    SPEED: (1.0, "m/s"), LOAD: (1e-3, "kN"), PRESSURE: (1e-5, "bar"), DEFLECTION: (1e3, "mm"), WARM: (1.0, "°C"),
    ABOVE: (1.0, "K above ambient"),
}  # fmt: skip
#: A law that describes less than this is said to.
PART = 0.995
#: Another description of the same heat is told from this probability on.
LIKELY = 0.5
FILM_NAMES = {
    "road": "film between tread and road", "outside_air": "outside air film",
    "tread_air": "air film of the tread between two contacts", "contained_air": "film of the contained air",
    "rim": "film between bead and rim",
}  # fmt: skip


def law_words(d: DiagnosisData) -> tuple[str, ...]:
    """The law in one to four sentences, without their full stops; empty without a law."""
    heat = d.law
    if heat is None:
        return ()
    if not heat.holds:
        return ("No law of speed, load, pressure, temperature and time describes this heat in all runs",)
    law = heat.law
    heads = {PARTLY: "The heat that is missing beside it has a law over these runs"}
    head = heads.get(d.verdict, "Its law over these runs")
    part = f"It describes {percent(heat.share)} of what heat with a free course in every run describes"
    rest = [part] if heat.share < PART else []
    return (
        f"{head}: {_law_itself(d, heat)}",
        *rest,
        *cause_words(heat.place, law),
        *place_words(d, heat),
        *limits(law),
        *limits_where_it_acts(heat),
        *discrepancy_words(d),
    )


def one_law_words(d: DiagnosisData) -> str:
    """The law in one sentence where it alone describes nearly all of what several clear sources do; else empty.

    Not where the data prefer a source at another place.
    """
    heat, over_time = d.law, d.missing.over_time
    if heat is None or over_time is None or len(over_time.clear) < 2:
        return ""
    if not heat.holds or heat.ranking[0].others or heat.share < MOSTLY or (heat.lead < 0 and place_words(d, heat)):
        return ""
    cause = "".join(f"; {each[0].lower()}{each[1:]}" for each in cause_words(heat.place, heat.law))
    return f"One law describes {percent(heat.share)} of this heat: {_law_itself(d, heat)}{cause}."


def _law_itself(d: DiagnosisData, heat: HeatLaw) -> str:
    """Sign, place, terms, switch and amplitude of a law."""
    law, unit = heat.law, UNITS[heat.place.kind]
    sign = "" if law.amplitude > 0 else "cooling, "
    size = amount(100 * law.amplitude, 100 * law.sd, "%") if unit == "1" else amount(law.amplitude, law.sd, unit)
    at = [reference_words(law, name) for name in law.fit.terms]
    formula = f"{sign}{law_place_words(d, heat.place)}, {law_formula(law)}{_when(heat)}"
    return f"{formula}: {size}{' at ' + ', '.join(at) if at else ''}"


def cause_words(place: LawPlace, law: PlaceLaw) -> list[str]:
    """A usual cause of heat that flows steadily into the sidewall, which no effect of the catalogue is."""
    steady = not law.fit.terms and law.fit.switch.kind == NO_SWITCH
    if not (place.where == SIDEWALL and steady and law.amplitude > 0):
        return []
    return ["The sun on that side, or a hot body beside the tyre, would do this; the effect sun heats the tread, too"]


def place_words(d: DiagnosisData, heat: HeatLaw) -> list[str]:
    """Which place to take if the law and the source of a free course are not on the same side, inside or a surface."""
    over_time, side = d.missing.over_time, heat.place.surface
    if over_time is None or not over_time.clear:
        return []
    source = max(over_time.clear, key=lambda each: 0.0 if each.move is None else abs(each.move.kelvin))
    here = _side_words(heat.place)
    if is_told(source):
        if side == ("" if source.inside else source.where):
            return []
        share = chance(heat.lead)
        names, taken = ("the law", here) if share >= 0.5 else ("the source", source_place(d, source))
        return [
            f"The law is {here}, the source that may act at any time is {source_place(d, source)}: the data prefer "
            f"{names} ({percent(max(share, 1 - share))}), so take {taken} as the place"
        ]
    other = min((each for each in heat.ranking if each.place.surface != side), key=lambda e: e.below, default=None)
    if other is None:
        return []
    share, there = chance(other.below - heat.ranking[0].below), _side_words(other.place)
    return [
        f"Only the law tells the two apart: {here} {percent(share)}, not {there}" if share >= STATED else
        f"The law does not tell them apart either: {here} {percent(share)}, {there} {percent(1 - share)}"
    ]  # fmt: skip


def _side_words(place: LawPlace) -> str:
    return f"at the {place.surface}" if place.surface else "inside the rubber"


def limits(law: PlaceLaw) -> list[str]:
    """What these runs cannot tell of a law."""
    sentences = []
    if law.alternatives:
        others = [fit for fit, _ in law.alternatives if not _adds_nothing(fit, law.fit)]
        shown = list(dict.fromkeys(_short(fit) for fit in others if _short(fit) != _short(law.fit)))[:3]
        if shown:
            sentences.append(f"These runs do not tell it from {', or '.join(shown)}")
    sentences += [f"{_and(pair).capitalize()} vary together in these runs" for pair in law.together]
    if law.hardly:
        verb, of = ("vary", "their exponents") if len(law.hardly) > 1 else ("varies", "its exponent")
        sentences.append(f"{_and(law.hardly).capitalize()} hardly {verb}, so nothing is known of {of}")
    return sentences


def limits_where_it_acts(heat: HeatLaw) -> list[str]:
    """Variables of the law that hardly vary in the only run in which it acts.

    The speed at rest counts as a walking pace in the law of a flux, so that its exponent tells rolling from rest.
    """
    switch, variables = heat.law.fit.switch, heat.variables
    if not switch.kind.startswith(RUN):
        return []
    here = (np.asarray(switch.on) > 0) & variables.rolling
    names = [name for name in heat.law.fit.terms if name in (SPEED, *MECHANICAL)]
    same = [name for name in names if here.any() and np.ptp(np.log(getattr(variables, name)[here])) < HARDLY]
    return [
        f"{name.capitalize()} hardly varies there while the tyre rolls, so "
        + ("its exponent only tells rolling from rest" if name == SPEED and not heat.place.inside else
           "nothing is known of its exponent")
        for name in same
    ]  # fmt: skip


def discrepancy_words(d: DiagnosisData) -> list[str]:
    """A more probable cause of the deviation, which the law's intervals leave out; errors of readings fit any one."""
    leading = d.robustness.models[0] if d.robustness else None
    if leading is None or leading.name in (NONE, HEAT, READINGS) or leading.probability < LIKELY:
        return []
    words = f"{leading.words[0].upper()}{leading.words[1:]}"
    return [
        f"{words} would describe this heat as well ({percent(leading.probability)}); the law's intervals leave that "
        "out, so they are too narrow"
    ]


def law_formula(law: PlaceLaw) -> str:
    """The terms with their intervals: "grows as speed^1.9 ± 0.1 × load^0.4 ± 0.1"."""
    entries = [law.exponent[name] for name in law.fit.terms]
    if not entries:
        return "the same at every speed, load and pressure"
    verb = "grows" if entries[0].mean > 0 else "changes"
    return f"{verb} as {' × '.join(_term(entry) for entry in entries)}"


def reference_words(law: PlaceLaw, name: str) -> str:
    """The reference of a term: "speed 12.3 m/s"."""
    factor, unit = REFERENCES[name]
    return f"{name.split(' ')[0]} {law.terms.references[name] * factor:.3g} {unit}"


def law_place_words(d: DiagnosisData, place: LawPlace) -> str:
    """Where a law acts."""
    if place.kind == LOSS:
        return f"a share of the model's own heat in {place.where}"
    if place.kind == FILM:
        return f"a share of the {FILM_NAMES[place.where]}"
    if place.where in WHOLE_SURFACES:
        return f"through the {place.where}"
    station = station_words(d, place.station)
    if len(stations := dict.fromkeys(place_of(unknown)[0] for unknown, _ in place.parts)) > 1:
        return " and ".join(station_words(d, each) for each in stations)
    if place.kind == FLUX:
        return f"at the {place.where}, {station}" if place.where in SURFACES else station
    return station


def _term(entry: Exponent) -> str:
    if entry.name == WARM:
        return f"exp({amount(entry.mean, entry.sd, '1/delta_degC')} × temperature)"
    name = "(temperature above ambient)" if entry.name == ABOVE else entry.name
    exponent = with_sd(entry.mean, entry.sd)
    return f"{name}^({exponent})" if entry.mean < 0 else f"{name}^{exponent}"


def _short(fit: LawFit) -> str:
    """A law without intervals, for a list of alternatives; without terms whose exponents are 0 as written."""
    parts = []
    for name, mean in zip(fit.terms, fit.mean, strict=True):
        if abs(mean) < (5e-4 if name == WARM else 0.05):
            continue
        parts.append(f"exp({100 * mean:+.1f} %/K × temperature)" if name == WARM else f"{name}^{mean:.1f}")
    when = "" if fit.switch.kind == NO_SWITCH else f", {_kind(fit.switch.kind)}"
    return f"{' × '.join(parts) or 'constant heat'}{when}"


def _adds_nothing(fit: LawFit, best: LawFit) -> bool:
    """Whether a law is the best one with further terms whose exponents may be 0."""
    if not set(best.terms) < set(fit.terms) or fit.switch.kind != best.switch.kind:
        return False
    further = [number for number, name in enumerate(fit.terms) if name not in best.terms]
    return all(abs(fit.mean[number]) < CLEAR * fit.sd[number] for number in further)


def _when(heat: HeatLaw) -> str:
    law = heat.law
    kind, inside = law.fit.switch.kind, heat.place.inside
    if kind == NO_SWITCH:
        return ", while the tyre rolls" if inside else ", rolling or not"
    chance = law.switch_probabilities[kind]
    doubt = "" if chance >= 0.9 else f" ({percent(chance)})"
    rolling = ", only while rolling" if inside and not kind.startswith((PHASE, RUN)) else ""
    time = f" at {time_with_sd(law.time, law.time_sd)}" if math.isfinite(law.time) else ""
    return f"{rolling}, {_kind(kind)}{time}{doubt}"


def _kind(kind: str) -> str:
    if kind.startswith(PHASE):
        return f"only in the phase {kind.removeprefix(PHASE)}"
    if kind.startswith(RUN):
        name = kind.removeprefix(RUN)
        late = name.endswith(f" {BEGINS}")
        return f"only in {name.removesuffix(f' {BEGINS}')}" + (", where it begins" if late else "")
    return {ROLLING: "only while rolling", REST: "only at rest", BEGINS: "it begins", ENDS: "it ends"}[kind]


def _and(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
