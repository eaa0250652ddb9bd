"""Camber that pushes the tyre to the wrong side is a warning of every result that has its forces."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tyrefem.mechanics.rolling.roll import RolledStudy
from tyrefem.mechanics.rolling.slip_curve import SlipCurve

pytestmark = pytest.mark.fast


def wheel(camber: float, side_force: float, motion: str) -> Any:
    """A wheel with this side force straight ahead, N, under 5 kN."""
    return SimpleNamespace(
        rolling=SimpleNamespace(camber=camber),
        free=lambda harmonics: SimpleNamespace(force=(0.0, side_force, 5000.0)),
        pressed=SimpleNamespace(footprint=SimpleNamespace(motion=motion)),
    )


def warnings_of(which: Any) -> list[tuple[str, ...]]:
    state = SimpleNamespace(harmonics=54)
    curve: Any = SimpleNamespace(wheel=which, states=[state])
    point: Any = SimpleNamespace(wheel=which, state=state)
    return [SlipCurve.warnings.fget(curve), RolledStudy.warnings.fget(point)]  # type: ignore[attr-defined]


@pytest.mark.parametrize(("camber", "side_force"), [(0.05, -119.0), (-0.05, 119.0)])
def test_a_push_away_from_the_lean_is_said(camber: float, side_force: float) -> None:
    for (warning,) in warnings_of(wheel(camber, side_force, "linear")):
        assert warning == (
            "at 5000 N camber pushes the tyre away from the side to which it leans; linear motion is too stiff there: "
            "take motion large"
        )
    for (warning,) in warnings_of(wheel(camber, side_force, "large")):
        assert warning == "at 5000 N camber pushes the tyre away from the side to which it leans"


@pytest.mark.parametrize(("camber", "side_force"), [(0.05, 119.0), (0.05, -5.0), (0.0, -119.0)])
def test_a_push_to_the_lean_or_within_the_error_is_not(camber: float, side_force: float) -> None:
    assert warnings_of(wheel(camber, side_force, "linear")) == [(), ()]
