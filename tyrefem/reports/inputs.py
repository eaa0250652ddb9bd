"""Inputs of a run in its report: boundary laws, mechanics, effects, sources of the section, study file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.reports.card_numbers import card_numbers
from tyrefem.reports.words import motion_words, number

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.study_card import Mechanics
    from tyrefem.mechanics.stored_cycles import PressedCycle


def boundary_rows(study: StudyData) -> list[list[str]]:
    """One row per side: side, law, its description, and its numbers in SI."""
    laws = study.card.boundaries
    rows = []
    rubs = laws.sliding.rolls or any(phase.slides for phase in study.card.drive.phases)
    for side in ("road", "outside_air", "contained_air", "rim", *(["sliding"] if rubs else [])):
        law = getattr(laws, side)
        words = (type(law).__doc__ or "").strip().partition("\n")[0].replace("``", "")
        rows.append([side.replace("_", " "), str(law.law), words, "; ".join(card_numbers(law))])
    return rows


def mechanics_rows(study: StudyData, cycle: PressedCycle | None = None) -> list[list[str]]:
    """Name and value of every setting of strain and load; ``cycle``: a strain cycle by finite elements of the run."""
    mechanics = study.card.mechanics
    law, energy = mechanics.load_law, mechanics.energy if mechanics.strain == "given" else None
    rows = [
        ["strain cycle", mechanics.strain],
        _load(study)
        if strain_law(study).presses
        else ["load and deflection", "; ".join([str(law.law), *card_numbers(law)])],
        *_motion(study, cycle),
        ["loss convention", mechanics.loss_convention],
        *_feedback(mechanics, rolls=study.card.boundaries.sliding.rolls),
    ]
    if energy is not None:
        load = f"{number(energy.load)} N, {number(energy.pressure / 1e3)} kPa"
        rows.append(["strain energy given for", f"{load}; {energy.source}"])
        for region, table in energy.regions.items():
            places = (f"{number(u / 1e3)} at s = {number(s * 1e3)} mm" for s, u in table)
            rows.append([f"U of {region} [kJ/m³]", number(table[0][1] / 1e3) if len(table) == 1 else ", ".join(places)])
        return rows
    if mechanics.strain != "arcs":
        return rows
    return [
        *rows,
        ["Poisson term c_a", number(mechanics.poisson_term)],
        ["membrane shear", "counted" if mechanics.membrane_shear else "left out"],
    ]


def _load(study: StudyData) -> list[str]:
    """Row on load and deflection for a strain law that computes them by pressing the tyre."""
    words = "by finite elements, with footprint and rolling radius; the study's load law and footprint law are not used"
    if any(effect.name in ("pressure-rise", "pressure-loss") for effect in study.effects):
        words += ", except for the change of deflection by effects on the pressure"
    return ["load and deflection", words]


def _motion(study: StudyData, cycle: PressedCycle | None) -> list[list[str]]:
    """Row on the footprint's motion, with what a linear one leaves out; none if the law does not press the tyre."""
    if not strain_law(study).presses:
        return []
    motion = study.card.mechanics.motion
    error = cycle.linearisation_error if cycle is not None and motion == "linear" else None
    return [["motion of the footprint", motion_words(motion, error)]]


def _feedback(mechanics: Mechanics, *, rolls: bool) -> list[list[str]]:
    choice = mechanics.feedback
    if choice is None:
        return []
    parts = ((choice.pressure, "pressure"), (choice.modulus, "modulus"), (choice.friction and rolls, "friction"))
    acting = [text for on, text in parts if on]
    return [["feedback of temperature", f"{', '.join(acting) or 'nothing'}, within {number(choice.tolerance)} K"]]


def effect_rows(study: StudyData) -> list[list[str]]:
    """One row per active effect: name, sentence, values with standard deviations, and their source."""
    rows = []
    for effect in study.effects:
        values = [f"{name} {text}" for name, text in effect.choice.items()]
        values += [f"only in {', '.join(effect.runs)}"] if effect.runs else []
        for parameter in effect.parameters():
            sd = f" ± {effect.sd[parameter.name]}" if parameter.name in effect.sd else ""
            values.append(
                f"{parameter.name.replace('_', ' ')} {parameter.prior.text(getattr(effect, parameter.name))}{sd}"
            )
        rows.append([effect.name, effect.sentence, "; ".join(values), effect.provenance or "the study"])
    return rows


def section_sources(study: StudyData) -> list[list[str]]:
    """Tables of the section's card and their sources."""
    from tyrefem import library

    data, _, _ = library.load("section", study.data["section"], study.folder)
    return [[where, source] for where, source in _sources(data, "")]


def _sources(data: Any, where: str) -> Iterator[tuple[str, str]]:
    if isinstance(data, Mapping):
        label = f"{where} {data['name']}" if isinstance(data.get("name"), str) and where else where
        for key, value in data.items():
            if key == "source":
                yield label or "section", str(value)
            else:
                yield from _sources(value, f"{label}, {key}" if label else key.replace("_", " "))
    elif isinstance(data, list):
        for entry in data:
            yield from _sources(entry, where)


def study_text(study: StudyData) -> tuple[str, bool]:
    """The study's file and True; if values were changed, the study as it was run and False."""
    file = study.file_read
    if file is not None and file.is_file():
        text = file.read_text(encoding="utf-8-sig")
        try:
            if tomllib.loads(text) == dict(study.data):
                return text, True
        except tomllib.TOMLDecodeError:
            pass  # edited since the run: show the study that was run
    import tomli_w

    return tomli_w.dumps(dict(study.data)), False
