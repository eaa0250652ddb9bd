"""A temperature among the base numbers: a share of kelvins in the fit, kelvins in words and in the amended study."""

from __future__ import annotations

import math

import pytest

import tyrefem as tf
from tyrefem.diagnose.amend import Change, amended
from tyrefem.diagnose.numbers import correction_words
from tyrefem.diagnose.unknowns.unknown import base_unknowns
from tyrefem.quantity import parse

AMBIENT = "drive.ambient"


@pytest.mark.parametrize("written", ["25 degC", "77 degF", "298.15 K"])
def test_a_correction_of_a_temperature_is_in_kelvins(written: str) -> None:
    study = tf.study("nasa-22x5.5-8pr", {AMBIENT: written, "uncertainty": {AMBIENT: "2 K"}})
    (ambient,) = (unknown for unknown in base_unknowns(study) if unknown.key == AMBIENT)
    x, sd = math.log(301.15 / 298.15), 0.6 / 301.15
    assert ambient.sd == pytest.approx(2 / 298.15)
    assert correction_words(ambient, x, sd) == "ambient +3.0 ± 0.6 K"
    new = amended(study, (Change(ambient, x, sd, False, "test"),))
    assert parse(new.data["drive"]["ambient"], "degC") == pytest.approx(28.0, abs=0.01)


def test_other_base_numbers_are_corrected_in_per_cent() -> None:
    study = tf.study("nasa-22x5.5-8pr", {"uncertainty": {"drive.load": "2 %"}})
    (load,) = (unknown for unknown in base_unknowns(study) if unknown.key == "drive.load")
    assert correction_words(load, math.log(1.03), 0.005) == "load +3.0 ± 0.5 %"
