"""The two walks of docs/architecture.md, followed through real runs: short, forwards, and drawn as they are."""

from __future__ import annotations

import ast
import graphlib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
import walks
from hand_overs import Step, Walk
from speed_walk import SPEED, SpeedFollower, SpeedWalks, speed_walks
from thermocouple_walk import ThermocoupleWalk, thermocouple_walk

ROOT = Path(__file__).resolve().parents[2]
#: Modules on a walk at most.
MOST_OF_SPEED, MOST_OF_A_THERMOCOUPLE = 9, 13
#: Where ramps of the drive's motion are read: nobody else reads the drive's speed.
READERS = {"inputs/drive.py", "inputs/motion.py"}
MOTION = {"speed", "slip_speed", "slip_ratio", "slip_angle"}


@pytest.fixture(scope="module")
def speed() -> SpeedWalks:
    return speed_walks()


@pytest.fixture(scope="module")
def thermocouple() -> ThermocoupleWalk:
    return thermocouple_walk()


def test_speed_enters_at_most_nine_modules_none_twice(speed) -> None:
    visits = speed.first.visits
    assert visits[0] == "tyrefem.cards"
    assert visits[-1].startswith("tyrefem.conduction.")
    assert len(visits) <= MOST_OF_SPEED
    assert len(set(visits)) == len(visits)


def test_every_later_heat_source_comes_from_the_same_door(speed) -> None:
    # In a steady phase every further zone asks once.
    assert len(speed.later) >= 4
    tail = speed.first.visits[-3:]
    assert tail[0] == "tyrefem.inputs.motion"
    assert {walk.visits for walk in speed.later} == {tail}


def test_a_thermocouple_enters_at_most_thirteen_modules_forwards_only(thermocouple) -> None:
    modules = thermocouple.modules
    assert modules[0].startswith("tyrefem.measured.")
    assert thermocouple.form(modules[-1]) == "Diagnosis"
    assert 5 < len(modules) <= MOST_OF_A_THERMOCOUPLE


def test_the_page_and_its_picture_are_what_the_code_does(speed, thermocouple) -> None:
    text = walks.PAGE.read_text(encoding="utf-8")
    assert walks.page(text, walks.parts(speed, thermocouple)) == text, "run tools/walks.py"
    assert walks.PICTURE.read_text(encoding="utf-8") == walks.drawing(speed, thermocouple), "run tools/walks.py"


def steps_through(*modules: str) -> tuple[Step, ...]:
    """Steps from each module to the next."""
    return tuple(Step(giver, "f", "number", taker) for giver, taker in pairwise(modules))


def test_a_module_entered_twice_is_seen() -> None:
    steps = steps_through("cards", "drive", "quantity", "quantity", "drive", "conduction")
    assert Walk(steps, "conduction").visits == ("cards", "drive", "quantity", "drive", "conduction")


def test_a_hand_over_backwards_is_seen() -> None:
    forwards = steps_through("table", "runs", "fit", "workflow")
    # A module that is called first stands behind those that it takes from.
    early = (*steps_through("workflow", "workflow"), *forwards, *steps_through("workflow", "api"))
    assert ThermocoupleWalk(early).modules == ("table", "runs", "fit", "workflow")
    with pytest.raises(graphlib.CycleError):
        _ = ThermocoupleWalk((*forwards, *steps_through("workflow", "runs"))).modules


def test_a_function_that_hands_on_is_told_from_a_check_and_from_reading() -> None:
    module: dict[str, object] = {"__name__": "tyrefem.toy", "SPEED": SPEED}
    exec(  # the follower looks at the module that a function stands in
        "def made():\n    return [SPEED]\n"
        "def checked(table):\n    return table\n"
        "def other():\n    return SPEED + 1.0\n",
        module,
    )
    with SpeedFollower() as follower:
        table = module["made"]()  # type: ignore[operator]
        module["checked"](table)  # type: ignore[operator]
        module["other"]()  # type: ignore[operator]
    assert [step.function for step in follower.steps] == ["made"]


def reads_motion(text: str) -> Iterator[str]:
    """Places where a module reads a ramp of the drive's motion by itself, or makes a revolution rate of a radius."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Attribute) and node.attr in ("start", "end", "at", "constant"):
            inner = node.value
            if isinstance(inner, ast.Attribute) and inner.attr in MOTION:
                yield f"{inner.attr}.{node.attr}"
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(".value"):
            yield from (
                f"value({quantity})" for quantity in map(ast.unparse, node.args) if quantity.strip("'") in MOTION
            )
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            below = {inner.attr for inner in ast.walk(node.right) if isinstance(inner, ast.Attribute)}
            if {"pi", "rolling_radius"} <= below and "speed" in ast.unparse(node.left):
                yield ast.unparse(node)


@pytest.mark.parametrize(
    "text",
    ["v = phase.speed.start", "drive.value('speed', t)", "phase.slip_angle.at(0.5)",
     "f = speed / (2 * math.pi * case.rolling_radius)"],
)  # fmt: skip
def test_a_second_door_is_seen(text: str) -> None:
    assert len(list(reads_motion(text))) == 1


def test_nobody_else_reads_the_drive_s_speed() -> None:
    folder = ROOT / "tyrefem"
    places = {
        path.relative_to(folder).as_posix(): list(reads_motion(path.read_text(encoding="utf-8")))
        for path in folder.rglob("*.py")
    }
    assert places["inputs/motion.py"]
    assert not {name: read for name, read in places.items() if read and name not in READERS}
