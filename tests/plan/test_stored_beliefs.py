"""The folder of an earlier diagnosis belongs to one study, also where further looks have folders of their own."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from tyrefem.diagnose.words.set_posteriors import tables
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData, study
from tyrefem.plan.beliefs import stored_beliefs

pytestmark = pytest.mark.fast


def posteriors(diagnosed: StudyData) -> str:
    none: dict[str, Any] = {"effects": [], "outside": False, "probability": 1.0}
    none |= {"unknowns": [], "mean": [], "covariance": []}
    record = {"verdict": "confounded", "tables": tables(diagnosed), "runs": ["A"], "noise_K": {"crown-inner": 0.5}}
    return json.dumps(record | {"sets": [none]})


def test_after_a_second_look_the_folder_still_belongs_to_its_study(tmp_path: Path) -> None:
    stated = study("hidden-effect")
    amended = stated.replace({"effects": [{"name": "hot-road", "warmer_by": "10 delta_degC"}]})
    (tmp_path / "again").mkdir()
    (tmp_path / "posterior.json").write_text(posteriors(stated), encoding="utf-8")
    (tmp_path / "amended.toml").write_text(tomli_w.dumps(dict(amended.data)), encoding="utf-8")
    (tmp_path / "again" / "posterior.json").write_text(posteriors(amended), encoding="utf-8")
    assert stored_beliefs(stated, tmp_path).study.data["effects"] == amended.data["effects"]
    other = study("hidden-effect", {"drive.pressure": "120 psi"})
    with pytest.raises(InputError, match=r"posterior\.json: belongs to another study: \[drive\] differs"):
        stored_beliefs(other, tmp_path)
