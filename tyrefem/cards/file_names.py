"""Names in cards that become names of files."""

from __future__ import annotations

import re

from tyrefem.errors import InputError

#: Allowed in such a name.
ALLOWED = "no / or \\, no dot or space at its beginning, 1 to 100 signs"
_NAME = re.compile(r"[^\s./\\][^/\\]{0,99}")


def check_file_name(name: str, of: str, field: str) -> None:
    """Raise `InputError` for a name of something that could not be the name of a file in the results folder.

    >>> check_file_name("crown 2", "layer", "layers.0.name")
    """
    if not _NAME.fullmatch(name) or not name.isprintable():
        message = f"'{name}' is no name of a {of}, which names a file too; allowed: {ALLOWED}"
        raise InputError(message, field=field)
