"""The fatigue life as an answer of a sweep: `output.life = true`."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.api import Study
from tyrefem.errors import InputError
from tyrefem.variants.answers import answer_names

QUICK = {
    "mesh.size": "14 mm",
    "mechanics.strain": "fem",
    "mechanics.motion": "linear",
    "drive.duration": "60 s",
    "output.every": "20 s",
}


def tyre(**changes: bool) -> Study:
    return study("nasa-22x5.5-8pr", QUICK | {f"output.{key}": value for key, value in changes.items()})


@pytest.mark.fast
def test_only_a_study_that_asks_for_it_has_a_life() -> None:
    assert not [name for name in answer_names(tyre()) if name.startswith("life")]
    assert "life_log10_km" in answer_names(tyre(life=True))
    with pytest.raises(InputError, match=r"mechanics\.strain"):
        answer_names(study("nasa-22x5.5-8pr", {"output.life": True}))


def test_a_sweep_maps_the_life_over_load_and_ambient() -> None:
    vary = {"drive.load": ["2400 lbf", "2700 lbf"], "drive.ambient": ["15 degC", "35 degC"]}
    design = tyre(life=True).sweep(vary, answers=["life_log10_km"])
    table = design.table.set_index([name for name in design.table.columns if name.startswith("drive.")])
    life = table["life_km"].to_numpy().reshape(2, 2)
    assert (np.diff(life, axis=0) < 0).all()  # load
    assert (np.diff(life, axis=1) < 0).all()  # ambient
    np.testing.assert_allclose(10 ** table["life_log10_km"], table["life_km"], rtol=1e-9)
    alone = tyre().replace({"drive.load": "2700 lbf", "drive.ambient": "35 degC"}).life()
    assert life[1, 1] == pytest.approx(alone.shortest, rel=1e-3)
