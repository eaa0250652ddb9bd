"""The schema of every kind of file that a person writes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tyrefem import library
from tyrefem.effects import catalogue
from tyrefem.geometry.card import SectionCard
from tyrefem.heating_test.card import RigCard
from tyrefem.inputs.study_card import StudyCard
from tyrefem.lumped.card import ThermalCard
from tyrefem.materials.card import MaterialCard
from tyrefem.mechanics.strain_laws import strain_laws
from tyrefem.schemas.draft import DRAFT, Schema, hoisted, table_schema
from tyrefem.schemas.references import dotted, names_of, partial, section_reference, with_changes
from tyrefem.sweep.question import sweep_questions
from tyrefem.variants.card import SweepCard, VaryCard


def material_schema() -> Schema:
    """``materials/NAME.toml``."""
    return _of_file(table_schema(MaterialCard), "A tyrefem material card", "docs/studies.md")


def section_schema() -> Schema:
    """``geometry/NAME.toml``."""
    return _of_file(table_schema(SectionCard), "A tyrefem section", "docs/sections-and-meshes.md")


def rig_schema() -> Schema:
    """``rig.toml``."""
    return _of_file(table_schema(RigCard), "A tyrefem laser rig", "docs/rig.md")


def thermal_schema() -> Schema:
    """``thermal.toml``."""
    return _of_file(table_schema(ThermalCard), "A tyrefem thermal card", "docs/thermal-card.md")


def study_schema() -> Schema:
    """``study.toml``, with the names of sections, materials, effects and laws that there are."""
    study = table_schema(StudyCard)
    keys = study["properties"]
    section = section_reference(library.names("section"), table_schema(SectionCard))
    keys["section"] = {**_words(keys["section"]), **section}
    material = with_changes(library.names("material"), table_schema(MaterialCard), "material")
    keys["materials"] = {**_words(keys["materials"]), "type": "object", "additionalProperties": material}
    keys["made_for"] = {**_words(keys["made_for"]), **names_of(library.names("section"), "Made for")}
    mechanics = keys["mechanics"]["allOf"][0]["properties"]
    mechanics["strain"] = {**mechanics["strain"], "enum": sorted(strain_laws())}
    left_out = keys["diagnosis"]["allOf"][0]["properties"]["exclude"]
    left_out["items"] = {"type": "string", "enum": sorted(catalogue())}
    drive = partial(keys["drive"]["allOf"][0]) if "allOf" in keys["drive"] else partial(keys["drive"])
    of_run = keys["measured"]["items"]["properties"]["drive"]
    of_run.update(drive, patternProperties={r"^phases\..": True}, **_words(of_run))
    return _of_file(study, "A tyrefem study", "docs/studies.md")


def sweep_schema() -> Schema:
    """``sweep.toml``, with the tables of every question that there is."""
    sweep = table_schema(SweepCard)
    keys = sweep["properties"]
    for key, question in sweep_questions().items():
        keys.setdefault(key, {**table_schema(question.table), "title": key.capitalize()})
    keys["study"] = {**_words(keys["study"]), **names_of(library.names("study"), "Study")}
    vary = table_schema(VaryCard)
    leaf = {"anyOf": [{"type": "array", "minItems": 1}, vary]}
    known = set(vary["properties"])
    keys_of_table, varied = dotted(leaf, known, "Vary")
    keys["vary"] = {**_words(keys["vary"]), **keys_of_table}
    tolerance = keys["tornado"]["allOf"][0]["properties"]["tolerances"]
    shares, share = dotted(tolerance.pop("additionalProperties"), (), "Tolerance")
    tolerance.update(shares)
    return _of_file(sweep, "A tyrefem sweep", "docs/sweeps.md", {"Vary": varied, "Tolerance": share})


def _words(schema: Schema) -> Schema:
    return {key: schema[key] for key in ("title", "description") if key in schema}


def _of_file(table: Schema, title: str, page: str, more: dict[str, Any] | None = None) -> Schema:
    """A whole file: draft and title in front, and where to read on."""
    whole = hoisted({**table, "definitions": more} if more else table)
    whole["description"] = f"{whole['description']}\n\nRead on: {page}"
    # The comment line of a file is no key; some editors write "$schema" in place of it.
    return {"$schema": DRAFT, "title": title, **{key: value for key, value in whole.items() if key != "title"}}


#: Name of a schema, and of its file -> the files it is for, and how it is made.
FILES: dict[str, tuple[tuple[str, ...], Callable[[], Schema]]] = {
    "study": (("**/studies/**/study.toml", "**/study.toml"), study_schema),
    "section": (("**/geometry/*.toml",), section_schema),
    "material": (("**/materials/*.toml",), material_schema),
    "sweep": (("**/sweep.toml",), sweep_schema),
    "rig": (("**/rig.toml",), rig_schema),
    "thermal": (("**/thermal.toml",), thermal_schema),
}
