"""The same data as another class, which has methods."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import fields
from typing import Any, TypeVar

Data = TypeVar("Data")


_LOG = logging.getLogger(__name__)


def shown(make: Callable[[], str]) -> str | None:
    """HTML for a notebook; None, and so the text of `repr`, where it cannot be made."""
    try:
        return make()
    except Exception as error:
        _LOG.info("no HTML for the notebook: %r", error)
        return None


def with_verbs(kind: type[Data], data: Any, **changes: Any) -> Data:
    """Copy data, with some fields changed, to ``kind``: a subclass of the data's class that has methods."""
    return kind(**({field.name: getattr(data, field.name) for field in fields(data)} | changes))


def given(**options: Any) -> dict[str, Any]:
    """The options that are not None: where None stands, the function called has its default."""
    return {name: value for name, value in options.items() if value is not None}
