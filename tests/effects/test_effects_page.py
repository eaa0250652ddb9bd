"""docs/effects.md is what the catalogue says, and every effect has its picture."""

from __future__ import annotations

import importlib.util
import re
import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.effects import catalogue
from tyrefem.effects.description import example

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def tool() -> ModuleType:
    """tools/make_effects_page.py as a module."""
    spec = importlib.util.spec_from_file_location("make_effects_page", ROOT / "tools/make_effects_page.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_up_to_date(tool: ModuleType) -> None:
    written = (ROOT / "docs/effects.md").read_text(encoding="utf-8")
    assert written == tool.page(), "run tools/make_effects_page.py"
    assert (ROOT / tool.BOUNDS).read_text(encoding="utf-8") == tool.bounds(), "run tools/make_effects_page.py"


def test_every_effect_has_a_picture_and_every_picture_an_effect(tool: ModuleType) -> None:
    named = set(re.findall(r"\((pictures/effect-[a-z-]+\.png)\)", tool.page()))
    assert len(named) == len([effect for effect in catalogue().values() if not effect.calibration])
    assert {ROOT / "docs" / name for name in named} == set((ROOT / "docs/pictures").glob("effect-*.png"))
    assert all((ROOT / "docs" / name).read_bytes().startswith(b"\x89PNG") for name in named)


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_the_example_of_the_page_can_be_put_into_a_study(name: str) -> None:
    changes = catalogue()[name].signature.changes
    entries = tomllib.loads(example(catalogue()[name]))["effects"]
    (effect,) = tf.study("example-validation").replace({**changes, "effects": entries}).effects
    assert effect.name == name


@pytest.fixture
def effects_of_the_page(tmp_path: Path, tool: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page's own effect, and the one with a state that it names, in a user's folder."""
    (named,) = re.findall(r"`(tests/effects/\w+\.py)`", tool.page())
    codes = re.findall(r"```python\n(.*?)```", tool.page(), re.DOTALL)
    codes.append((ROOT / named).read_text(encoding="utf-8"))
    for number, code in enumerate(codes):
        (tmp_path / f"own_{number}.py").write_text(code, encoding="utf-8")
    monkeypatch.setenv("TYREFEM_EFFECTS", str(tmp_path))


def test_the_page_s_own_effects_load(effects_of_the_page: None) -> None:
    assert catalogue()["lamp"].ports() == ("flux",)
    assert catalogue()["drying-tread"].ports() == ("film_factor",)


def test_the_drying_tread_that_the_page_names_dries_and_cools(effects_of_the_page: None) -> None:
    """Heat that evaporates the water is what the tread loses more than without the wet film."""
    coarse = {"mesh.size": "8 mm", "mesh.element": "P1", "drive.initial": "80 degC", "drive.ambient": "20 degC"}
    study = tf.study("example-validation").replace(coarse)
    wet, dry = (
        study.replace({"effects": [{"name": "drying-tread", "puddle": f"{w} kg/m**2"}]}).run() for w in (0.05, 0)
    )
    water = wet.states["drying-tread water"].values
    assert water[0] == 0.05
    assert (np.diff(water) <= 0).all()
    assert water[-1] < 0.005
    assert dry.states == {}
    cooler = (dry.readings - wet.readings)["crown-middle"]
    assert cooler.max() > 0.1
    # A cooler tyre loses less everywhere else: the surplus is positive and below the latent heat.
    tread = wet.tyre.problem.operators.surface("road")
    latent = 2 * 2.45e6 * (water[0] - water[-1]) * tread.area
    surplus = wet.heat_budget.total("lost") - dry.heat_budget.total("lost")
    assert 0 < surplus < latent
