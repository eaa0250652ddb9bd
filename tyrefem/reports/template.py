"""HTML pages from the templates beside this module."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any


def rendered(template: str, **values: Any) -> str:
    """A page from the template of this file name; its texts are escaped, and a value that it misses is an error."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("tyrefem.reports", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template(template).render(**values)


def embedded(pictures: Mapping[str, bytes]) -> dict[str, str]:
    """Name of a picture -> its bytes in base64, for ``data:`` addresses in a page."""
    return {name: base64.b64encode(data).decode("ascii") for name, data in pictures.items()}
