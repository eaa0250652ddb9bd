from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import pandas as pd


class DesignPart(Protocol):
    """One answer: a table and words. Its folder of finished variants and its files have its ``name``.

    Its pictures are what is registered for its class with `tyrefem.reports.sweep_figures.figures`; a class that sets
    ``drawn = False`` has none.
    """

    name: str
    heading: str

    @property
    def table(self) -> pd.DataFrame:
        """To take away."""
        ...

    @property
    def words(self) -> list[str]:
        """Sentences."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        ...
