"""Names that Windows keeps for devices: no file or folder there can have them."""

from __future__ import annotations

import re

#: Also with an ending: ``aux.png`` is no file.
_DEVICE = re.compile(r"(?:con|prn|aux|nul|(?:com|lpt)[1-9]) *(?:\..*)?", re.IGNORECASE | re.DOTALL)


def is_device(name: str) -> bool:
    """Whether a name is one of a device, with or without an ending.

    >>> is_device("aux"), is_device("CON.2"), is_device("auxiliary")
    (True, True, False)
    """
    return _DEVICE.fullmatch(name) is not None
