"""A section without ``[rating]``: laws that need it say so; finite elements press the tyre without it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.errors import InputError

QUICK = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "10 s", "mechanics.motion": "linear"}


@pytest.fixture
def study(tmp_path: Path) -> tf.Study:
    text = (Path(__file__).parents[2] / "geometry" / "nasa-22x5.5-8pr.toml").read_text(encoding="utf-8")
    before, rating, after = text.partition("[rating]")
    assert rating
    rest = after[after.index("\n[") :] if "\n[" in after else ""
    section = tmp_path / "unrated.toml"
    section.write_text(before + rest, encoding="utf-8")
    return tf.study("nasa-22x5.5-8pr", QUICK | {"section": str(section)})


@pytest.mark.parametrize(
    ("changes", "needs"),
    [
        ({"mechanics.strain": "arcs"}, "the strain law 'arcs' needs"),
        ({"mechanics.strain": "barrel"}, "the load-deflection law 'tr-r-64' needs"),
    ],
)
def test_a_law_that_needs_the_rating_says_so(study: tf.Study, changes: dict[str, Any], needs: str) -> None:
    with pytest.raises(InputError, match=needs) as error:
        study.replace(changes).run()
    assert error.value.field == "section.rating"


def test_finite_elements_and_a_measured_stiffness_do_without(study: tf.Study) -> None:
    assert study.replace({"mechanics.strain": "fem"}).run().rolling_resistance.coefficient > 0
    stiff = {"law": "vertical-stiffness", "stiffness": "300 N/mm", "source": "test"}
    by_stiffness = study.replace({"mechanics.strain": "barrel", "mechanics.load_law": stiff}).run()
    assert by_stiffness.rolling_resistance.coefficient > 0
