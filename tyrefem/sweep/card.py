"""The sweep file: which numbers of a study vary, how they are sampled, what the answers must keep to."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from tyrefem.cards import Card, Temperature, Text
from tyrefem.errors import InputError

#: Ways of choosing variants.
SAMPLES = ("grid", "latin-hypercube", "sobol", "list")
#: Values of a continuous quantity in a grid, where the file does not say.
LEVELS = 5


class VaryCard(Card):
    """How one dotted name of the study varies: listed values, a range, or a factor on what the study says.

    >>> VaryCard.check({"from": "10 mph", "to": "40 mph", "levels": 4}).levels
    4
    """

    kind: ClassVar[str] = "sweep"
    values: list[Any] | None = None
    low: str | float | None = Field(default=None, alias="from")
    high: str | float | None = Field(default=None, alias="to")
    factor: tuple[float, float] | None = None
    levels: Annotated[int, Field(ge=2, le=10_000)] = LEVELS
    scale: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _one_way(self) -> VaryCard:
        ranged = self.low is not None or self.high is not None
        if (self.values is not None) + ranged + (self.factor is not None) != 1:
            raise InputError("give one of 'values', 'from' with 'to', or 'factor'")
        if ranged and (self.low is None or self.high is None):
            raise InputError("'from' and 'to' go together")
        if self.values is not None and not self.values:
            raise InputError("needs at least one value", field="values")
        if self.factor is not None and not 0 < self.factor[0] < self.factor[1]:
            raise InputError(f"must be two rising positive numbers, not {list(self.factor)}", field="factor")
        return self


class LimitCard(Card):
    """What an answer must keep to, in the answer's own unit (`hottest_degC` in degC)."""

    kind: ClassVar[str] = "sweep"
    below: float | None = None
    above: float | None = None

    @model_validator(mode="after")
    def _some(self) -> LimitCard:
        if self.below is None and self.above is None:
            raise InputError("give 'below', 'above' or both")
        if self.below is not None and self.above is not None and self.below <= self.above:
            raise InputError(f"nothing is below {self.below:g} and above {self.above:g}")
        return self


class SweepCard(Card):
    """A sweep file.

    Parameters
    ----------
    study : name or path (relative to the file). change : values changed first, for every variant.
    sample : how variants are chosen; ``count`` of them (Latin hypercube, Sobol), ``seed``; ``cases``: CSV (list).
    vary : dotted name -> how it varies. limits : answer -> what it must keep to.
    time_to : temperature whose first reaching is an answer (``time_to_limit_s``).
    """

    kind: ClassVar[str] = "sweep"
    title: str = ""
    study: Text
    change: dict[str, Any] = Field(default_factory=dict)
    sample: Literal["grid", "latin-hypercube", "sobol", "list"] = "grid"
    count: Annotated[int, Field(ge=1, le=10_000_000)] | None = None
    seed: Annotated[int, Field(ge=0)] = 1
    cases: str | None = None
    vary: dict[str, VaryCard] = Field(default_factory=dict)
    limits: dict[str, LimitCard] = Field(default_factory=dict)
    time_to: Temperature | None = None

    @field_validator("vary", mode="before")
    @classmethod
    def _quoted(cls, data: Any) -> Any:
        """TOML reads ``drive.speed = {...}`` as nested tables: both spellings are one name."""
        return flat(data) if isinstance(data, dict) else data

    @model_validator(mode="after")
    def _fits(self) -> SweepCard:
        if self.sample == "list":
            if self.cases is None:
                raise InputError("sample = 'list' needs a CSV file of cases", field="cases")
            if self.vary:
                raise InputError("sample = 'list' takes its values from 'cases' alone", field="vary")
            return self
        if self.cases is not None:
            raise InputError("goes with sample = 'list'", field="cases")
        if not self.vary:
            raise InputError("nothing varies; e.g. \"drive.speed\" = { from = '10 mph', to = '40 mph' }", field="vary")
        if self.sample == "grid" and self.count is not None:
            raise InputError("a grid has as many variants as its levels make; give 'levels' in [vary]", field="count")
        if self.sample != "grid" and self.count is None:
            raise InputError(f"sample = '{self.sample}' needs a number of variants", field="count")
        return self


def flat(data: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Nested tables as dotted names, down to the tables that say how to vary.

    >>> flat({"drive": {"speed": {"from": "1 m/s", "to": "2 m/s"}}})
    {'drive.speed': {'from': '1 m/s', 'to': '2 m/s'}}
    """
    known = {"values", "from", "to", "factor", "levels", "scale"}
    found: dict[str, Any] = {}
    for key, value in data.items():
        name = f"{before}.{key}" if before else key
        if isinstance(value, dict) and value and not known & set(value):
            found |= flat(value, name)
        else:
            found[name] = value
    return found


def read(path: Path) -> SweepCard:
    """A sweep file, validated."""
    from tyrefem.cards import read_toml

    return SweepCard.check(read_toml(path), path)
