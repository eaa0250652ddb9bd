"""Execution of variants: scheduler, folder of finished variants, reduced model, progress."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Integral, Real
from pathlib import Path
from typing import TypedDict

from tyrefem.errors import InputError
from tyrefem.output import as_path
from tyrefem.variants.schedulers import Here, Scheduler

#: Called with (stage, finished, total).
ProgressCallback = Callable[[str, int, int], None]
#: When a reduced model is used.
REDUCED = ("auto", "never", "always")


@dataclass(frozen=True)
class SweepSettings:
    """Numbers of the method; answers depend on them only within the tolerance.

    Parameters
    ----------
    single : up to so many variants, every variant is a separate task. piece : variants of a task, at most.
    fresh : validation runs of a certificate. trials : certificates that are tried. rounds : rounds of corrections
        before the first certificate.

    Raises
    ------
    InputError : no whole number, or one below 1.
    """

    single: int = 2000
    piece: int = 64
    fresh: int = 3
    trials: int = 3
    rounds: int = 3

    def __post_init__(self) -> None:
        for name, number in dataclasses.asdict(self).items():
            if isinstance(number, bool) or not isinstance(number, Integral) or number < 1:
                raise InputError(f"must be a whole number of at least 1, not {number!r:.60}", field=f"settings.{name}")


class ExecutionOptions(TypedDict, total=False):
    """Fields of an `Execution` by name."""

    scheduler: Scheduler | None
    folder: Path | None
    restart: bool
    reduced: str
    tolerance: float
    progress: ProgressCallback | None
    settings: SweepSettings


@dataclass(frozen=True)
class Execution:
    """Execution of a sweep, a search or an envelope; answers depend on it only within ``tolerance``.

    Parameters
    ----------
    scheduler : where variants run (`Here`, `Local`, `Dask`); None: this process.
    folder : for finished variants, to resume from; None: they are not stored. restart : delete its content first.
    reduced : ``never``: full runs only. ``auto``: a certified reduced model for many variants, else full runs.
        ``always``: an error if the reduced model is not certified. tolerance : K, of the certificate.
    progress : called with (stage, finished, total). settings : see `SweepSettings`.

    Raises
    ------
    InputError : an unknown value of ``reduced``; a tolerance that is not positive and finite; what is no
        scheduler, folder or settings.

    >>> Execution().given({"reduced": "never"}).reduced
    'never'
    """

    scheduler: Scheduler | None = None
    folder: Path | None = None
    restart: bool = False
    reduced: str = "auto"
    tolerance: float = 0.01
    progress: ProgressCallback | None = None
    settings: SweepSettings = SweepSettings()

    def __post_init__(self) -> None:
        if self.reduced not in REDUCED:
            raise InputError(f"'{self.reduced}' is not allowed; allowed: {', '.join(REDUCED)}", field="reduced")
        if isinstance(self.tolerance, bool) or not isinstance(self.tolerance, Real):
            raise InputError(f"must be a number of kelvins, not {self.tolerance!r:.60}", field="tolerance")
        if not self.tolerance > 0:
            raise InputError(f"must be positive, not {self.tolerance:g} K", field="tolerance")
        if math.isinf(self.tolerance):
            raise InputError("must be finite: any reduced model would do", field="tolerance")
        if self.scheduler is not None and not hasattr(self.scheduler, "outcomes"):
            raise InputError(f"must be Here, Local or Dask, not {self.scheduler!r:.60}", field="scheduler")
        if self.folder is not None:
            as_path(self.folder, "folder")
        if not isinstance(self.settings, SweepSettings):
            raise InputError(f"must be SweepSettings, not {self.settings!r:.60}", field="settings")

    def given(self, options: ExecutionOptions) -> Execution:
        """The execution with some fields replaced."""
        return dataclasses.replace(self, **options) if options else self

    def within(self, name: str) -> Execution:
        """The execution with a subfolder for its variants, e.g. for one of several questions."""
        return self if self.folder is None else dataclasses.replace(self, folder=self.folder / name)

    @property
    def where(self) -> Scheduler:
        """The scheduler; this process by default."""
        return self.scheduler or Here()

    def report_progress(self, what: str, done: int, total: int) -> None:
        """Call ``progress``, if there is one."""
        if self.progress is not None:
            self.progress(what, done, total)
