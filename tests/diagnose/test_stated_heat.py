"""Heat of unknown origin that a study states itself, as an amended study does: unknowns beside it, and of it."""

from __future__ import annotations

from typing import Any

import pytest

import tyrefem as tf
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, OUTER, patch, stations
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns, with_values

FLUX = {"name": "missing-flux", "into": "-464 W/m**2"}


def stating(**further: Any) -> tf.Study:
    """A study with a flux."""
    return tf.study("example-validation").replace({"effects": [{**FLUX, **further}]})


def width() -> str:
    """Of every patch."""
    return dict(patch(tf.study("example-validation"), DEFAULT, 0.05, OUTER).choice)["width"]


@pytest.mark.parametrize(
    "written",
    [
        {"station": "32 mm", "width": "13 mm"},
        {"station": "0.032 m", "width": "0.013 m", "surface": "outer", "ends": "17 min"},
        {"surface": "tread"},
    ],
)
def test_a_stated_flux_is_fitted_however_it_is_written(written: dict[str, str]) -> None:
    """An entry in millimetres was not recognised, and a second one with the same numbers was refused."""
    study = stating(**written, sd={"into": "100 W/m**2"})
    (flux,) = (unknown for unknown in base_unknowns(study) if unknown.effect == "missing-flux")
    (changed,) = with_values(study, {flux: 64.0}).card.effects
    assert changed.values["into"] == pytest.approx(-400.0)


def flux_at(study: tf.Study, unknown: Unknown, x: float) -> list[float]:
    """The fluxes of a study with an unknown at x."""
    return [effect.values["into"] for effect in with_values(study, {unknown: x}).card.effects]


def test_unknown_heat_adds_to_what_the_study_states_at_its_place() -> None:
    place = {"station": f"{stations(tf.study('example-validation'), DEFAULT)[2]!r} m", "width": width()}
    study = stating(**place, sd={"into": "40 W/m**2"})
    further = patch(study, DEFAULT, float(place["station"].split()[0]), OUTER)
    assert flux_at(study, further, 0.0) == [-464.0]
    assert flux_at(study, further, 64.0) == pytest.approx([-400.0])
    # The data may ask for as much as anywhere, whatever the stated value is known to.
    assert further.sd == DEFAULT.missing_flux


def test_unknown_heat_stands_beside_stated_heat_that_ends() -> None:
    place = {"station": f"{stations(tf.study('example-validation'), DEFAULT)[2]!r} m", "width": width()}
    study = stating(**place, ends="300 s")
    further = patch(study, DEFAULT, float(place["station"].split()[0]), OUTER)
    assert flux_at(study, further, 64.0) == pytest.approx([-464.0, 64.0])
    ending = patch(study, DEFAULT, float(place["station"].split()[0]), OUTER, (("ends", "300.0 s"),))
    assert flux_at(study, ending, 64.0) == pytest.approx([-400.0])


def test_heat_in_one_layer_is_not_that_in_all_layers() -> None:
    entry = {"name": "missing-heat", "station": "0.032 m", "width": "0.013 m", "region": "tread", "heat": "1e4 W/m**3"}
    study = tf.study("example-validation").replace({"effects": [entry]})
    assert not patch(study, DEFAULT, 0.032, ALL_LAYERS).belongs_to(entry)
