"""The air outside the tyre."""

from __future__ import annotations

import functools
import itertools
from abc import abstractmethod
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import WithJsonSchema, model_validator

from tyrefem.boundaries import CAL, FILM, SPEEDS, Law
from tyrefem.cards import FilmCoefficient
from tyrefem.cards.plausible import AIR_FILM, FILM_PER_SPEED
from tyrefem.errors import InputError, InputWarning
from tyrefem.plugins import Trial, trial
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import row_schema


class OutsideAirLaw(Law):
    """Film from the outer surface to the ambient, as a function of speed."""

    side: ClassVar[str] = "outside_air"

    @abstractmethod
    def film(self, speed: float) -> float:
        """h, W/m2/K, at a speed in m/s."""

    def trials(self) -> Iterator[Trial]:
        """The film at rest and at speeds."""
        for speed in SPEEDS:
            yield trial(f"film({speed:g} m/s)", functools.partial(self.film, speed), FILM)


class Nasa(OutsideAirLaw):
    """h = 1.3e-4 + 4e-7 V[cm/s] cal/(cm2 s K) = 5.44 + 1.674 V[m/s] W/m2/K (Clark & Dodge 1980, appendix I)."""

    law: Literal["nasa"]
    at_rest: Annotated[FilmCoefficient, AIR_FILM] = 1.3e-4 * CAL
    per_speed: Annotated[float, Unit("W*s/m**3/K", ge=0), FILM_PER_SPEED] = 4e-7 * CAL * 100

    def film(self, speed: float) -> float:
        """h, W/m2/K, at a speed in m/s."""
        return self.at_rest + self.per_speed * speed


class ConstantAirFilm(OutsideAirLaw):
    """The same film at every speed."""

    law: Literal["constant"]
    coefficient: Annotated[FilmCoefficient, AIR_FILM]

    def film(self, speed: float) -> float:
        """h, W/m2/K, at a speed in m/s."""
        return self.coefficient


class AirFilmTable(OutsideAirLaw):
    """Rows ``[speed, film]``; linear between rows, constant beyond the ends."""

    law: Literal["table"]
    table: Annotated[list[list[Any]], WithJsonSchema(row_schema("m/s", "W/m**2/K"))]

    @model_validator(mode="after")
    def _rising(self) -> AirFilmTable:
        self._columns()
        return self

    def warnings(self) -> tuple[InputWarning, ...]:
        """Unlikely films of the table."""
        films = enumerate(self._columns()[1])
        unlikely = [AIR_FILM.warning(film, f"table.{number}") for number, film in films]
        return super().warnings() + tuple(filter(None, unlikely))

    def _columns(self) -> tuple[list[float], list[float]]:
        speeds, films = [], []
        for number, row in enumerate(self.table):
            try:
                if not isinstance(row, list | tuple) or len(row) != 2:
                    raise InputError("a row is [speed, film coefficient]")
                speeds.append(Unit("m/s", ge=0)(row[0]))
                films.append(Unit("W/m**2/K", ge=0)(row[1]))
            except InputError as error:
                raise error.within(field=f"table.{number}") from None
        if len(speeds) < 2 or any(b <= a for a, b in itertools.pairwise(speeds)):
            raise InputError("needs two or more rows whose speeds rise without duplicates", field="table")
        return speeds, films

    def film(self, speed: float) -> float:
        """h, W/m2/K, at a speed in m/s."""
        return float(np.interp(speed, *self._columns()))
