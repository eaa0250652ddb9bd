"""`tyrefem new section 205/60R15`: a section or a study from a tyre's size."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tyrefem.cli.common import as_argument
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, notify, say
from tyrefem.errors import InputError

#: Speed of a new study.
SPEED = "60 km/h"


def new_size(kind: str, size: str, numbers: Mapping[str, Any], out: Path | None, *, force: bool) -> None:
    """Write the file of a size. ``numbers``: name -> quantity, in place of the rules' own.

    Raises
    ------
    InputError : no such size or number; the file exists.
    """
    from tyrefem import library
    from tyrefem.geometry import load
    from tyrefem.geometry.named_places import named_places
    from tyrefem.output import atomic_path, place_of_output
    from tyrefem.output.file import results_file
    from tyrefem.schemas.line import schema_line
    from tyrefem.sizes import drawn_of
    from tyrefem.sizes.section import NUMBERS, section_of_size
    from tyrefem.sizes.text import section_text, study_text

    of_use = {key: value for key, value in numbers.items() if key in NUMBERS}
    named = {key: value for key, value in numbers.items() if key not in NUMBERS}
    reference = {"size": size, **of_use, **({"parameters": named} if named else {})}
    with progress(f"{size}: drawing"):
        drawn = drawn_of(reference)
        section = load(reference)  # also checks that the section can be built
    name = re.sub(r"[^\w.]+", "-", drawn.size.text.lower())
    folder = Path(library.FOLDERS[kind])
    target = out or (folder / name / "study.toml" if kind == "study" else folder / f"{name}.toml")
    if kind == "study" and target.suffix.lower() != ".toml":
        target = target / "study.toml"
    if out is None and os.path.lexists(target):
        raise InputError("the file exists already; nothing was written; to replace it: --out FILE --force", file=target)
    if target.is_file() and not force:
        raise InputError("exists and may have been edited; replace it with --force", file=target, field="--out")
    place_of_output(target.parent)
    options = " ".join(f"--set {key}={shlex.quote(str(value))}" for key, value in numbers.items())
    # In one line, as it stands in a comment of the file.
    command = " ".join(f"tyrefem new {kind} {shlex.quote(size)} {options}".split())
    if kind == "section":
        data, over = section_of_size(reference)
        parameters = {**data["parameters"], **over.get("parameters", {})}
        text = section_text(replace(drawn, data={**data, "parameters": parameters}), command)
    else:
        text = study_text(drawn, reference, SPEED, named_places(section))
    with results_file(target, (".toml",), force=force), atomic_path(target) as temporary:
        temporary.write_text(schema_line(kind, target) + text, encoding="utf-8")
    for warning in section.warnings:
        notify(f"warning: {warning}")
    guesses = sum("estimate" in number.source for number in drawn.rules)
    answer_with(
        {
            "kind": kind,
            "file": target,
            "size": drawn.size.text,
            "rules": drawn.size.kind,
            "outer_diameter_m": section.outer_diameter,
            "overall_width_m": section.overall_width,
            "numbers": {number.name: number.text for number in drawn.rules},
            "estimates": guesses,
        }
    )
    say(
        f"{target} written: {drawn.size.text} by the rules of kind {drawn.size.kind}, {len(drawn.rules.numbers)} "
        f"numbers, {guesses} estimates"
    )
    say(
        f"outer diameter {section.outer_diameter * 1e3:.1f} mm, width {section.overall_width * 1e3:.1f} mm on a "
        f"rim {drawn.rules['rim_width'].text} wide"
    )
    shown = as_argument(target)
    say(f"see it: tyrefem show {kind} {shown}" if kind == "section" else f"then: tyrefem press {shown}")
