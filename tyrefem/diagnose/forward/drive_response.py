"""Readings at one drive and their sensitivities to unknowns, on an even grid of times."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.forward.reduced_drive import Modes
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DriveResponse(Brief):
    """Readings of a study at one drive and their sensitivities to unknowns, on an even grid of times.

    Parameters
    ----------
    times : (n,) s. readings : sensor -> (n,) degC at x = 0, by the fixed-step simulation.
    correction : sensor -> (n,) K, full run minus fixed-step simulation.
    slopes : sensor -> (n, n_unknowns) d(reading)/dx at x = 0.
    modes : POD modes of the drive's reduced model, from the same tangents.
    """

    unknowns: tuple[Unknown, ...]
    times: Array
    readings: dict[str, Array]
    correction: dict[str, Array]
    slopes: dict[str, Array]
    modes: Modes

    def of(self, unknowns: tuple[Unknown, ...]) -> DriveResponse:
        """The response to some of its unknowns, in their order.

        Raises
        ------
        InputError : the response lacks one of them.
        """
        place = {unknown: column for column, unknown in enumerate(self.unknowns)}
        absent = [unknown.key for unknown in unknowns if unknown not in place]
        if absent:
            raise InputError(
                f"the given responses belong to another study or to other sensors: {absent[0]} is not there"
            )
        columns = [place[unknown] for unknown in unknowns]
        return replace(self, unknowns=unknowns, slopes={name: each[:, columns] for name, each in self.slopes.items()})

    def blocks(self, drive: DriveSampling) -> tuple[Array, Array, Array]:
        """Block means of a drive's sensors: fixed-step readings, correction, slopes (n_blocks, n_unknowns)."""
        parts = [
            [each.sampled(self.times, values[each.sensor]) for each in drive.sensors]
            for values in (self.readings, self.correction, self.slopes)
        ]
        first, second, third = (np.concatenate(part) for part in parts)
        return first, second, third
