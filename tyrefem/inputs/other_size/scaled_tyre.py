"""A study and its section for another size of the same kind of tyre."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.geometry import Section, SectionCard, build, load
from tyrefem.inputs.changes import scaled
from tyrefem.inputs.other_size.arcs import DIGITS, scaled_arcs
from tyrefem.inputs.other_size.drive import Ratios, scaled_drive, scaled_mechanics, scaled_rim
from tyrefem.inputs.other_size.notes import Notes
from tyrefem.inputs.other_size.places import carried, same_depth
from tyrefem.inputs.other_size.points import scaled_points
from tyrefem.inputs.other_size.source import OF_SIZE, SourceTyre, source_tyre
from tyrefem.inputs.study import StudyData
from tyrefem.sizes import Drawn, completed_materials, draw_size, parse_size
from tyrefem.sizes.text import section_text, table_lines

#: Numbers of a card that follow the tyre's place.
OF_PLACE = ("angle_radius",)
#: Tables of a study that belong to the tyre that was measured.
MEASURED = ("measured", "cases", "run", "made_for", "published")


@dataclass(frozen=True, eq=False)
class ScaledTyre:
    """The files of a tyre of another size.

    Parameters
    ----------
    name : of both files. size : its size drawn by the rules. section, study : texts of the files.
    notes : what was scaled, kept and dropped, a sentence each.
    """

    name: str
    size: Drawn
    section: str
    study: str
    notes: Notes = field(default_factory=Notes)


def file_name(size: Drawn) -> str:
    """Name of the files of a size.

    >>> file_name(draw_size("225/45R17"))
    'passenger-225-45r17'
    """
    tidy = re.sub(r"[^\w.]+", "-", size.size.text.lower()).strip("-")
    return f"{size.size.kind}-{tidy}"


def scaled_tyre(study: StudyData, size: str, numbers: Mapping[str, Any], command: str) -> ScaledTyre:
    """A study's tyre in another size. ``numbers``: name -> quantity, in place of the rules'. ``command`` made it.

    Raises
    ------
    InputError : another kind of tyre, a section that does not scale, no such size or number.
    """
    wanted = parse_size(size)
    source = source_tyre(study)
    kind = source.drawn.size.kind
    if wanted.kind != kind:
        raise InputError(
            f"{wanted.text} is of kind {wanted.kind}, {study.name} of kind {kind}: its construction does not scale to "
            f"it. Start from a study of kind {wanted.kind}, or: tyrefem new study '{wanted.text}'",
            field="--from",
        )
    notes = Notes()
    probe = draw_size(size, {name: value for name, value in numbers.items() if name in OF_SIZE})
    after = draw_size(size, {**source.given_for(probe), **numbers})
    name, old = file_name(after), _half(study)
    section, new = _section(study, source, after, old, notes, command)
    ratios = Ratios.of(source.rules, after, old, new)
    data = _study(study, source, after, (old, new), ratios, notes, name)
    text = "\n".join(
        [
            f"# {after.size.text} scaled from {study.name}, {source.drawn.size.text}. Written by: {command}",
            *notes.lines,
            "",
            *table_lines(data),
            "",
        ]
    )
    return ScaledTyre(name, after, section, text, notes)


def _half(study: StudyData) -> Section:
    return load(study.data["section"], near=study.folder)


def _section(
    study: StudyData, source: SourceTyre, after: Drawn, old: Section, notes: Notes, command: str
) -> tuple[str, Section]:
    """The section's text, and the section."""
    sizes = f"{source.drawn.size.text} -> {after.size.text}"
    if source.by_rules:
        notes.scale(f"section, {sizes}: line, layers and grooves by the rules of kind {after.size.kind}")
        if kept := source.given_for(after):
            words = ", ".join(f"{name} {value}" for name, value in kept.items())
            notes.scale(f"numbers given for the first tyre, by the ratio of the rules: {words}")
        if lost := [name for name in source.given if name in OF_SIZE]:
            notes.drop(f"numbers of the first size: {', '.join(lost)}")
        if source.edited:
            notes.drop(f"changes by hand to the section's file: {', '.join(source.edited)}")
        text = section_text(after, command)
        return text, build(SectionCard.check(after.data))
    data, _, _ = library.load("section", study.data["section"], study.folder)
    by_arcs = data["line"]["kind"] == "two-arcs"
    stretched = (scaled_arcs if by_arcs else scaled_points)(data, old, source.drawn, after)
    new = build(SectionCard.check(stretched))
    notes.scale(
        f"section, {sizes}: {'two arcs' if by_arcs else 'line through points'} stretched to "
        f"{1e3 * new.overall_width:.1f} x {1e3 * new.outer_diameter:.1f} mm; "
        "tables along the meridian with its length; carcass and bead by the plies, tread by the rules' tread"
    )
    if "inner_volume" in data["parameters"]:
        notes.drop("inner_volume of the section: measured")
    head = [f"# {after.size.text} scaled from {old.name}. Written by: {command}", *notes.lines, ""]
    return "\n".join([*head, *table_lines(stretched), ""]), new


def _study(
    study: StudyData,
    source: SourceTyre,
    after: Drawn,
    sections: tuple[Section, Section],
    ratios: Ratios,
    notes: Notes,
    name: str,
) -> dict[str, Any]:
    """The study's data with the section's name."""
    data = copy.deepcopy(dict(study.data))
    data["title"] = f"{after.size.text} scaled from {study.name}"
    section: dict[str, Any] | str = name
    if source.by_rules and source.scales:
        section = {"base": name, "parameters": {"thickness_scale": dict(source.scales)}}
        notes.keep("factors on thickness by region")
    data["section"] = section
    data["materials"] = _materials(study, source, after, notes)
    dropped = [key for key in MEASURED if data.pop(key, None) is not None]
    words = {"measured": f"{len(study.measured)} measured tables", "cases": "the table of cases",
             "made_for": "", "run": "", "published": "published ranges"}  # fmt: skip
    for word in filter(None, (words[key] for key in dropped)):
        notes.drop(f"{word} of the first tyre")
    data["drive"] = scaled_drive(data["drive"], ratios, notes)
    if "mechanics" in data:
        data["mechanics"] = scaled_mechanics(data["mechanics"], ratios, notes)
    rim = data.get("boundaries", {}).get("rim", {})
    if rim.get("law") == "lumped":
        data["boundaries"]["rim"] = scaled_rim(rim, ratios, notes)
    _sensors(data, study, sections, notes)
    mesh = data.get("mesh", {})
    if lost := [key for key in ("file", "names", "axes", "unit") if mesh.pop(key, None) is not None]:
        notes.drop(f"mesh.{lost[0]}: a mesh of the first tyre")
    _effects(data, notes)
    return data


def _materials(study: StudyData, source: SourceTyre, after: Drawn, notes: Notes) -> dict[str, Any]:
    """Cards: the rules' cards follow the size; what the study has of its own stays."""
    cards = completed_materials(study.data["section"], study.data.get("materials", {}))
    if source.by_rules:
        cards = {
            region: _merged(source.drawn.materials.get(region), cards.get(region, card), card)
            for region, card in after.materials.items()
        }
        notes.scale("materials: radii of the cord angles, cords of plies and bead wires by the rules of the size")
    else:
        notes.keep("materials")
        factor = after.rules["outer_diameter"].value / source.drawn.rules["outer_diameter"].value
        moved = {region: _with_places(card, factor) for region, card in cards.items()}
        if moved != cards:
            notes.scale("materials: radii of the cord angles with the outer diameter")
        cards = moved
    return {region: library.located("material", card, study.folder) for region, card in cards.items()}


def _with_places(card: Any, factor: float) -> Any:
    """A card's table with its radii on the tyre times a factor."""
    if not isinstance(card, Mapping):
        return card
    return {
        key: scaled(value, factor, DIGITS) if key in OF_PLACE else _with_places(value, factor)
        for key, value in card.items()
    }


def _merged(base: Any, mine: Any, other: Any) -> Any:
    """``mine``, with what it has from ``base`` replaced by ``other``; a radius on the tyre always is."""
    if mine == base:
        return copy.deepcopy(other)
    if not all(isinstance(part, Mapping) for part in (base, mine, other)):
        return copy.deepcopy(mine)
    keys = [key for key in dict.fromkeys([*mine, *other]) if key in mine or key not in base]
    return {
        key: other[key] if (key in OF_PLACE and key in other) or key not in mine
        else _merged(base.get(key), mine[key], other.get(key))
        for key in keys
    }  # fmt: skip


def _sensors(data: dict[str, Any], study: StudyData, sections: tuple[Section, Section], notes: Notes) -> None:
    old, new = sections
    if data.get("sensors"):
        data["sensors"] = {
            name: carried(study.sensors[name], dict(table), old, new) for name, table in data["sensors"].items()
        }
        notes.scale("sensors: between the same ends of regions along the meridian, in the same layer")
    further = data.get("plan", {}).get("sensors", {})
    for name, place in study.card.plan.sensors.items():
        if place.depth is not None:
            s, depth = same_depth(old, new, place.s, place.depth)
            further[name] = {"s": f"{1e3 * s:.1f} mm", "depth": f"{1e3 * depth:.2f} mm"}


def _effects(data: dict[str, Any], notes: Notes) -> None:
    """Effects of measured runs go with the runs."""
    effects = data.get("effects", [])
    kept = [effect for effect in effects if not effect.get("runs")]
    if len(kept) < len(effects):
        notes.drop(f"{len(effects) - len(kept)} effects of measured runs")
    if kept:
        data["effects"] = kept
        notes.keep("effects, with the first tyre's numbers")
    else:
        data.pop("effects", None)
    uncertainty = data.get("uncertainty", {})
    for key in [key for key in uncertainty if key.startswith(("mechanics.energy", "section."))]:
        uncertainty.pop(key)
        notes.drop(f"uncertainty of {key}")
