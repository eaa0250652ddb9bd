"""A diagnosis fits the stiffness that cards are unsure of: one unknown for a card, few solutions for its cycles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.compare.experiment import experiments
from tyrefem.diagnose.amend import Change, amended
from tyrefem.diagnose.data.runs import measured_drive
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.unknowns.unknown import base_unknowns, with_values

STIFF = {"relative_sd": 0.2}
SHARED = {f"materials.{entry}": {"base": "nasa-tread", "shear_modulus": STIFF} for entry in ("tread", "sidewall")}
SHORT = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "120 s", **SHARED}
KEY = "materials.tread.shear_modulus.value"


def study(law: str = "fem") -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**SHORT, "mechanics.strain": law, "mechanics.motion": "linear"})


def test_a_card_in_two_regions_is_one_unknown_and_amended_in_both() -> None:
    arcs = study("arcs")
    (unknown,) = [entry for entry in base_unknowns(arcs) if "shear_modulus" in entry.key]
    assert unknown.keys == (KEY, KEY.replace("tread", "sidewall"))
    assert unknown.label == f"{KEY} (also sidewall)"
    moved = with_values(arcs, {unknown: np.log(1.1)})
    new = amended(arcs, [Change(unknown, float(np.log(1.1)), 0.05, False, "a test")])
    for result in (moved, new):
        for region in ("tread", "sidewall"):
            modulus = result.materials[region].shear_modulus
            assert modulus.value == pytest.approx(1.1 * arcs.materials[region].shear_modulus.value, rel=1e-3)
    assert new.materials["sidewall"].shear_modulus.relative_sd == pytest.approx(0.05)
    assert new.materials["sidewall"].shear_modulus.source.startswith("factor 1.10 ±")
    (again,) = [entry for entry in base_unknowns(new) if "shear_modulus" in entry.key]
    assert set(again.keys) == set(unknown.keys)


def test_fits_solve_no_strain_cycle_for_each_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from tyrefem.mechanics.solid import inflation

    fem = study().replace({"uncertainty": {"drive.load": "3 %"}})
    readings = fem.run().readings
    pd.DataFrame({"time [s]": readings["time_s"], "crown-inner [degC]": readings["crown-inner"]}).to_csv(
        tmp_path / "run.csv", index=False
    )
    model = ForwardModel(
        fem, tuple(measured_drive(unknown, fem).sampling for unknown in experiments(fem, tmp_path / "run.csv"))
    )
    unknowns = base_unknowns(fem)
    stiff, load = (next(unknown for unknown in unknowns if unknown.key == key) for key in (KEY, "drive.load"))
    solved: list[Any] = []
    inflate = inflation.inflate

    def counted(*given: Any, **options: Any) -> Any:
        solved.append(given)
        return inflate(*given, **options)

    monkeypatch.setattr(inflation, "inflate", counted)
    here = model.predict(0, {})
    rng = np.random.default_rng(1)
    points = [{unknown: float(rng.normal(0, unknown.sd)) for unknown in (stiff, load)} for _ in range(4)]
    result = [model.predict(0, point) for point in points]
    slopes = model.jacobian(0, (stiff, load), points[0])
    # The study's own on the mesh of the fit, and one with each of the two numbers moved (the load needs no inflation).
    assert len(solved) == 2
    exact = [ForwardModel(with_values(fem, point), model.drives).predict(0, {}) for point in points[:2]]
    rise = float(here.max() - here.min())
    for fast, other in zip(result, exact, strict=False):
        assert float(np.abs(fast - other).max()) < 0.01 * rise
    assert np.abs(slopes).max(axis=0).min() > 0.1
