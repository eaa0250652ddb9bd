"""Contracts of the laws that are a table of a file: boundary laws, tan delta laws, friction laws."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from tyrefem.boundaries import Law
from tyrefem.contracts.contract import Contract, finite_run, kept, of_trials, pickles
from tyrefem.contracts.study import quick_study
from tyrefem.errors import InputError
from tyrefem.materials.road_friction import FrictionOnRoad
from tyrefem.materials.tan_delta_law import TEMPERATURES, TanDeltaLaw


def example_of(cls: type[Any]) -> dict[str, Any]:
    """The ``example`` of a law or answer; empty without one.

    Raises
    ------
    InputError : it is no table.
    """
    example = getattr(cls, "example", {})
    if not isinstance(example, Mapping):
        raise InputError(f"must be a table, as example: ClassVar[dict] = {{...}}, not {example!r:.60}", field="example")
    return dict(example)


def example_table(cls: type[Any], name: str) -> dict[str, Any]:
    """A table of a law as in a file: its ``example``, and the first example of every other required field."""
    table = {"law": name, **example_of(cls)}
    for key, field in cls.model_fields.items():
        if field.is_required() and key not in table and field.examples:
            table[key] = field.examples[0]
    if "source" in cls.model_fields:
        table.setdefault("source", "estimate: example of the check")
    return table


def _checked(cls: type[Any], table: Mapping[str, Any]) -> tuple[Any, Contract]:
    words = "its example table is read"
    try:
        return cls.check(table), Contract(words)
    except InputError as error:
        needs = "; give values in example: ClassVar[dict] = {...}" if "missing" in error.message else ""
        return None, Contract(words, f"{error}{needs}")


def boundary_law(cls: type[Law], study_name: str | None = None) -> Iterator[Contract]:
    """Contracts of a boundary law: finite films and temperatures, pickling, a run."""
    table = example_table(cls, _law(cls))
    law, contract = _checked(cls, table)
    yield contract
    if law is None:
        return
    yield from of_trials(law.trials())
    yield pickles(law)
    changes: dict[str, Any] = {f"boundaries.{cls.side}": table}
    if cls.side == "sliding" and not getattr(cls, "rolls", False):
        changes |= _slip(study_name)
    yield finite_run_of(changes, study_name)


def _slip(study_name: str | None) -> dict[str, float]:
    """Slip for the first phase of the study that moves; none where a phase slides already."""
    try:
        study = quick_study(study_name)
    except InputError:
        return {}  # the run says what is wrong with it
    phases = study.card.drive.phases
    moving = next((phase.name for phase in phases if not phase.stands), None)
    if moving is None or any(phase.slides for phase in phases):
        return {}
    return {f"drive.phases.{moving}.slip_ratio" if "phases" in study.data["drive"] else "drive.slip_ratio": 0.05}


def tan_delta_law(cls: type[TanDeltaLaw], study_name: str | None = None) -> Iterator[Contract]:
    """Contracts of a tan delta law: values over temperature and frequency, vectorised, pickling, a run."""
    table = example_table(cls, _law(cls))
    law, contract = _checked(cls, table)
    yield contract
    if law is None:
        return
    yield from of_trials(law.trials())
    yield kept("many temperatures at once give the same as each alone", lambda: _alone(law))
    yield kept("it follows the frequency only if of_frequency says so", lambda: _frequency(law))
    yield pickles(law)
    yield finite_run_of({"materials.tread": {"base": "nasa-tread", "loss_tangent": table}}, study_name)


def friction_law(cls: type[FrictionOnRoad], study_name: str | None = None) -> Iterator[Contract]:
    """Contracts of a friction law: values over sliding speed, pressure and temperature, vectorised, pickling."""
    law, contract = _checked(cls, example_table(cls, _law(cls)))
    yield contract
    if law is None:
        return
    yield from of_trials(law.trials())
    yield kept("many points at once give the same as each alone", lambda: _friction_alone(law))
    yield pickles(law)


def finite_run_of(changes: Mapping[str, Any], study_name: str | None) -> Contract:
    """`finite_run` of the quick study with changes, which may be refused."""
    try:
        study = quick_study(study_name, changes)
    except InputError as error:
        return Contract("a study takes it", str(error))
    return finite_run(study)


def _law(cls: type[Any]) -> str:
    from tyrefem.materials.law_of_card import law_name

    return law_name(cls)


def _alone(law: TanDeltaLaw) -> str | None:
    many = np.array(TEMPERATURES, dtype=float)
    for together, point in zip(law(many), many, strict=True):
        alone = float(law(float(point)))
        if not np.isclose(together, alone, rtol=1e-9, atol=0):
            return f"at {point:g} degC it gives {together:.6g} among others, {alone:.6g} alone"
    return None


def _frequency(law: TanDeltaLaw) -> str | None:
    many = np.array(TEMPERATURES, dtype=float)
    slow, fast = (np.broadcast_to(law.tan_delta(many, frequency), many.shape) for frequency in (1.0, 1000.0))
    if not law.depends_on_frequency and not np.allclose(slow, fast, rtol=1e-12, atol=0):
        return "tan_delta differs between 1 and 1000 Hz: write of_frequency: ClassVar[bool] = True"
    return None


def _friction_alone(law: FrictionOnRoad) -> str | None:
    points = np.array([(0.0, 1e5, -20.0), (1e-3, 3e5, 25.0), (0.1, 1e6, 60.0), (1.0, 2e5, 100.0), (10.0, 3e5, 40.0)])
    together = law(*points.T)
    for mu, point in zip(together, points, strict=True):
        alone = float(law(*(float(value) for value in point)))
        if not np.isclose(mu, alone, rtol=1e-9, atol=0):
            at = f"{point[0]:g} m/s, {point[1] / 1e3:g} kPa, {point[2]:g} degC"
            return f"at {at} it gives {mu:.6g} among others, {alone:.6g} alone"
    return None
