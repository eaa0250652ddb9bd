"""What is given to a study's methods in Python: a clear error in place of a failure deep in the mechanics."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.api.numbers import check_numbers
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def coarse() -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {"mesh.size": "15 mm", "drive.duration": "2 s", "output.every": "1 s"})


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("press", {"load": "5 kN"}, r"load: must be a number in N, not '5 kN'; did you mean 5000\?"),
        ("press", {"load": math.inf}, "load: must be finite, not inf"),
        ("press", {"pressure": "much"}, "pressure: must be a number in Pa, not 'much'$"),
        ("press", {"camber": [1.0, 2.0, None]}, "camber: must be a number in rad, not None"),
        ("press", {"tolerance": math.nan}, "tolerance: must be finite, not nan"),
        ("roll", {"slip_angle": "2 deg"}, r"slip_angle: must be a number in rad, not '2 deg'; did you mean 0\.0349"),
        ("roll", {"torque": math.nan}, "torque: must be finite, not nan"),
        ("roll", {"friction": "x"}, "friction: must be a number, not 'x'$"),
        ("slip_curve", {"slip_angle": [0.01, math.nan]}, "slip_angle: must be finite, not nan"),
        ("tyre_forces", {"loads": 5e3}, r"loads: must be a list of numbers in N, not 5000\.0"),
        ("tyre_forces", {"slips": [0.1, math.nan]}, "slips: must be finite, not nan"),
        ("natural_frequencies", {"harmonics": [1.5]}, r"harmonics: must be whole numbers from 0 to 60, not \[1\.5\]"),
        ("natural_frequencies", {"harmonics": 5}, "harmonics: must be whole numbers from 0 to 60, not 5"),
        ("natural_frequencies", {"count": 1.5}, "count: must be a whole number from 1 to 40, not 1.5"),
        (
            "life",
            {"temperature": "80 degC"},
            r"temperature: must be a number in degC, not '80 degC'; did you mean 80\?",
        ),
        ("warmed", {"temperatures": {"tread": 50.0}}, "temperatures: every region needs a temperature; missing: "),
        ("warmed", {"temperatures": {"tred": 50.0}}, "no region 'tred'; did you mean 'tread'"),
        ("at_amplitudes", {"amplitudes": {"tred": 0.1}}, "no region 'tred'; did you mean 'tread'"),
        ("replace", {"changes": None}, "changes must be a table like"),
    ],
)
def test_an_argument_that_cannot_be(coarse: tf.Study, method: str, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        getattr(coarse, method)(**options)


def test_numbers_of_every_kind_pass() -> None:
    check_numbers(load=np.float64(4e3), drum_diameter=math.inf, slips=np.array([0.1]), friction=lambda speed, _: speed)
    check_numbers(slip_angle=(0.1, np.int64(0)), pressure=None, cambers=[])


@pytest.mark.parametrize("changes", [5, {5: "x"}, ["drive.speed"]])
def test_changes_are_a_table_of_dotted_names(changes: Any) -> None:
    with pytest.raises(InputError, match=r"changes must be a table like|is not a dotted name such as drive\.speed"):
        tf.study("nasa-22x5.5-8pr", changes)


def test_a_limit_is_finite(coarse: tf.Study) -> None:
    with pytest.raises(InputError, match=r"limits\.hottest_degC\.below: Input should be a finite number"):
        coarse.sweep({"drive.speed": ["10 mph"]}, limits={"hottest_degC": {"below": math.nan}})


def test_a_result_is_not_saved_in_a_file(coarse: tf.Study, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="a file is in the place of this folder"):
        coarse.run().save(tmp_path / "file")
    assert (tmp_path / "file").read_text() == "mine"
