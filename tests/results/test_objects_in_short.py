"""What a person sees who types a name in an interactive session: at most 20 lines, and the numbers that matter."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import skfem

import tyrefem as tf
from tyrefem.heating_test.grid import Fineness
from tyrefem.heating_test.readings import matched
from tyrefem.reduced.surrogate import surrogate
from tyrefem.rig import identify, load, simulate
from tyrefem.variants.plan import plan_of

QUICK = {"mesh.size": "12 mm", "drive.duration": "60 s"}


def study() -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", QUICK)


def problem() -> tf.Conduction:
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0.30, 0.35, 60), np.linspace(0, 0.01, 30))
    named = mesh.with_subdomains({"wall": lambda x: x[0] > 0}).with_boundaries({"inside": lambda x: x[0] < 0.3001})
    return tf.Conduction(named, {"wall": tf.Material(1.0, 2e6)}, {"inside": tf.Film(20.0, 100.0)}, {"wall": 1e4})


def identification() -> Any:
    card, _ = load("trtlab")
    phases = card.phases.model_copy(update={"heating": 150.0, "cooling": 0.0})
    card = card.model_copy(update={"runs": {"high": card.runs["high"]}, "phases": phases})
    coarse = Fineness(2, 5, 2)
    runs = simulate(card, every=10.0, seed=7, fineness=coarse).runs.values()
    return identify(card, tests=[matched(card, run, list(card.sensors)) for run in runs], fineness=coarse)


#: What the design's interface hands to people -> how a small one is made; and a word that its `repr` must have.
OBJECTS: dict[str, tuple[Callable[[], Any], str]] = {
    "study": (study, "sensors"),
    "result": (lambda: study().run(), "hottest"),
    "result of sliding": (lambda: tf.study("nasa-brake-yaw-skid", {"mesh.size": "12 mm"}).run(), "hottest"),
    "comparison": (
        lambda: tf.study("example-validation", {"mesh.size": "12 mm"}).compare(inputs=False),
        "computed - measured",
    ),
    "sweep": (
        lambda: study().sweep(
            {"drive.speed": ["10 mph", "20 mph"]},
            limits={"hottest_degC": {"below": 35}},
            tornado={"tolerances": {"drive.load": "5 %"}},
        ),
        "tornado",
    ),
    "campaign": (lambda: tf.study("nasa-campaign").campaign(), "cases"),
    "mesh": (lambda: study().mesh(), "nodes"),
    "section": (lambda: study().section, "regions"),
    "material": (lambda: study().materials["tread"], "W/m/K"),
    "conduction problem": (problem, "unknowns"),
    "field": (lambda: problem().steady(), "degC"),
    "history": (lambda: problem().transient(np.linspace(0.0, 10.0, 50)), "degC"),
    "pressed tyre": (lambda: study().press(motion="linear"), "deflection"),
    "natural modes": (lambda: study().natural_frequencies([0], 1), "Hz"),
    "reduced model": (
        lambda: surrogate(
            plan_of(study(), {"drive.speed": ("15 mph", "20 mph")}, sample="sobol", count=16), tolerance=0.05
        ),
        "certificate",
    ),
    "rig identification": (identification, "tread.conductivity"),
}


@pytest.fixture(scope="module")
def walked() -> set[type]:
    return set()


@pytest.mark.parametrize("name", OBJECTS)
def test_it_says_what_matters_in_20_lines(
    name: str, speaks_briefly: Callable[[object], set[type]], walked: set[type]
) -> None:
    make, word = OBJECTS[name]
    thing = make()
    walked |= speaks_briefly(thing)
    assert word in repr(thing)


def test_every_public_class_was_among_them(walked: set[type]) -> None:
    """A new public name needs an object above; the conditions of a problem are as short as what they are given."""
    small = {tf.InputError, tf.Flux, tf.Radiation, tf.Fixed, tf.Reservoir}
    public = {getattr(tf, name) for name in tf.__all__ if inspect.isclass(getattr(tf, name))}
    assert public - walked - small == set()
