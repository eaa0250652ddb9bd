"""`tyrefem new effect` and the like: a short Python file of an own effect, law or answer."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError

#: Kinds of plugins with a template.
PLUGINS = ("effect", "boundary-law", "tan-delta-law", "strain-law", "friction-law", "sweep-answer")
#: Folder of new plugins, in this one.
FOLDER = Path("plugins")


def new_plugin(kind: str, name: str, out: Path | None, *, force: bool) -> None:
    """Write the template of a plugin, under a name or that of its example."""
    from tyrefem.contracts.template import TEMPLATES, check_free, file_name, template
    from tyrefem.interruption import interruption_delayed
    from tyrefem.output import atomic_path, place_of_output
    from tyrefem.output.file import results_file

    name = name or TEMPLATES[kind]
    text = template(kind, name)
    check_free(kind, name)
    target = out or FOLDER / file_name(name)
    if os.path.lexists(target) and not (out is not None and force):
        hint = "; replace it with --force" if out is not None else "; nothing was written"
        raise InputError(f"the file exists already{hint}", file=target)
    place_of_output(target.parent)
    with results_file(target, (".py",), force=force), interruption_delayed(), atomic_path(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    answer_with({"kind": kind, "file": target})
    say(
        f"{target} written, the {kind.replace('-', ' ')} '{name}'",
        f"edit it, then: tyrefem check {shlex.quote(str(target))}",
        f"studies know it by: export TYREFEM_PLUGINS={shlex.quote(str(target.parent.resolve()))}",
    )
