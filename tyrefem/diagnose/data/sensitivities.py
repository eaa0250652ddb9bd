"""Sensitivities of the readings of every run to every unknown: the costly part of a diagnosis, independent of data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.reduced_drive import Modes
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.inference.linear_model import DesignMatrix
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.energy_shapes import energy_shapes
from tyrefem.diagnose.unknowns.gauges import gauges
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns, sensor_unknowns
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.variants.answer_store import study_digest

Array = NDArray[np.float64]
Tick = Callable[[str, int, int], None]
#: Responses of the drives of a layout, by study and unknowns: some 20 MB for four drives.
_RESPONSES: Cache[tuple[DriveResponse, ...]] = Cache(size=2)


@dataclass(frozen=True, eq=False)
class Sensitivities(Brief):
    """Computed block means at every drive and their derivatives with respect to every unknown.

    Parameters
    ----------
    drives : drives and sampling of the sensors. unknowns : nuisance unknowns first. nuisance : number of these.
    computed : by drive (n_blocks,) degC on the coarse mesh. correction : by drive (n_blocks,) K, full run minus coarse.
    jacobians : by drive (n_blocks, k), K per unit of x. responses : responses from which the blocks were sampled.
    """

    drives: tuple[DriveSampling, ...]
    unknowns: tuple[Unknown, ...]
    nuisance: int
    computed: tuple[Array, ...]
    correction: tuple[Array, ...]
    jacobians: tuple[Array, ...]
    responses: tuple[DriveResponse, ...] = ()

    @property
    def fitted(self) -> list[int]:
        """Numbers of the fitted drives."""
        return [number for number, drive in enumerate(self.drives) if not drive.hold_out]

    @property
    def held_out(self) -> list[int]:
        """Numbers of the held-out drives."""
        return [number for number, drive in enumerate(self.drives) if drive.hold_out]

    @cached_property
    def whitened(self) -> tuple[Array, ...]:
        """Whitened jacobian of every drive."""
        return tuple(drive.whitened(J) for drive, J in zip(self.drives, self.jacobians, strict=True))

    @property
    def failed(self) -> tuple[Unknown, ...]:
        """Unknowns of effects with which no tyre could be simulated."""
        bad = np.any([np.isnan(J).any(axis=0) for J in self.jacobians], axis=0)
        return tuple(unknown for unknown, is_bad in zip(self.unknowns, bad, strict=True) if is_bad)

    def in_single_runs(self, unknowns: Sequence[Unknown]) -> Sensitivities:
        """With columns of effects in some runs: those of the same effect in all runs, 0 at the drives of other runs."""
        columns = [self.unknowns.index(unknown.everywhere) for unknown in unknowns]
        jacobians = []
        for drive, J in zip(self.drives, self.jacobians, strict=True):
            acts = np.array([unknown.acts_in(drive.run) for unknown in unknowns], dtype=bool)
            jacobians.append(np.hstack([J, np.where(acts, J[:, columns], 0.0)]))
        return replace(self, unknowns=(*self.unknowns, *unknowns), jacobians=tuple(jacobians))

    def with_nuisance(self, unknowns: Sequence[Unknown]) -> Sensitivities:
        """With these unknowns among those that belong to every model; it has unknowns of their keys.

        They may have other priors than these.
        """
        moved_to = {unknown.key: unknown for unknown in unknowns}
        of_model = range(self.nuisance)
        moved = [column for column, unknown in enumerate(self.unknowns) if unknown.key in moved_to]
        first = [column for column in of_model if column not in moved]
        rest = [column for column in range(self.nuisance, len(self.unknowns)) if column not in moved]
        order = [*first, *moved, *rest]
        return replace(
            self,
            unknowns=tuple(moved_to.get(self.unknowns[column].key, self.unknowns[column]) for column in order),
            nuisance=len(first) + len(moved),
            jacobians=tuple(J[:, order] for J in self.jacobians),
        )

    def with_columns(self, unknowns: Sequence[Unknown], columns: Mapping[int, Array]) -> Sensitivities:
        """With other sensitivities to some unknowns at some drives: number of the drive -> (n_blocks, k), K.

        Those that are not finite are left as they are.
        """
        places = [self.unknowns.index(unknown) for unknown in unknowns]
        jacobians = [J.copy() for J in self.jacobians]
        for number, new in columns.items():
            usable = np.isfinite(new).all(axis=0)
            jacobians[number][:, np.array(places)[usable]] = new[:, usable]
        return replace(self, jacobians=tuple(jacobians))

    def without(self, unknowns: Sequence[Unknown]) -> Sensitivities:
        """The sensitivities without the columns of some effects' unknowns."""
        if not unknowns:
            return self
        kept = [column for column, unknown in enumerate(self.unknowns) if unknown not in unknowns]
        jacobians = tuple(J[:, kept] for J in self.jacobians)
        return replace(self, unknowns=tuple(self.unknowns[column] for column in kept), jacobians=jacobians)

    def design(self, numbers: Sequence[int]) -> DesignMatrix:
        """The design matrix of some drives about x = 0."""
        jacobian = np.vstack([self.whitened[number] for number in numbers])
        return DesignMatrix(self.unknowns, self.nuisance, jacobian)


def unknowns_of(
    study: StudyData, measured: Iterable[str], candidates: Members, settings: DiagnosisSettings = DEFAULT
) -> tuple[tuple[Unknown, ...], int]:
    """All unknowns that a diagnosis with these sensors may fit, and the number of nuisance unknowns (the first)."""
    nuisance = (*base_unknowns(study), *sensor_unknowns(study, set(measured)))
    effects = [unknown for each in candidates for unknown in (*each.amplitudes, *each.presence)]
    further = (*patches(study, settings), *energy_shapes(study, settings), *gauges(study, settings))
    return (*nuisance, *effects, *further), len(nuisance)


def shared_responses(
    evaluations: Evaluations, unknowns: tuple[Unknown, ...], tick: Tick | None = None
) -> tuple[DriveResponse, ...]:
    """`responses`, which diagnoses of one layout share; those of a stored diagnosis are not kept."""
    if evaluations.store is not None:
        return responses(evaluations, unknowns, tick)
    model = evaluations.model
    drives = tuple((drive.run, repr(drive.drive)) for drive in model.drives)
    key = study_digest(model.study), drives, model.settings.of_simulations, unknowns
    return _RESPONSES.get(key, lambda: responses(evaluations, unknowns, tick))


def responses(
    evaluations: Evaluations, unknowns: tuple[Unknown, ...], tick: Tick | None = None
) -> tuple[DriveResponse, ...]:
    """The response of every drive: the costly part of a diagnosis, independent of data."""
    model = evaluations.model
    count = len(model.drives)
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if tick:
            tick("sensitivities", done, count)

    near = model.nearby(model.coarse)
    if tick and near is not None:
        tick(f"solving the strain cycle of every drive for {len(near.numbers)} changed numbers", 0, 0)
    questions = [("response", (number, unknowns)) for number in range(count)]
    fine, answers = evaluations.histories_beside(_driven(model), questions, step)
    return tuple(
        _response(evaluations, unknowns, (times, readings), history, slopes, Modes(V))
        for (times, readings, slopes, V), history in zip(answers, fine, strict=True)
    )


def responses_like(
    evaluations: Evaluations, unknowns: tuple[Unknown, ...], like: Sequence[DriveResponse]
) -> tuple[DriveResponse, ...]:
    """Responses with the readings of this model, and with sensitivities and modes of a similar one's; () without them.

    ``like``: responses of the similar model. It may have further unknowns, and other origins of them.
    """
    columns = {unknown.key: column for column, unknown in enumerate(like[0].unknowns)} if like else {}
    if any(unknown.key not in columns for unknown in unknowns) or tuple(like[0].slopes) != evaluations.model.sensors:
        return ()
    kept = [columns[unknown.key] for unknown in unknowns]
    questions = [("base_readings", (number,)) for number in range(len(like))]
    fine, readings = evaluations.histories_beside(_driven(evaluations.model), questions)
    return tuple(
        _response(evaluations, unknowns, here, history, np.array(list(near.slopes.values()))[:, :, kept], near.modes)
        for here, history, near in zip(readings, fine, like, strict=True)
    )


def _driven(model: ForwardModel) -> list[StudyData]:
    """The study at every drive."""
    return [model.driven(model.study, number) for number in range(len(model.drives))]


def _response(
    evaluations: Evaluations,
    unknowns: tuple[Unknown, ...],
    here: tuple[Array, Array],
    history: Array,
    slopes: Array,
    modes: Modes,
) -> DriveResponse:
    """A response from tables whose rows are the model's sensors."""
    (times, readings), sensors = here, evaluations.model.sensors
    correction = np.array([np.interp(times, history[0], fine) for fine in history[1:]]) - readings

    def by_sensor(table: Array) -> dict[str, Array]:
        return dict(zip(sensors, table, strict=True))

    return DriveResponse(unknowns, times, by_sensor(readings), by_sensor(correction), by_sensor(slopes), modes)


def sensitivities(
    drives: Sequence[DriveSampling],
    unknowns: tuple[Unknown, ...],
    nuisance: int,
    responses: Sequence[DriveResponse],
) -> Sensitivities:
    """The responses of drives, sampled at the readings of their sensors.

    Raises
    ------
    InputError : the responses belong to other unknowns.
    """
    if any(response.unknowns != unknowns for response in responses):
        raise InputError("the given responses belong to another study or to other sensors")
    computed, correction, jacobians = zip(
        *(response.blocks(drive) for response, drive in zip(responses, drives, strict=True)), strict=True
    )
    return Sensitivities(tuple(drives), unknowns, nuisance, computed, correction, jacobians, tuple(responses))
