"""Methods of a study name every option of the function that does the work, so that completion shows them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.compare.validation import ComparisonOptions
from tyrefem.diagnose.options import DiagnosisOptions
from tyrefem.errors import InputError
from tyrefem.fatigue.life import life
from tyrefem.mechanics.footprint import press as footprint_press
from tyrefem.mechanics.footprint.natural_frequencies import natural_frequencies
from tyrefem.mechanics.rolling import force_table, roll, slip_curve
from tyrefem.mechanics.rolling import press as rolling_press
from tyrefem.mechanics.rolling.wheel_on_road import wheel_on_road
from tyrefem.plan import workflow
from tyrefem.sweep.question import sweep_questions
from tyrefem.variants.card import SweepCard
from tyrefem.variants.execution import ExecutionOptions

pytestmark = pytest.mark.fast

VARIABLE = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)


def named(function: Callable[..., Any]) -> dict[str, Any]:
    """Name -> default of the named parameters, without ``self`` and the study."""
    parameters = inspect.signature(function).parameters.values()
    return {each.name: each.default for each in parameters if each.kind not in VARIABLE and each.name != "study"}


def verb(name: str) -> dict[str, Any]:
    return {key: value for key, value in named(getattr(tf.Study, name)).items() if key != "self"}


#: Long lists: None stands for the function's.
LEFT_TO_THE_FUNCTION = {("tyre_forces", name) for name in ("slip_angles", "slips", "cambers")}
#: Of `wheel_on_road` and `press`, what rolling hands on.
WHEEL = {**named(wheel_on_road), "pressure": None, "drum_diameter": None}
OPTIONS: dict[str, Iterable[str]] = {
    "compare": {"table", "result", *ComparisonOptions.__annotations__},
    "diagnose": {"table", *DiagnosisOptions.__annotations__},
    "plan": {*named(workflow.plan), *DiagnosisOptions.__annotations__},
    "press": {*named(footprint_press.press), *named(rolling_press.press)},
    "roll": {*named(roll.roll), *WHEEL},
    "slip_curve": {*named(slip_curve.slip_curve), *WHEEL},
    "tyre_forces": {*named(force_table.tyre_forces), *WHEEL} - {"load", "deflection", "camber"},
    "natural_frequencies": named(natural_frequencies),
    "life": named(life),
    # ``study`` is the study itself; further questions are tables of their own names.
    "sweep": {*SweepCard.model_fields, *ExecutionOptions.__annotations__} - {"study", "further"},
}


@pytest.mark.parametrize("name", OPTIONS)
def test_a_verb_names_every_option(name: str) -> None:
    assert set(verb(name)) == set(OPTIONS[name])


@pytest.mark.parametrize(
    ("name", "function"),
    [
        ("press", footprint_press.press),
        ("roll", roll.roll),
        ("roll", wheel_on_road),
        ("slip_curve", slip_curve.slip_curve),
        ("tyre_forces", force_table.tyre_forces),
        ("natural_frequencies", natural_frequencies),
        ("life", life),
    ],
)
def test_its_defaults_are_those_of_the_function(name: str, function: Callable[..., Any]) -> None:
    shown = {key: value for key, value in verb(name).items() if (name, key) not in LEFT_TO_THE_FUNCTION}
    assert {key: shown[key] for key, value in named(function).items() if key in shown} == {
        key: value for key, value in named(function).items() if key in shown
    }


def test_only_a_sweep_takes_unnamed_options() -> None:
    """Its further questions may come from a user's file."""
    verbs = [name for name in dir(tf.Study) if not name.startswith("_") and callable(getattr(tf.Study, name))]
    catching = {
        name
        for name in verbs
        if any(each.kind in VARIABLE for each in inspect.signature(getattr(tf.Study, name)).parameters.values())
    }
    assert catching == {"sweep"}
    known = {"tornado", "envelope"}
    assert known <= set(verb("sweep")) & set(sweep_questions())


def test_a_wrong_option_is_refused_at_once() -> None:
    study = tf.study("example-validation")
    with pytest.raises(TypeError, match="largset"):
        study.diagnose(largset=2)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="slipangle"):
        study.roll(slipangle=0.1)  # type: ignore[call-arg]
    with pytest.raises(InputError, match="unknown option 'limit'; did you mean 'limits'"):
        study.sweep({"drive.speed": ["10 mph", "20 mph"]}, limit={})
