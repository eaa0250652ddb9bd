"""Names in cards that become names of files."""

from __future__ import annotations

import re
from collections.abc import Iterable

from tyrefem.errors import InputError
from tyrefem.output.device_names import is_device

#: Allowed in such a name.
ALLOWED = 'no / or \\, none of : * ? " < > |, no dot or space at its beginning, 1 to 100 signs'
_NAME = re.compile(r'[^\s./\\:*?"<>|][^/\\:*?"<>|]{0,99}')


def check_file_name(name: str, of: str, field: str, others: Iterable[str] = ()) -> None:
    """Raise `InputError` for a name of something that could not be the name of a file in the results folder.

    ``others`` : names of other files in the same folder.

    >>> check_file_name("crown 2", "layer", "layers.0.name")
    """
    if not _NAME.fullmatch(name) or not name.isprintable():
        message = f"'{name}' is no name of a {of}, which names a file too; allowed: {ALLOWED}"
        raise InputError(message, field=field)
    if is_device(name):
        message = f"'{name}' is no name of a {of}, which names a file too: Windows keeps it for a device"
        raise InputError(message, field=field)
    alike = next((other for other in others if other != name and other.casefold() == name.casefold()), None)
    if alike is not None:
        message = f"'{alike}' and '{name}' differ only in capital letters: on Windows and macOS their files are one"
        raise InputError(message, field=field)
