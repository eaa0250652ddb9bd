"""`tyrefem new tyre 225/45R17 --from passenger-205-55r16`: a study and its section for another size."""

from __future__ import annotations

import os
import shlex
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from tyrefem.cli.shell import answer_with, notify, say
from tyrefem.errors import InputError, nearest

#: Kind of tyre -> shipped study of that kind.
SHIPPED = {
    "passenger": "passenger-205-55r16",
    "truck": "truck-295-80r22.5",
    "aircraft-bias": "nasa-22x5.5-8pr",
    "aircraft-radial": "aircraft-radial",
}


def new_tyre(size: str, source: str | None, numbers: Mapping[str, Any], out: Path | None, *, force: bool) -> None:
    """Write section and study of a size. ``source``: study; default: the shipped study of the kind.

    Raises
    ------
    InputError : another kind of tyre, no such size or number, a study that cannot be built; the files exist.
    """
    from tyrefem import library
    from tyrefem.api import study
    from tyrefem.inputs.other_size import scaled_tyre
    from tyrefem.interruption import interruption_delayed
    from tyrefem.output import atomic_path, place_of_output
    from tyrefem.output.file import results_file
    from tyrefem.schemas.line import schema_line
    from tyrefem.sizes import parse_size

    kind = parse_size(size).kind
    if source is None and kind not in SHIPPED:
        message = f"no shipped study is of kind {kind}{nearest(kind, SHIPPED)}; or: tyrefem new study '{size}'"
        raise InputError(message, field="--from")
    first = study(source or SHIPPED[kind])
    options = "".join(f" --set {key}={shlex.quote(str(value))}" for key, value in numbers.items())
    command = f"tyrefem new tyre {shlex.quote(size)} --from {shlex.quote(str(source or SHIPPED[kind]))}{options}"
    command = " ".join(command.split())  # in one line, as it stands in a comment of both files
    tyre = scaled_tyre(first, size, numbers, command)
    folder = out or Path()
    files = {
        folder / library.FOLDERS["section"] / f"{tyre.name}.toml": ("section", tyre.section),
        folder / library.FOLDERS["study"] / tyre.name / "study.toml": ("study", tyre.study),
    }
    for target in files:
        if os.path.lexists(target) and not force:
            raise InputError("the file exists already; nothing was written; replace it with --force", file=target)
    warnings = _checked(tyre.name, tyre.section, tyre.study)
    for target in files:
        place_of_output(target.parent)
    with interruption_delayed(), ExitStack() as checked:
        for target in files:
            checked.enter_context(results_file(target, (".toml",), force=force))
        # Both files or none: they are moved to their places at the end.
        with ExitStack() as written:
            for target, (card, text) in files.items():
                temporary = written.enter_context(atomic_path(target))
                temporary.write_text(schema_line(card, target) + text, encoding="utf-8")
    for warning in warnings:
        notify(f"warning: {warning}")
    section, written_study = files
    answer_with(
        {
            "kind": "tyre",
            "file": section,
            "study": written_study,
            "size": tyre.size.size.text,
            "rules": tyre.size.size.kind,
            "numbers": {number.name: number.text for number in tyre.size.rules},
            "notes": tyre.notes.sentences,
        }
    )
    say(*(f"{target} written" for target in files))
    say(*(f"  {sentence}" for sentence in tyre.notes.sentences))
    say(f"then: tyrefem run {shlex.quote(written_study.parent.as_posix())}")


def _checked(name: str, section: str, study_text: str) -> tuple[str, ...]:
    """Read both files as a user will, in a folder that is removed; returns the study's warnings."""
    from tyrefem.api import study

    with tempfile.TemporaryDirectory(prefix="tyrefem-") as temporary:
        place = Path(temporary)
        files = {place / "geometry" / f"{name}.toml": section, place / "studies" / name / "study.toml": study_text}
        for file, text in files.items():
            file.parent.mkdir(parents=True)
            file.write_text(text, encoding="utf-8")
        try:
            made = study(place / "studies" / name)
        except InputError as error:
            raise InputError(f"this size makes no study: {error.message}", field=error.field) from None
        return tuple(str(warning).replace(f"{place}{os.sep}", "") for warning in made.warnings)
