"""The stiffness of cards counts in a comparison: once for every card, solved once for every change."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import tyrefem as tf

SHORT = {"mesh.size": "12 mm", "mesh.element": "P1", "drive.duration": "60 s", "numerics.tolerance": "0.2 delta_degC"}
#: The sidewall takes the tread's card: one number in two regions.
SHARED = {"materials.sidewall": {"base": "nasa-tread", "shear_modulus": {"relative_sd": 0.2}}}
SHARED |= {"materials.tread": {"base": "nasa-tread", "shear_modulus": {"relative_sd": 0.2}}}
KEY = "materials.tread.shear_modulus.value"


def measured(study: tf.Study, folder: Path) -> Path:
    """The study's own readings, 1 K warmer."""
    readings = study.run().readings
    table = pd.DataFrame({"time [s]": readings["time_s"], "crown-inner [degC]": readings["crown-inner"] + 1.0})
    table.to_csv(folder / "run.csv", index=False)
    return folder / "run.csv"


def test_a_shared_stiffness_is_one_input_moved_in_all_its_regions(tmp_path: Path) -> None:
    study = tf.study("nasa-22x5.5-8pr", {**SHORT, **SHARED})
    comparison = study.compare(measured(study, tmp_path))
    rows = comparison.inputs[(comparison.inputs["key"] == KEY) & (comparison.inputs["phase"] == "all")]
    assert rows["regions"].tolist() == ["tread, sidewall"]
    assert "materials.sidewall.shear_modulus.value" not in set(comparison.inputs["key"])
    factor = {f"materials.{item}.shear_modulus.value": "402 psi" for item in ("tread", "sidewall")}
    assert study.materials["tread"].shear_modulus.value == pytest.approx(335 * 6894.757, rel=1e-6)
    both = study.replace(factor).run().readings["crown-inner"] - study.run().readings["crown-inner"]
    assert rows["change_K"].iloc[0] == pytest.approx(float(both.mean()), abs=2e-3)
    assert abs(rows["change_K"].iloc[0]) > 0.02


def test_each_changed_stiffness_costs_one_solution_and_the_rest_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tyrefem.mechanics.footprint.pressed_tyre import REMEMBERED_TYRES
    from tyrefem.mechanics.solid import inflation

    study = tf.study("nasa-22x5.5-8pr", {**SHORT, **SHARED, "mechanics.strain": "fem", "mechanics.motion": "linear"})
    table = measured(study, tmp_path)
    REMEMBERED_TYRES.clear()
    solved: list[Any] = []
    inflate = inflation.inflate

    def counted(*given: Any, **options: Any) -> Any:
        solved.append(given)
        return inflate(*given, **options)

    monkeypatch.setattr(inflation, "inflate", counted)
    comparison = study.compare(table)
    inputs = set(comparison.inputs["key"])
    assert KEY in inputs
    assert len(inputs) == 10
    assert len(solved) == 2
    assert any("10 runs with a changed input; 1 of them change the strain cycle" in note for note in comparison.notes)


def test_what_cannot_matter_is_left_out_in_words(tmp_path: Path) -> None:
    idle = {"materials.bead.shear_modulus": {"value": "1 MPa", "source": "test", "relative_sd": 0.2}}
    study = tf.study("nasa-22x5.5-8pr", {**SHORT, **idle})
    comparison = study.compare(measured(study, tmp_path))
    assert "materials.bead.shear_modulus.value" not in set(comparison.inputs["key"])
    (note,) = [note for note in comparison.notes if "left out" in note]
    assert (
        note
        == "Note: inputs left out, because the strain law 'arcs' does not read them: materials.bead.shear_modulus.value"
    )
    html = comparison.save(tmp_path / "compared").read_text()
    assert "materials.bead.shear_modulus.value" in html
