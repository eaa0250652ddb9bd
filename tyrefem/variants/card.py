"""The sweep file: the numbers of a study that vary, their sampling, and limits on the answers."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from tyrefem.cards import Card, Temperature, Text
from tyrefem.errors import InputError
from tyrefem.quantity import Unit

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

Sample = Literal["grid", "latin-hypercube", "sobol", "list", "saltelli"]
#: Default number of values of a continuous quantity in a grid.
LEVELS = 5


class VaryCard(Card):
    """How a dotted name of the study varies: listed values, a range, or a factor on the study's value.

    >>> VaryCard.check({"from": "10 mph", "to": "40 mph", "levels": 4}).levels
    4
    """

    kind: ClassVar[str] = "sweep"
    values: list[Any] | None = None
    low: str | float | None = Field(default=None, alias="from")
    high: str | float | None = Field(default=None, alias="to")
    factor: tuple[float, float] | None = None
    levels: Annotated[int, Field(ge=2)] = LEVELS
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
        unused = {"levels", "scale"} & self.model_fields_set
        if self.values is not None and unused:
            raise InputError("goes with a range or a factor, not with 'values'", field=min(unused))
        if self.factor is not None and not 0 < self.factor[0] < self.factor[1] < math.inf:
            raise InputError(f"must be two rising positive numbers, not {list(self.factor)}", field="factor")
        return self


class LimitCard(Card):
    """Limits of an answer, in the unit of the answer (`hottest_degC` in degC)."""

    kind: ClassVar[str] = "sweep"
    below: Annotated[float, Field(allow_inf_nan=False)] | None = None
    above: Annotated[float, Field(allow_inf_nan=False)] | None = None

    @model_validator(mode="after")
    def _some(self) -> LimitCard:
        if self.below is None and self.above is None:
            raise InputError("give 'below', 'above' or both")
        if self.below is not None and self.above is not None and self.below <= self.above:
            raise InputError(f"no value is below {self.below:g} and above {self.above:g}")
        return self


class TornadoCard(Card):
    """Every uncertain number changed alone, down and up by its tolerance.

    ``tolerances``: dotted name -> share of the number. Default: one standard deviation of every number for which cards
    or study state it and that affects the answers. A card's number changes in all regions that use the card.
    """

    kind: ClassVar[str] = "sweep"
    tolerances: dict[str, Annotated[float, Unit("1", gt=0, lt=1)]] = Field(default_factory=dict)

    @field_validator("tolerances", mode="before")
    @classmethod
    def _quoted(cls, data: Any) -> Any:
        return flat(data) if isinstance(data, dict) else data


class OptimiseCard(Card):
    """The smallest (or largest) answer within the varied ranges, under the limits.

    ``runs``: variants evaluated at most. ``seed``: of the search.
    """

    kind: ClassVar[str] = "sweep"
    minimise: Text | None = None
    maximise: Text | None = None
    runs: Annotated[int, Field(ge=20, le=1_000_000)] = 400
    seed: Annotated[int, Field(ge=0)] = 1

    @model_validator(mode="after")
    def _one_aim(self) -> OptimiseCard:
        if (self.minimise is None) == (self.maximise is None):
            raise InputError("give either 'minimise' or 'maximise', the name of an answer")
        return self

    @property
    def answer(self) -> str:
        """The answer that is minimised or maximised."""
        answer = self.minimise or self.maximise
        assert answer is not None
        return answer


class EnvelopeCard(Card):
    """The largest speed, between ``slowest`` and ``fastest``, at which ``answer`` stays below a limit.

    It is computed for every pair of ``loads`` and ``pressures``. Default: shares of the study's load, and the study's
    pressure.
    """

    kind: ClassVar[str] = "sweep"
    below: Annotated[float, Field(allow_inf_nan=False)]
    answer: Text = "hottest_degC"
    loads: tuple[Text, ...] = ()
    pressures: tuple[Text, ...] = ()
    slowest: Text = "1 m/s"
    fastest: Text = "60 m/s"


class SweepCard(Card):
    """A sweep file.

    Parameters
    ----------
    study : name or path (relative to the file). case : of a campaign. change : values changed in every variant.
    sample : sampling method; ``count`` of variants (Latin hypercube, Sobol; Saltelli: the base), ``seed``; ``cases``:
        CSV (list). Default: a grid, or only the optimiser's variants with ``[optimise]``.
    vary : dotted name -> how it varies. link : name -> dotted names that vary together: `tyrefem.variants.links`.
    uncertain : all uncertain numbers that affect the answers vary too, uniformly
        within so many standard deviations; a card's number in all regions that use the card.
    limits : answer -> its limits.
    time_to : temperature; the time at which it is first reached is an answer (``time_to_limit_s``).
    answers : answers in pictures and tables; default: temperature and rolling resistance (and ``time_to_limit_s``).
    pareto : answer -> "min" or "max"; default: temperature, rolling resistance and mass, all "min".
    tornado, optimise, envelope : further questions; ``further``: tables of others, by name (`tyrefem.sweep.question`).
    """

    kind: ClassVar[str] = "sweep"
    title: str = ""
    study: Text
    case: Text | None = None
    change: dict[str, Any] = Field(default_factory=dict)
    sample: Sample | None = None
    count: Annotated[int, Field(ge=1)] | None = None
    seed: Annotated[int, Field(ge=0)] = 1
    cases: str | None = None
    vary: dict[str, VaryCard] = Field(default_factory=dict)
    link: dict[str, tuple[Text, ...]] = Field(default_factory=dict)
    uncertain: Annotated[float, Unit("1", gt=0, le=5)] | None = None
    limits: dict[str, LimitCard] = Field(default_factory=dict)
    time_to: Temperature | None = None
    answers: tuple[Text, ...] = ()
    pareto: dict[str, Literal["min", "max"]] = Field(default_factory=dict)
    tornado: TornadoCard | None = None
    optimise: OptimiseCard | None = None
    envelope: EnvelopeCard | None = None
    further: dict[str, dict[str, Any]] = Field(default_factory=dict)

    @field_validator("vary", mode="before")
    @classmethod
    def _quoted(cls, data: Any) -> Any:
        """Nested tables (TOML's ``drive.speed = {...}``) as dotted names, and lists as ``values``."""
        table = flat(data) if isinstance(data, dict) else data
        if not isinstance(table, dict):
            return table
        return {key: {"values": value} if isinstance(value, list) else value for key, value in table.items()}

    @field_validator("link", mode="before")
    @classmethod
    def _lists(cls, data: Any) -> Any:
        """Refuse anything but names with lists, e.g. a nested table; a name has no dot, so that it is no number."""
        for name, entries in data.items() if isinstance(data, dict) else ():
            if not re.fullmatch(r"[A-Za-z][\w-]{0,59}", str(name)):
                allowed = "letters, digits, - and _, 60 at most"
                raise InputError(f"'{name}' is no name of a link; allowed: {allowed}")
            if not isinstance(entries, list | tuple) or not entries:
                raise InputError("must be a list of dotted names, e.g. ['section.thickness_scale.*']", field=str(name))
        return data

    @field_validator("change")
    @classmethod
    def _dotted(cls, data: dict[str, Any]) -> dict[str, Any]:
        """Refuse a whole table: it would remove the study's other values of the table."""
        for key, value in data.items():
            if "." not in key and isinstance(value, dict):
                raise InputError(f'write dotted names in quotes, e.g. "{key}.{next(iter(value), "...")}" = ...')
        return data

    def load_study(self, near: Path | None, changes: Mapping[str, Any] | None = None) -> StudyData:
        """The study with the file's changes and then other changes; its path may be relative to a folder."""
        from tyrefem.inputs.study import study

        beside = None if near is None else near / self.study
        name = self.study if beside is None or not beside.exists() else str(beside)
        return study(name, {**self.change, **(changes or {})}, self.case)

    @property
    def sampled(self) -> bool:
        """Does the sweep have a sample of variants, apart from a search?"""
        return self.sample is not None or (self.varies and self.optimise is None)

    @property
    def has_grid(self) -> bool:
        """Is the sample a grid, whose size `VaryCard.levels` give?"""
        return self.sampled and self.chosen == "grid"

    @property
    def varies(self) -> bool:
        """Does any number vary?"""
        return bool(self.vary) or self.uncertain is not None

    @property
    def chosen(self) -> Sample:
        """The sampling method."""
        return self.sample or "grid"

    @model_validator(mode="after")
    def _fits(self) -> SweepCard:
        if self.chosen == "list":
            if self.cases is None:
                raise InputError("sample = 'list' needs a CSV file of cases", field="cases")
            if self.varies:
                raise InputError("sample = 'list' takes its values from 'cases' alone", field="vary")
        elif self.cases is not None:
            raise InputError("goes with sample = 'list'", field="cases")
        elif not self.varies and (self.sample or self.optimise or not (self.tornado or self.envelope or self.further)):
            raise InputError("nothing varies; e.g. \"drive.speed\" = { from = '10 mph', to = '40 mph' }", field="vary")
        if self.chosen in ("grid", "list"):
            if self.count is not None:
                made = "levels in [vary]" if self.chosen == "grid" else "rows in the list"
                raise InputError(f"there are as many variants as {made}; only the other samples take it", field="count")
        elif self.count is None:
            raise InputError(f"sample = '{self.sample}' needs a number of variants", field="count")
        self._refuse_unused()
        return self

    def _refuse_unused(self) -> None:
        """Refuse levels without a grid, and a seed without random numbers."""
        if not self.has_grid:
            other = f"sample = '{self.sample}' has none" if self.sampled else "remove them, or add sample = 'grid'"
            for key, entry in self.vary.items():
                if "levels" in entry.model_fields_set:
                    raise InputError(f"levels are those of a grid; {other}", field=f"vary.{key}.levels")
        searches = self.optimise is not None and "seed" in self.optimise.model_fields_set
        if "seed" in self.model_fields_set and self.chosen in ("grid", "list") and not searches:
            search = "; that of the search is optimise.seed" if self.optimise is not None else ""
            raise InputError(f"is of a random sample, which sample = '{self.chosen}' is not{search}", field="seed")


def flat(data: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Nested tables as dotted names, down to the tables with the keys of `VaryCard`.

    >>> flat({"drive": {"speed": {"from": "1 m/s", "to": "2 m/s"}}})
    {'drive.speed': {'from': '1 m/s', 'to': '2 m/s'}}
    """
    known = {"values", "from", "to", "factor", "levels", "scale"}
    flattened: dict[str, Any] = {}
    for key, value in data.items():
        name = f"{before}.{key}" if before else key
        if isinstance(value, dict) and value and not known & set(value):
            flattened |= flat(value, name)
        else:
            flattened[name] = value
    return flattened
