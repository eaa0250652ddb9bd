"""How variants are answered: where they run, where the finished ones are kept, by what, and who is told."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from tyrefem.errors import InputError
from tyrefem.variants.schedulers import Here, Scheduler

#: Called with (what is done, finished, of how many).
Tick = Callable[[str, int, int], None]
#: When a reduced model answers.
REDUCED = ("auto", "never", "always")


@dataclass(frozen=True)
class SweepSettings:
    """Numbers of the method; no answer depends on them beyond the tolerance.

    Parameters
    ----------
    single : up to so many variants, each is a piece of work of its own. piece : variants of a piece of work, at most.
    fresh : full runs that a certificate is made of. trials : certificates that are tried. rounds : rounds of
        corrections before the first certificate.

    Raises
    ------
    InputError : a number below 1.
    """

    single: int = 2000
    piece: int = 64
    fresh: int = 3
    trials: int = 3
    rounds: int = 3

    def __post_init__(self) -> None:
        for name, number in dataclasses.asdict(self).items():
            if number < 1:
                raise InputError(f"must be at least 1, not {number}", field=f"settings.{name}")


class ExecutionOptions(TypedDict, total=False):
    """Fields of an `Execution` by name."""

    scheduler: Scheduler | None
    folder: Path | None
    restart: bool
    reduced: str
    tolerance: float
    progress: Tick | None
    settings: SweepSettings


@dataclass(frozen=True)
class Execution:
    """How a sweep, a search or an envelope is carried out; its answers do not depend on it beyond ``tolerance``.

    Parameters
    ----------
    scheduler : where variants run (`Here`, `Local`, `Dask`); None: this process.
    folder : where finished variants are kept, to go on from; None: nowhere. restart : forget what it has.
    reduced : ``never``: full runs only; ``auto``: a reduced model where many variants are asked for and it is
        certified, full runs otherwise; ``always``: refuse where it is not certified. tolerance : K, of the certificate.
    progress : called with (what is done, finished, of how many). settings : see `SweepSettings`.

    Raises
    ------
    InputError : another word for ``reduced``; a tolerance that is not positive.

    >>> Execution().given({"reduced": "never"}).reduced
    'never'
    """

    scheduler: Scheduler | None = None
    folder: Path | None = None
    restart: bool = False
    reduced: str = "auto"
    tolerance: float = 0.01
    progress: Tick | None = None
    settings: SweepSettings = SweepSettings()

    def __post_init__(self) -> None:
        if self.reduced not in REDUCED:
            raise InputError(f"'{self.reduced}' is not allowed; allowed: {', '.join(REDUCED)}", field="reduced")
        if not self.tolerance > 0:
            raise InputError(f"must be positive, not {self.tolerance:g} K", field="tolerance")

    def given(self, options: ExecutionOptions) -> Execution:
        """The same, with what is said otherwise."""
        return dataclasses.replace(self, **options) if options else self

    def within(self, name: str) -> Execution:
        """The same for one of several questions: it keeps its variants in a folder of its own."""
        return self if self.folder is None else dataclasses.replace(self, folder=self.folder / name)

    @property
    def where(self) -> Scheduler:
        """Runs variants."""
        return self.scheduler or Here()

    def tick(self, what: str, done: int, total: int) -> None:
        """Tell how far the work is."""
        if self.progress is not None:
            self.progress(what, done, total)
