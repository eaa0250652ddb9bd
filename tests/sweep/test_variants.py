"""What varies, and which variants are made of it."""

from __future__ import annotations

import errno
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tyrefem import study
from tyrefem.api import Study
from tyrefem.cards import read_toml
from tyrefem.errors import InputError, OutputError
from tyrefem.geometry.meshing import build, write
from tyrefem.library import find
from tyrefem.quantity import parse
from tyrefem.sweep.design import loaded
from tyrefem.sweep.sweep import sweep
from tyrefem.variants import task
from tyrefem.variants.card import SweepCard
from tyrefem.variants.plan import plan_of, planned
from tyrefem.variants.task import perform
from tyrefem.variants.varied import Varied

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def tyre() -> Study:
    return study("nasa-22x5.5-8pr")


def test_grid_is_every_combination(tyre: Study) -> None:
    plan = plan_of(tyre, {"drive.speed": ("10 mph", "40 mph", 4), "drive.pressure": ["80 psi", "90 psi"]})
    assert [dict(variant) for variant in plan.variants[:3]] == [
        {"drive.speed": "10 mph", "drive.pressure": "80 psi"},
        {"drive.speed": "10 mph", "drive.pressure": "90 psi"},
        {"drive.speed": "20 mph", "drive.pressure": "80 psi"},
    ]
    assert len(plan.variants) == 8
    assert plan.row(2) == {"variant": "3", "drive.speed [mph]": 20.0, "drive.pressure [psi]": 80.0}


@pytest.mark.parametrize("sample", ["latin-hypercube", "sobol"])
def test_samples_fill_the_box_and_come_again_with_their_seed(tyre: Study, sample: str) -> None:
    box = {
        "drive.speed": ("5 m/s", "15 m/s"),
        "materials.tread.loss_tangent.value": {"factor": [0.5, 2.0], "scale": "log"},
    }
    first, again, other = (plan_of(tyre, box, sample=sample, count=16, seed=seed).variants for seed in (3, 3, 4))
    assert first == again
    assert first != other
    speeds = np.array([parse(variant["drive.speed"], "m/s") for variant in first])
    # One in every sixteenth of the range: what both samples promise of each number alone.
    assert sorted(((speeds - 5) / 10 * 16).astype(int).tolist()) == list(range(16))


def test_sobol_sample_is_rounded_up_to_a_power_of_two(tyre: Study) -> None:
    assert len(plan_of(tyre, {"drive.speed": ("5 m/s", "15 m/s")}, sample="sobol", count=20).variants) == 32


@given(place=st.floats(0, 1), low=st.floats(1e-3, 1e3), width=st.floats(1e-2, 1e3), log=st.booleans())
def test_a_value_is_within_its_range_and_read_back_as_it_was_written(
    place: float, low: float, width: float, log: bool
) -> None:
    quantity = Varied("drive.speed", "m/s", low=low, high=low + width, log=log)
    value = parse(quantity.at(place), "m/s")
    assert low * (1 - 1e-8) <= value <= (low + width) * (1 + 1e-8)
    assert quantity.of(quantity.at(place)) == pytest.approx(value, rel=1e-12)


def test_factor_is_on_what_the_card_says(tyre: Study) -> None:
    plan = plan_of(tyre, {"materials.tread.loss_tangent.value": {"factor": [0.5, 1.5], "levels": 2}})
    stated = tyre.materials["tread"].loss_tangent.value
    values = [tyre.replace(variant).materials["tread"].loss_tangent.value for variant in plan.variants]
    assert stated is not None
    assert values == pytest.approx([0.5 * stated, 1.5 * stated])


def test_cards_are_swapped(tyre: Study) -> None:
    plan = plan_of(tyre, {"materials.tread": ["nasa-tread", "rubber-tread-passenger"]})
    densities = [tyre.replace(variant).materials["tread"].loss_tangent for variant in plan.variants]
    assert densities[0] != densities[1]
    assert plan.row(1)["materials.tread"] == "rubber-tread-passenger"


def test_list_from_csv(tyre: Study, tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text("name,drive.speed [mph],drive.load [lbf]\nslow,10,2000\nfast,30,\n")
    plan = planned(tyre, SweepCard.check({"study": "x", "sample": "list", "cases": "list.csv"}), tmp_path)
    assert plan.names == ("slow", "fast")
    assert [dict(variant) for variant in plan.variants] == [
        {"drive.speed": "10 mph", "drive.load": "2000 lbf"},
        {"drive.speed": "30 mph"},
    ]


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ({"drive.sped": ("10 mph", "20 mph")}, "sped"),
        ({"drive.speed": ("10 mph", "20 m/s")}, "same unit"),
        ({"drive.speed": ("20 mph", "10 mph")}, "below"),
        ({"drive.speed": ("10", "20")}, "unit"),
        ({"drive.load": ("1000 lbf", "1e9 lbf")}, "load"),
        ({"drive.speed": ["10 mph", "10 mph"]}, "twice"),
        ({"drive.speed": {"from": "0 mph", "to": "10 mph", "scale": "log"}}, "positive"),
        ({"materials.tread": ["nasa-tread", "nasa-tred"]}, "nasa-tread"),
        ({"materials.tread.loss_tangent.value": {"factor": [2.0, 1.0]}}, "rising"),
        ({"drive.speed": {"values": ["1 mph"], "from": "1 mph", "to": "2 mph"}}, "one of"),
    ],
)
def test_nonsense_is_refused_before_anything_runs(tyre: Study, vary: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        plan_of(tyre, vary)


def test_two_variants_of_a_list_that_are_the_same_are_refused(tyre: Study, tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text("name,drive.speed [mph]\none,10\ntwo,10\n")
    with pytest.raises(InputError, match=r"'one' and 'two' are the same"):
        planned(tyre, SweepCard.check({"study": "x", "sample": "list", "cases": "list.csv"}), tmp_path)


def test_a_full_disk_is_no_failure_of_a_variant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    card = tmp_path / "own.toml"
    shutil.copy(find("section", "nasa-22x5.5-8pr"), card)
    plan = plan_of(study("nasa-22x5.5-8pr", {"section": str(card)}), {"drive.speed": ["10 mph", "20 mph"]})

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OutputError, match="temporary files cannot be written: No space left on device"):
        perform(plan.task(0))


def test_variants_that_bend_alike_share_mesh_and_strain_cycle() -> None:
    coarse = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "60 s"})
    box = {"section.cord_angle": ["33 deg", "37 deg"], "materials.tread.loss_tangent.value": [0.1, 0.2, 0.3]}
    plan = plan_of(coarse, box)
    alone = {n: coarse.replace(plan.variants[n]).run().history.maximum.temperature for n in (1, 5)}
    # Back and forth between the sections, as tasks of other processes in between leave them.
    order = (0, 3, 1, 4, 2, 5)
    highest = {n: perform(plan.task(n)).answers["hottest_degC"] for n in order}
    assert {n: highest[n] for n in alone} == pytest.approx(alone, abs=1e-9)
    tyres = task.recent_tyres.tyres
    assert len(tyres) == task.REMEMBERED
    assert len({id(tyre.schedule) for tyre in tyres}) == 2
    assert len({id(tyre.mesh) for tyre in tyres}) == 2


def test_a_swapped_card_does_not_wipe_out_what_varies_in_it(tyre: Study) -> None:
    box = {"materials.tread.loss_tangent.value": [0.1, 0.3], "materials.tread": ["nasa-tread", "rubber-tread-aircraft"]}
    plan = plan_of(tyre, box)
    cards = [tyre.replace(variant).materials["tread"] for variant in plan.variants]
    assert [card.loss_tangent.value for card in cards] == [0.1, 0.3, 0.1, 0.3]
    assert len({card.title for card in cards}) == 2
    with pytest.raises(InputError, match=r"'materials\.tread' varies as a whole, so a factor"):
        plan_of(tyre, box | {"materials.tread.loss_tangent.value": {"factor": [0.8, 1.2]}})


@pytest.mark.parametrize(
    ("entry", "options", "message"),
    [
        (("10 mph", "40 mph", 4), {"sample": "sobol", "count": 8}, r"levels: levels are those of a grid"),
        (("10 mph", "40 mph", 4), {"optimise": {"minimise": "mass_kg"}}, r"levels: .*add sample = 'grid'"),
        ({"values": ["10 mph", "20 mph"], "levels": 2}, {}, r"levels: goes with a range or a factor"),
        (("10 mph", "40 mph"), {"seed": 2}, r"seed: is of a random sample, which sample = 'grid' is not"),
        (
            ("10 mph", "40 mph"),
            {"seed": 2, "optimise": {"minimise": "mass_kg"}},
            r"seed: .*that of the search is optimise\.seed",
        ),
    ],
)
def test_what_a_sample_does_not_use_is_refused(
    tyre: Study, entry: object, options: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        plan_of(tyre, {"drive.speed": entry}, **options)


def test_another_sample_over_a_file_leaves_out_what_only_the_files_sample_has() -> None:
    """The file's grid has levels, and its Sobol sample a number: a flag that changes the sample need not edit them."""
    assert len(loaded("crown-angle", sample="sobol", count=8).plan.variants) == 8
    names = SweepCard.check(read_toml(find("sweep", "eight-numbers"))).vary
    fewest = {name: {"factor": [0.9, 1.1], "levels": 2} for name in names}
    assert len(loaded("eight-numbers", sample="grid", vary=fewest).plan.variants) == 2**8
    assert not loaded("belt-edge", optimise={"minimise": "mass_kg"}).card.sampled
    with pytest.raises(InputError, match="levels are those of a grid"):
        loaded(
            "belt-edge",
            sample="sobol",
            count=8,
            vary={"section.thickness_scale.shoulder-cushion": {"factor": [0.9, 1.1], "levels": 3}},
        )


def test_a_failed_variant_names_the_mesh_file_of_its_owner(tmp_path: Path) -> None:
    shutil.copy(find("study", "nasa-22x5.5-8pr"), tmp_path / "study.toml")
    write(build(study("nasa-22x5.5-8pr").section, size=12e-3), tmp_path / "mine.msh")
    meshed = study(str(tmp_path / "study.toml"), {"mesh": {"file": "mine.msh"}, "drive.duration": "20 s"})
    failed = sweep(plan_of(meshed, {"section.thickness_scale.tread": [1.0, 0.8]}), reduced="never").failed
    assert list(failed) == ["2"]
    assert failed["2"].startswith(f"{tmp_path / 'mine.msh'}: ")
