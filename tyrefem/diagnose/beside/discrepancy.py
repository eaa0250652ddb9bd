"""Discrepancy models: what a tyre model may have wrong besides the effects of the catalogue."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.sampling import SensorSampling
from tyrefem.diagnose.inference.shared_error import SharedError
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE
from tyrefem.diagnose.unknowns.gauges import FILM_LAWS
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.name_patterns import SCALES

Array = NDArray[np.float64]
#: What has whitened sensitivities by run.
Known = Residuals | Sensitivities
NONE, ENERGY, HEAT, READINGS = "none", "strain energy", "missing heat", "correlated readings"
#: Name of a discrepancy by another strain law: this and the law's name.
LAW = "strain law "
#: What else may differ beside the strain energy, in words.
FURTHER = ", other gauges and other speed laws of films"
#: Components of a correlated discrepancy with less than this share of the largest one's variance are left out.
SMALLEST = 1e-3


@dataclass(frozen=True, eq=False)
class Discrepancy(Brief):
    """A discrepancy model.

    Parameters
    ----------
    name : of the model. size : K, of a correlated discrepancy of the readings; 0: none.
    nuisance : unknowns that every set has beside the model.
    shared_error : error that readings share; None: none.
    offset : by run (n_blocks,) K, added to the computed temperatures; empty: none.
    width : factor on the prior standard deviations of ``nuisance``, or of missing heat.
    further : speed laws of films and gauges of the section that may differ, too: the first columns of ``shared_error``,
        over their prior standard deviations.
    """

    name: str
    size: float
    shared_error: SharedError | None = None
    nuisance: tuple[Unknown, ...] = ()
    offset: tuple[Array, ...] = ()
    width: float = 1.0
    further: tuple[Unknown, ...] = ()

    def _title(self) -> str:
        return f"{self.name}, {self.size:g} K"

    @property
    def words(self) -> str:
        """What the model allows for, as the object of "with"."""
        if self.name.startswith(LAW):
            return f"the {self.name}"
        words = {
            NONE: "the model as it is",
            ENERGY: f"another strain energy along the meridian{FURTHER if self.further else ''}",
            HEAT: "heat of unknown origin",
            READINGS: "errors of the readings",
        }[self.name]
        if not self.size:
            return words
        errors = "" if self.name == READINGS else ", and errors of the readings"
        return f"{words}{errors} that neighbours in time share ({self.size:g} K)"


def beside_law(residuals: Residuals, law: str, changes: Sequence[Array]) -> Discrepancy:
    """Another strain law, to first order: its changes of the readings by run (K), beside another strain energy too."""
    further = residuals.unknowns[residuals.nuisance :]
    energy = tuple(unknown for unknown in further if unknown.effect == SHAPE)
    of_runs = _of_runs(residuals, energy, residuals.settings.energy_of_run)
    return Discrepancy(f"{LAW}{law}", 0.0, _shared(residuals, [of_runs]), energy, tuple(changes))


def without(discrepancy: Discrepancy, unknowns: Collection[Unknown]) -> Discrepancy:
    """A discrepancy that does not allow for some of its ``further`` unknowns."""
    left_out = [place for place, unknown in enumerate(discrepancy.further) if unknown in unknowns]
    shared = discrepancy.shared_error
    if shared is None or not left_out:
        return discrepancy
    fitted, held_out = (np.delete(columns, left_out, axis=1) for columns in (shared.fitted, shared.held_out))
    further = tuple(unknown for unknown in discrepancy.further if unknown not in unknowns)
    return replace(discrepancy, shared_error=SharedError(fitted, held_out), further=further)


def with_courses(residuals: Residuals, discrepancy: Discrepancy, size: float) -> Discrepancy:
    """A discrepancy with errors of the readings that neighbours in time share too, of ``size`` (K)."""
    known, further = discrepancy.shared_error, _shared(residuals, _courses(residuals, size))
    return replace(discrepancy, size=size, shared_error=further if known is None else known.beside(further))


def discrepancies(residuals: Residuals) -> Iterator[Discrepancy]:
    """The discrepancy models beside which sets of effects are ranked again.

    - strain energy: half waves along the meridian, the same in all runs, fitted with the full model; and a smaller
      part for each run, linear. If that is not enough, gauges of the section and speed laws of films differ, too,
      linear. Priors several times as wide follow a strain energy that is wrong by a factor;
    - missing heat: patches of heat and flux, a part that all runs share and a part for each run, linear; in several
      sizes, because a cause outside the catalogue may heat ten times as much as expected;
    - correlated readings: a course over time for each sensor and run.
    """
    others = residuals.unknowns[residuals.nuisance :]
    energy = tuple(unknown for unknown in others if unknown.effect == SHAPE)
    if energy:
        of_runs = _of_runs(residuals, energy, residuals.settings.energy_of_run)
        widths = (1.0, *residuals.settings.energy_widths)
        further = films_and_gauges(residuals)
        errors = [
            (size, width) for size in residuals.settings.discrepancy_sizes[:2] for width in (widths[0], widths[-1])
        ]
        alone = ((0.0, width) for width in (widths if further else widths[1:]))
        for size, width, more in ((0.0, 1.0, ()), *((*each, further) for each in (*alone, *errors))):
            shapes = tuple(replace(unknown, sd=width * unknown.sd) for unknown in energy)
            parts = [_of_all(residuals, more, 1.0), of_runs, *_courses(residuals, size)]
            yield Discrepancy(ENERGY, size, _shared(residuals, parts), shapes, width=width, further=more)
    if missing_patches(residuals):
        for width in residuals.settings.heat_widths:
            yield missing_heat_beside(residuals, (), width)
    for size in residuals.settings.discrepancy_sizes:
        yield Discrepancy(READINGS, size, _shared(residuals, _courses(residuals, size)))


def with_films_and_gauges(residuals: Residuals, discrepancy: Discrepancy) -> Discrepancy | None:
    """A discrepancy in which gauges of the section and speed laws of films differ, too; None if it has them, or if the
    study has none."""
    more = films_and_gauges(residuals)
    if discrepancy.further or not more:
        return None
    part = _shared(residuals, [_of_all(residuals, more, 1.0)])
    shared = part if discrepancy.shared_error is None else part.beside(discrepancy.shared_error)
    return replace(discrepancy, shared_error=shared, further=more)


def films_and_gauges(residuals: Known) -> tuple[Unknown, ...]:
    """Speed laws of films and gauges among the unknowns of the residuals, in all runs."""
    further = residuals.unknowns[residuals.nuisance :]
    return tuple(
        unknown
        for unknown in further
        if (unknown.effect in FILM_LAWS and not unknown.runs) or unknown.key.startswith(SCALES)
    )


def missing_patches(residuals: Residuals) -> tuple[Unknown, ...]:
    """The patches of missing heat and flux among the unknowns of the residuals."""
    further = residuals.unknowns[residuals.nuisance :]
    return tuple(unknown for unknown in further if unknown.effect in ("missing-heat", "missing-flux"))


def missing_heat_beside(
    residuals: Residuals, sources: Sequence[Unknown], width: float, size: float = 0.0
) -> Discrepancy:
    """Missing heat as a discrepancy; ``sources``: patches that are fitted with the full model, the others are linear.

    ``width``: factor on the prior sd. ``size``: of errors that neighbouring readings share, K; 0: none.
    """
    every = missing_patches(residuals)
    linear = [patch for patch in every if patch not in sources]
    parts = [_of_all(residuals, linear, width), _of_runs(residuals, every, 0.5 * width), *_courses(residuals, size)]
    fitted = tuple(replace(patch, sd=width * patch.sd) for patch in sources)
    return Discrepancy(HEAT, size, _shared(residuals, parts), fitted, width=width)


def other_structure(known: Sensitivities, without: Collection[str] = ()) -> SharedError:
    """Another strain energy, with a smaller part for each run, other gauges, and other speed laws of films; linear.

    ``without``: keys of unknowns that it does not contain.
    """
    further = known.unknowns[known.nuisance :]
    energy = tuple(unknown for unknown in further if unknown.effect == SHAPE)
    others = [unknown for unknown in films_and_gauges(known) if unknown.key not in without]
    return _shared(known, [_of_all(known, (*energy, *others), 1.0), _of_runs(known, energy, DEFAULT.energy_of_run)])


#: Columns of the readings by run.
Columns = dict[int, Array]


def _shared(residuals: Known, parts: Sequence[Columns]) -> SharedError:
    def stacked(runs: Sequence[int]) -> Array:
        return np.hstack([np.vstack([part[number] for number in runs]) for part in parts])

    held_out = residuals.held_out
    width = sum(next(iter(part.values())).shape[1] for part in parts)
    return SharedError(stacked(residuals.fitted), stacked(held_out) if held_out else np.zeros((0, width)))


def _of_all(residuals: Known, unknowns: Sequence[Unknown], share: float) -> Columns:
    """Changes of the readings by one (prior sd x share) of every unknown, which all runs have in common."""
    places = [residuals.unknowns.index(unknown) for unknown in unknowns]
    sd = share * np.array([unknown.sd for unknown in unknowns])
    return {number: J[:, places] * sd for number, J in enumerate(residuals.whitened)}


def _of_runs(residuals: Known, unknowns: Sequence[Unknown], share: float) -> Columns:
    """The same, of every run alone."""
    return _diagonal(_of_all(residuals, unknowns, share))


def _diagonal(parts: Columns) -> Columns:
    """Columns of each run that are zero in the other runs."""
    whole = block_diag(*parts.values())
    ends = np.cumsum([len(part) for part in parts.values()])[:-1]
    return dict(zip(parts, np.split(whole, ends), strict=True))


def _courses(residuals: Residuals, size: float) -> list[Columns]:
    """Smooth courses over time with the standard deviation ``size`` (K), for each sensor and run; none for 0 K."""
    if not size:
        return []
    share = residuals.settings.discrepancy_time
    return [
        _diagonal(
            {
                number: size
                * np.asarray(block_diag(*(readings.whitened(_course(readings, share)) for readings in run.sensors)))
                for number, run in enumerate(residuals.runs)
            }
        )
    ]


def _course(readings: SensorSampling, share: float) -> Array:
    """(n_blocks, k) principal components of a Gaussian process over time, alike over ``share`` of the run."""
    t = readings.block_times
    alike = max(share * float(np.ptp(t)), 1e-9)
    values, vectors = np.linalg.eigh(np.exp(-(((t[:, None] - t[None, :]) / alike) ** 2) / 2))
    kept = values > SMALLEST * values.max()
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))
