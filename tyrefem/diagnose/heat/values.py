"""Values of the unknowns with sources of missing heat: what the amended study of an unexplained gap gets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tyrefem.diagnose.heat.courses import BEGINS, CONSTANT, ENDS, Course
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.sources import Place
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.heat_patches import patch, written_times
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.study import StudyData

#: Courses that a study file can state.
WRITTEN = (CONSTANT, BEGINS, ENDS)


def source_unknown(study: StudyData, settings: DiagnosisSettings, place: Place, course: Course) -> Unknown:
    """The unknown of an effect `missing-heat` or `missing-flux` with place and course (of `WRITTEN`) of a source."""
    switch = {course.kind: course.time}
    when = written_times(switch.get(BEGINS), switch.get(ENDS))
    return patch(study, settings, place.station, place.where, when)


def values_with_sources(
    data: ProjectedData,
    unknowns: Sequence[Unknown],
    sources: Sequence[tuple[Unknown, Place, Course]],
) -> tuple[dict[Unknown, float], dict[Unknown, float]]:
    """Unknown -> x and its standard deviation, of base numbers, sensors and sources together, within their bounds.

    ``unknowns``: of the columns of ``data.jacobian``. A source has one strength in all runs.
    """
    columns = [place.columns @ course.strength for _, place, course in sources]
    J = np.column_stack([data.jacobian, *columns]) * np.sqrt(data.weight)
    of_sources = [place.sd for _, place, _ in sources]
    free = np.full(len(sources), np.inf)
    low = np.concatenate([[unknown.low for unknown in unknowns], -free])
    high = np.concatenate([[unknown.high for unknown in unknowns], free])
    right = J.T @ (data.data * np.sqrt(data.weight))
    solved = posterior(J.T @ J, right, np.concatenate([data.sd, of_sources]), low, high)
    names = (*unknowns, *(unknown for unknown, _, _ in sources))
    return (
        dict(zip(names, map(float, solved.mean), strict=True)),
        dict(zip(names, map(float, solved.sd), strict=True)),
    )
