"""Numbers that vary together under one name, in every kind of sweep."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from tyrefem import study
from tyrefem.api import Study
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.inputs.changes import value_at
from tyrefem.reduced.shapes import counts_of, shape_numbers
from tyrefem.reduced.surrogate import check_varied, surrogate, why_outside
from tyrefem.variants.plan import plan_of

pytestmark = pytest.mark.fast

TYRE = "nasa-22x5.5-8pr"
COARSE = {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "120 s"}
LOSSES = "materials.*.loss_tangent.value"
REGIONS = ("carcass", "tread", "sidewall", "bead")
BELTS = {"belt_angle": ["section.layers.belt-1.angle", "materials.belt-2.cords.angle"]}


@pytest.fixture(scope="module")
def tyre() -> Study:
    return study(TYRE, COARSE)


@pytest.fixture(scope="module")
def radial() -> Study:
    return study("passenger-205-55r16")


def loss_of(tyre: Study, region: str) -> float:
    return float(value_at(tyre.data, f"materials.{region}.loss_tangent.value", tyre.folder))


def test_one_value_for_several_numbers(radial: Study) -> None:
    plan = plan_of(radial, {"belt_angle": ("20 deg", "28 deg", 3)}, link=BELTS)
    assert [dict(changes) for changes in plan.variants] == [
        {"materials.belt-1.cords.angle": angle, "materials.belt-2.cords.angle": angle}
        for angle in ("20 deg", "24 deg", "28 deg")
    ]
    assert plan.headings == ["belt_angle [deg]"]
    assert plan.row(2) == {"variant": "3", "belt_angle [deg]": 28.0}
    assert plan.settings(2) == {"belt_angle": "28 deg"}


def test_one_factor_on_several_numbers(tyre: Study) -> None:
    """Each number has its own value times the factor; a thickness that no card scales has the factor itself."""
    plan = plan_of(tyre, {"losses": {"factor": [0.5, 2.0], "levels": 2}}, link={"losses": [LOSSES]})
    nominal = {f"materials.{region}.loss_tangent.value": loss_of(tyre, region) for region in REGIONS}
    for changes, factor in zip(plan.variants, (0.5, 2.0), strict=True):
        assert dict(changes) == pytest.approx({key: factor * value for key, value in nominal.items()})
    assert plan.row(1) == {"variant": "2", "losses [x]": 2.0}
    gauges = plan_of(tyre, {"section.thickness_scale.*": {"factor": [1.0, 1.1], "levels": 2}}, sample="grid")
    scales = {key: float(value) for key, value in gauges.variants[1].items()}
    assert scales == {f"section.thickness_scale.{region}": 1.1 for region in REGIONS}
    thick, thin = (tyre.replace(gauges.variants[n]).section.total_thickness([0.02])[0] for n in (1, 0))
    assert thick == pytest.approx(1.1 * thin)


def test_thickness_tables_by_one_factor(tyre: Study) -> None:
    plan = plan_of(tyre, {"section.layers.*.thickness": {"factor": [1.0, 1.2], "levels": 2}})
    new, old = (tyre.replace(plan.variants[n]).section.layers for n in (1, 0))
    for after, before in zip(new, old, strict=True):
        assert after.thickness.values == pytest.approx([1.2 * value for value in before.thickness.values])
    assert plan.row(1)["section.layers.*.thickness [x]"] == pytest.approx(1.2)


def test_shares_and_signs_of_a_value(tyre: Study) -> None:
    links = {"size": ["0.5 * drive.load", "drive.pressure"], "drift": ["sensors.crown-inner.s", "-sensors.x.s"]}
    at_x = tyre.replace({"sensors.x": {"s": "-5 mm", "depth": "2 mm"}, "mesh.section": "full"})
    changes = plan_of(at_x, {"drift": ["6 mm", "8 mm"]}, link={"drift": links["drift"]}).variants[1]
    assert dict(changes) == {"sensors.crown-inner.s": "8 mm", "sensors.x.s": "-8 mm"}
    # A share of a pressure is no load: the study says so.
    with pytest.raises(InputError, match="a variant with size = 10 psi"):
        plan_of(tyre, {"size": ["10 psi", "20 psi"]}, link={"size": links["size"]})


@pytest.mark.parametrize("sample", ["latin-hypercube", "sobol", "saltelli"])
def test_samples_keep_the_numbers_together(tyre: Study, sample: str) -> None:
    box: dict[str, Any] = {LOSSES: {"factor": [0.8, 1.2]}, "drive.speed": ("5 m/s", "15 m/s")}
    plan = plan_of(tyre, box, sample=sample, count=8, seed=3)
    for number, changes in enumerate(plan.variants):
        factor = plan.row(number)[f"{LOSSES} [x]"]
        assert 0.8 <= factor <= 1.2
        for region in REGIONS:
            key = f"materials.{region}.loss_tangent.value"
            assert changes[key] == pytest.approx(factor * loss_of(tyre, region), rel=1e-8)


def test_a_list_of_variants_by_value_and_by_factor(radial: Study, tmp_path: Path) -> None:
    file = tmp_path / "list.csv"
    file.write_text("name,belt_angle [deg],materials.*.loss_tangent.value [x],drive.load\na,24,1.1,4 kN\nb,26,,5 kN\n")
    plan = plan_of(radial, {}, cases=str(file), link=BELTS)
    first, second = plan.variants
    assert first["materials.belt-1.cords.angle"] == first["materials.belt-2.cords.angle"] == "24 deg"
    assert first["materials.tread.loss_tangent.value"] == pytest.approx(1.1 * loss_of(radial, "tread"))
    assert set(second) == {"materials.belt-1.cords.angle", "materials.belt-2.cords.angle", "drive.load"}
    factors = "materials.*.loss_tangent.value [x]"
    assert plan.row(0) == {"variant": "a", "belt_angle": "24 deg", factors: pytest.approx(1.1), "drive.load": "4 kN"}
    assert plan.headings == ["belt_angle", factors, "drive.load"]


def test_uncertain_numbers_of_a_link_vary_once(tyre: Study) -> None:
    key = "materials.carcass.loss_tangent.value"
    assert key in plan_of(tyre, {}, uncertain=1.0, sample="sobol", count=2).variants[0]
    plan = plan_of(tyre, {LOSSES: {"factor": [0.9, 1.1]}}, uncertain=1.0, sample="sobol", count=2)
    assert [key in number.keys for number in plan.varied].count(True) == 1


@pytest.mark.parametrize(
    ("vary", "link", "words"),
    [
        ({"gauge": (1, 2)}, {"gauges": ["section.thickness_scale.*"]}, "no table 'gauge'; did you mean 'gauges'"),
        ({"a": ("20 deg", "30 deg")}, {"a": ["materials.blet-*.cords.angle"]}, "no entry matches 'blet-\\*'; did you"),
        ({"a": {"factor": [0.9, 1.1]}}, {"a": ["materials.belt-*.cords.angel"]}, "angel: not set .*mean 'angle'"),
        ({"a": {"factor": [0.9, 1.1]}}, {"a": ["materials.blet-1.cords.angle"]}, "vary.a: materials.blet-1.*'belt-1'"),
        (
            {"a": ("20 deg", "30 deg")},
            {"a": ["materials.blet-1.cords.angle"]},
            "region 'blet-1'; did you mean 'belt-1'",
        ),
        (
            {"a": ("20 deg", "30 deg")},
            {"a": ["materails.belt-1.cords.angle"]},
            "no table 'materails'; did you mean 'mat",
        ),
        ({"a": (1, 2)}, {"a": ["section.thicknes_scale.*"]}, "did you mean 'section.thickness_scale'"),
        ({"section": (1, 2)}, {"section": ["drive.load"]}, "'section' is a table of the study"),
        ({"by": ["nasa-tread"]}, {"by": ["materials.tread"]}, "link: 'by' is a column of the sweep's table"),
        ({"mass_kg": (1, 2)}, {"mass_kg": ["drive.load"]}, "'mass_kg' is a column of the sweep's table"),
        (
            {"a": ("10 degC", "20 degC")},
            {"a": ["drive.ambient", "0.5*drive.road_temperature"]},
            "link.a: drive.road_temperature: '10 degC' is a temperature: a share of it means nothing",
        ),
        ({"a": (1, 2)}, {"a": []}, "link.a: must be a list of dotted names"),
        ({"a": (1, 2)}, {"a": "drive.load"}, "link.a: must be a list of dotted names"),
        ({"a": (1, 2)}, {"a.b": ["drive.load"]}, "'a.b' is no name of a link"),
        ({"a": ("1 kN", "2 kN")}, {"a": ["-drive.load"]}, "one of the numbers must take the value itself"),
        ({"a": ("1 kN", "2 kN")}, {"a": ["drive.load", "drive.load"]}, "link.a: sets 'drive.load' twice"),
        ({"drive.speed": ["1 m/s"]}, {"a": ["drive.load"]}, "link.a: nothing varies it"),
        ({"a": ("4 kN", "5 kN"), "drive.load": ["4 kN"]}, {"a": ["drive.load"]}, "'a' and 'drive.load' both set"),
        ({"gauges": {"factor": [0.7, 1.0]}}, {"gauges": ["section.thickness_scale.*"]}, "variant with gauges = 0.7 x"),
    ],
)
def test_a_wrong_link_is_one_clear_error(radial: Study, vary: dict[str, Any], link: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        plan_of(radial, vary, link=link)


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        (
            {"drive.load": ("4 kN", "5 kN"), "drive.deflection": ["20 mm"]},
            "vary.drive.deflection: 'drive.load' sets it too",
        ),
        (
            {"drive.phases.fast.speed": ["10 m/s"], "drive.phases.0.speed": ["20 m/s", "30 m/s"]},
            "vary.drive.phases.0.speed: 'drive.phases.fast.speed' sets it too",
        ),
    ],
)
def test_names_of_which_one_would_undo_the_other(tyre: Study, vary: dict[str, Any], words: str, tmp_path: Path) -> None:
    phased = tyre.replace({"drive.phases": [{"name": "fast"}]})
    with pytest.raises(InputError, match=words):
        plan_of(phased, vary)
    file = tmp_path / "list.csv"
    file.write_text(f"name,{','.join(vary)}\na,{','.join(str(list(values)[-1]) for values in vary.values())}\n")
    with pytest.raises(InputError, match=words.removeprefix("vary.")):
        plan_of(phased, {}, cases=str(file))
    # Each of them in a row of its own is a plain list.
    first, second = vary
    file.write_text(f"name,{first},{second}\na,{next(iter(vary[first]))},\nb,,{next(iter(vary[second]))}\n")
    assert len(plan_of(phased, {}, cases=str(file)).variants) == 2


def test_a_linked_variant_is_the_study_with_all_its_numbers_changed(tyre: Study) -> None:
    design = tyre.sweep({"losses": {"factor": [0.8, 1.2], "levels": 2}}, link={"losses": [LOSSES]}, reduced="never")
    by_hand = tyre
    for region in REGIONS:
        by_hand = by_hand.scaled(f"materials.{region}.loss_tangent.value", 1.2)
    hottest = design.table["hottest_degC"].tolist()
    assert hottest[1] == pytest.approx(by_hand.run().extremes.iloc[0].temperature_degC, abs=1e-9)
    assert hottest[1] > hottest[0]
    assert "losses, 0.8 → 1.2×" in " ".join(design.words)


def test_optimum_tornado_and_indices_name_the_link(tyre: Study) -> None:
    design = tyre.sweep(
        {"losses": {"factor": [0.8, 1.2]}, "drive.speed": ("5 m/s", "9 m/s")},
        link={"losses": [LOSSES], "films": ["materials.*.conductivity.value"]},
        sample="saltelli", count=2, optimise={"minimise": "hottest_degC", "runs": 20}, reduced="never",
        tornado={"tolerances": {"losses": "10 %", "films": "5 %"}}, answers=["hottest_degC"],
    )  # fmt: skip
    assert design.indices is not None
    assert set(design.indices.table["number"]) == {"losses", "drive.speed"}
    assert design.optimum is not None
    assert {"losses", "drive.speed"} == {part.split(" = ")[0] for part in design.optimum.where.split(", ")}
    assert set(design.optimum.changes) == {f"materials.{region}.loss_tangent.value" for region in REGIONS} | {
        "drive.speed"
    }
    assert design.tornado is not None
    table = design.tornado.of("hottest_degC").set_index("number")
    lossy = tyre
    for region in REGIONS:
        lossy = lossy.scaled(f"materials.{region}.loss_tangent.value", 1.1)
    more = [each.run().extremes.iloc[0].temperature_degC for each in (tyre, lossy)]
    assert table.loc["losses", "more"] == pytest.approx(more[1] - more[0], abs=1e-6)
    assert "materials.tread.loss_tangent.value" in table.loc["losses", "also"]
    assert abs(table.loc["films", "more"]) < table.loc["losses", "more"]


def test_page_and_tables_name_the_link_and_the_command_resumes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flags = [f"--set={key}={value}" for key, value in COARSE.items()]
    vary = ["--link", f"losses={LOSSES}", "--vary", "losses=x0.8:x1.2:2", "--workers", "1", "--reduced", "never"]
    command = ["sweep", TYRE, *vary, *flags, "--out", str(tmp_path)]
    assert main(command) == 0
    assert pd.read_csv(tmp_path / "sweep.csv")["losses [x]"].tolist() == [0.8, 1.2]
    page = (tmp_path / "sweep.html").read_text()
    assert "Linked: losses sets materials.carcass.loss_tangent.value: its value x factor" in page
    assert "losses [x]</th>" in page
    capsys.readouterr()
    assert main([*command, "--json", "--no-pictures"]) == 0
    summary = json.loads(capsys.readouterr().out)["sample"]
    assert summary["taken_up"] == 2
    assert summary["linked"]["losses"]["materials.tread.loss_tangent.value"] == "its value x factor"


def test_a_sweep_s_own_table_is_a_list(tyre: Study, tmp_path: Path) -> None:
    """Headings of a sweep's table name links and factors, so its columns can be the list of another sweep."""
    link = {"losses": [LOSSES]}
    plan = plan_of(tyre, {"losses": {"factor": [0.8, 1.2], "levels": 3}, "drive.speed": ["5 m/s"]}, link=link)
    rows = pd.DataFrame([plan.row(number) for number in range(3)]).rename(columns={"variant": "name"})
    rows.to_csv(tmp_path / "again.csv", index=False)
    again = plan_of(tyre, {}, cases=str(tmp_path / "again.csv"), link=link)
    for first, second in zip(plan.variants, again.variants, strict=True):
        assert list(first) == list(second)
        assert first["materials.tread.loss_tangent.value"] == pytest.approx(
            second["materials.tread.loss_tangent.value"]
        )


def test_a_reduced_model_follows_linked_numbers(tyre: Study) -> None:
    """Trained on the link, it answers variants within its certificate, and no study whose numbers are not linked."""
    plan = plan_of(tyre, {"losses": {"factor": [0.8, 1.2]}}, link={"losses": [LOSSES]}, sample="sobol", count=4)
    model = surrogate(plan, tolerance=0.05)
    variant = tyre.replace(plan.variants[2])
    (answered,) = model.answers([variant])
    full = variant.run().extremes.iloc[0].temperature_degC
    assert answered.answers["hottest_degC"] == pytest.approx(full, abs=0.6)
    loose = tyre.scaled("materials.tread.loss_tangent.value", 1.1)
    words = "does not change with 'materials.carcass.loss_tangent.value', as the reduced model assumes"
    assert words in why_outside(loose, tyre, plan.varied)
    link = {"a": ["materials.tread.conductivity.value", "2*materials.bead.conductivity.value"]}
    same = plan_of(tyre, {"a": ("0.1 W/m/K", "0.3 W/m/K")}, link=link)
    inside = {"materials.tread.conductivity.value": "0.2 W/m/K", "materials.bead.conductivity.value": "400 mW/m/K"}
    assert why_outside(tyre.replace(inside), tyre, same.varied) == ""
    outside = inside | {"materials.bead.conductivity.value": "0.2 W/m/K"}
    assert "does not change with" in why_outside(tyre.replace(outside), tyre, same.varied)


def test_linked_gauges_share_a_mesh(tyre: Study) -> None:
    plan = plan_of(tyre, {"section.thickness_scale.*": {"factor": [1.0, 1.1]}})
    check_varied(plan)
    assert shape_numbers(plan.varied) == [0]
    counts, alone = counts_of(plan), plan_of(tyre, {"section.thickness_scale.*": {"factor": [1.0, 1.0001]}})
    assert counts is not None
    fewer = counts_of(alone)
    assert fewer is not None
    # The thickest corner decides.
    assert sum(counts.rows) >= sum(fewer.rows)
