"""A diagnosis in the words of an engineer: amounts with their uncertainty, effects, the verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.candidates import Candidate
from tyrefem.diagnose.contenders import contenders, support
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.diagnose.verdict import CONFOUNDED, IDENTIFIED, NO_GAP
from tyrefem.geometry.place_names import place

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fits import FittedSet

#: Unit of a parameter, SI -> factor and unit in which a person reads it.
READ = {
    "1": (1.0, ""),
    "1/delta_degC": (100.0, "%/K"),
    "J/m**3": (1e-3, "kJ/m³"),
    "Pa/s": (3.6, "kPa/h"),
    "W/m**2": (1.0, "W/m²"),
    "W/m**3": (1e-3, "kW/m³"),
    "delta_degC": (1.0, "K"),
    "delta_degC/s": (3600.0, "K/h"),
    "m": (1e3, "mm"),
    "m**2*K/W": (1.0, "m²K/W"),
    "rad": (180 / math.pi, "°"),
}
#: Folder of a further look at the same data, in that of the one before.
AGAIN = "again"


def amount(value: float, sd: float, unit: str) -> str:
    """A value with its sign and standard deviation, rounded as the latter deserves, in a unit that a person reads.

    >>> amount(4.3766, 0.8586, "delta_degC"), amount(0.0002056, 0.00013, "m"), amount(-0.054, 0.098, "1")
    ('+4.4 ± 0.9 K', '+0.21 ± 0.13 mm', '-0.05 ± 0.10')
    """
    factor, shown = READ.get(unit, (1.0, unit.replace("**2", "²").replace("**3", "³")))
    value, sd = value * factor, sd * factor
    decimals = _decimals(sd if sd > 0 and math.isfinite(sd) else abs(value) / 100)
    scale = 10.0 ** min(decimals, 0)
    first, second = (round(number * scale) / scale for number in (value, sd)) if decimals < 0 else (value, sd)
    places = max(decimals, 0)
    return f"{first:+z.{places}f} ± {second:.{places}f} {shown}".rstrip()


def _decimals(sd: float) -> int:
    """Decimals that show two digits of a standard deviation that begins below 3.55, else one (Particle Data Group)."""
    if sd <= 0 or not math.isfinite(sd):
        return 2
    size = math.floor(math.log10(sd))
    return 1 - size if sd / 10.0**size < 3.55 else -size


def parameter_name(unknown: Unknown) -> str:
    """What an effect's parameter means."""
    return unknown.parameter.prior.meaning if unknown.parameter else unknown.label


def effect_amounts(candidate: Candidate, fit: FittedSet) -> list[str]:
    """Each fitted parameter of an effect: meaning and amount."""
    known = [unknown for unknown in candidate.unknowns if unknown in fit.values]
    return [
        f"{parameter_name(unknown)}: {amount(unknown.value(fit.values[unknown]), fit.sd[unknown], unknown.unit)}"
        for unknown in known
    ]


def effect_words(candidate: Candidate, fit: FittedSet) -> str:
    """An effect in one clause: its sentence, which variant, and how much."""
    sentence = candidate.effect.sentence.rstrip(".")
    parts = [value for _, value in candidate.choice] + effect_amounts(candidate, fit)
    return f"{sentence} ({'; '.join(parts)})"


def verdict_words(d: DiagnosisData) -> tuple[str, ...]:
    """What stands behind the verdict's name, in a few plain sentences, the most important first."""
    closing = _closing(d)
    if d.verdict == NO_GAP:
        extent = f"rms {_kelvin(d, after=False)}, noise {d.noise:.1f} K"
        return (f"Noise and the uncertainty of base numbers and sensors account for the deviation ({extent}).",)
    clauses = [effect_words(member, d.best) for member in d.best.members]
    if d.verdict == IDENTIFIED:
        sentences = _joined(clauses, [f"Probability {percent(d.judgement.probability)}."], closing)
        return (*sentences, *again_words(d))
    if d.verdict == CONFOUNDED:
        return _confounded(d, closing)
    clearest = f"What is missing is most clearly {missing_words(d)}."
    partly = [f"Part of the deviation is explained by {' and '.join(member.key for member in d.best.members)}."]
    return (
        "No effect in the catalogue accounts for the deviation.",
        clearest,
        *(partly if clauses else []),
        closing,
    )


def missing_words(d: DiagnosisData) -> str:
    """Heat of unknown origin in one clause: what, where, how much."""
    missing, section = d.missing, d.original.section
    total = float(section.total_thickness([missing.station])[0])
    inside = missing.kind == "heat"
    mean, spread, unit = (
        (missing.heat, missing.heat_sd, "W/m**3") if inside else (missing.flux, missing.flux_sd, "W/m**2")
    )
    at = int(np.abs(missing.stations - missing.station).argmin())
    size = amount(float(mean[:, at].mean()), float(spread[:, at].mean()), unit)
    where = place(section, missing.station, total / 2 if inside else total).split(",")[0]
    kind = (
        f"heat inside the {missing.region} while it rolls"
        if inside
        else "a flux into the outer surface, rolling or not"
    )
    return f"{kind}, {where} (s = {missing.station * 1e3:.0f} mm along the meridian): {size}"


def _confounded(d: DiagnosisData, closing: str) -> tuple[str, ...]:
    rivals, best = contenders(d), d.judgement.best
    held, clauses = support(d, best), " And: ".join(effect_words(member, d.best) for member in best.members)
    if best.members and held >= d.gap.settings.sure:
        first = f"{clauses}: {percent(held)} probable."
        if not d.best.at_bound:
            alone = percent(best.probability)
            first += f" Whether it acts alone, these sensors and runs do not tell ({alone} that it does)."
    else:
        shown = [f"{entry.key} ({percent(support(d, entry))})" for entry in rivals[:4]]
        more = len(rivals) - len(shown)
        shown += [f"one of {more} less probable sets"] if more else []
        first = f"Something is missing, but these sensors and runs cannot tell what: {', or '.join(shown)}."
        if best.members:
            first += f" Most probable: {clauses}."
    if d.best.at_bound:
        first += " The data want it beyond a bound that physics sets, so it is not taken for certain."
    decides = next_words(d)
    return (first, *([decides] if decides else []), closing)


def next_words(d: DiagnosisData) -> str:
    """What would tell the most probable sets apart, in one sentence; empty where nothing is known to."""
    if not d.next_experiment:
        return ""
    sensor = next(iter(d.next_experiment.get("sensors", ())), None)
    drive = next(iter(d.next_experiment.get("drives", ())), None)
    odds = 1.0
    offers = []
    if sensor and sensor["gain"] > odds:
        offers.append(f"a thermocouple at {sensor['place']} (up to {sensor['largest_K']:.1f} K apart)")
    if drive and drive["gain"] > odds:
        offers.append(f"a run at {drive['drive']} (up to {drive['largest_K']:.1f} K apart, {drive['sensor']})")
    between = " and ".join(f"“{key}”" for key in d.next_experiment["between"])
    if not offers:
        return f"No feasible sensor place or drive that was tried would tell {between} apart."
    return f"{' or '.join(offers)} would tell {between} apart best.".capitalize()


def _closing(d: DiagnosisData) -> str:
    if not d.changes:
        return f"The rms of measured - computed is {_kelvin(d, after=False)}; the noise is {d.noise:.1f} K."
    parts = []
    for held_out, name in ((False, "fitted"), (True, "held-out")):
        before, after = d.rms(after=False, held_out=held_out), d.rms(after=True, held_out=held_out)
        if math.isfinite(before):
            parts.append(f"from {before:.1f} to {after:.1f} K on the {name} runs")
    study = "In the amended study" if d.best.members else "With corrections of base numbers and sensors alone"
    going = " and ".join(parts)
    untried = "" if d.gap.held_out else " No run is held out, so nothing was checked on a run that was not fitted."
    return f"{study} the rms of measured - computed goes {going}; the noise is {d.noise:.1f} K.{untried}"


def _kelvin(d: DiagnosisData, *, after: bool) -> str:
    parts = [(d.rms(after=after, held_out=held), name) for held, name in ((False, "fitted"), (True, "held out"))]
    return ", ".join(f"{value:.1f} K {name}" for value, name in parts if math.isfinite(value))


def _joined(clauses: Sequence[str], further: Sequence[str], closing: str) -> tuple[str, ...]:
    return (". And: ".join(clauses) + ". " + " ".join(further), closing)


def again_words(d: DiagnosisData) -> tuple[str, ...]:
    """What further looks at the same data found, one sentence each; none where there was no further look."""
    sentences = []
    for number, diagnosis in enumerate(d.looks[1:], start=2):
        if diagnosis.verdict == NO_GAP:
            sentences.append("The amended study was held against the same data again: no gap is left.")
            continue
        named = f": {diagnosis.judgement.best.key}" if diagnosis.verdict in (IDENTIFIED, CONFOUNDED) else ""
        sentences.append(
            f"The amended study was held against the same data again: {diagnosis.verdict}{named}; see the folder "
            f"{look_folder(number)}."
        )
    return tuple(sentences)


def look_folder(number: int) -> str:
    """Folder of the second, third... look at the same data, within that of the first."""
    return "/".join([AGAIN] * (number - 1))


def shortened(reason: str, most: int = 4) -> str:
    """A reason that lists many things, cut after the first few.

    >>> shortened("cannot tell apart: a; b; c; d", 2)
    'cannot tell apart: a; b; and 2 more'
    """
    parts = reason.split("; ")
    return "; ".join([*parts[:most], f"and {len(parts) - most} more"]) if len(parts) > most + 1 else reason
