"""The table of hidden laws: written from the records of finished diagnoses, and the page has a place for it."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from script_module import script_module

ROOT = Path(__file__).resolve().parents[2]


def exponent(name: str, mean: float, sd: float, reference: float = 10.0) -> dict[str, Any]:
    """An exponent of a law."""
    return {"name": name, "in_law": True, "mean": mean, "sd": sd, "reference": reference}


def diagnosis(verdict: str, law: dict[str, Any] | None, effects: list[dict[str, Any]], rms: float) -> dict[str, Any]:
    """What the table needs of a record."""
    gap = {"rms_K": rms, "held_out_rms_K": rms + 0.1}
    return {
        "verdict": verdict, "effects": effects, "processor_s": 30.0, "missing_heat": {"law": law},
        "gap": {"before": {"rms_K": 4.0, "held_out_rms_K": 4.2}, "after": gap},
    }  # fmt: skip


def law(*exponents: dict[str, Any], time: float | None = None, **more: Any) -> dict[str, Any]:
    """A law that holds."""
    sd = None if time is None else 4.0
    return {
        "holds": True,
        "sentences": ["It grows."],
        "exponents": list(exponents),
        "time_s": time,
        "time_sd_s": sd,
    } | more


def effect(name: str, **parameters: tuple[float, float]) -> dict[str, Any]:
    """A named effect."""
    values = {key: {"value": value, "sd": sd} for key, (value, sd) in parameters.items()}
    return {"name": name, "probability": 0.98, "parameters": values}


@pytest.fixture
def records(tmp_path: Path) -> Path:
    """A delamination that is right, and a belt edge with a wrong name and no law."""
    of_law = law(exponent("speed", 1.04, 0.03), exponent("deflection", 2.3, 0.1), time=303.0)
    draft = effect(
        "inferred-heat-95-mm", heat=(1e5, 2e3), speed_exponent=(1.01, 0.02), deflection_exponent=(2.05, 0.04)
    )
    first, second = diagnosis("unexplained", of_law, [], 0.7), diagnosis("identified", None, [draft], 0.5)
    wrong = diagnosis("identified", None, [effect("sun")], 0.9)
    for name, contents in {"delamination-3": (first, second), "belt-edge-1": (wrong,)}.items():
        (tmp_path / name).mkdir()
        for file, content in zip(("first", "second"), contents, strict=False):
            (tmp_path / name / f"{file}.json").write_text(json.dumps(content), encoding="utf-8")
    return tmp_path


def test_table_and_page_come_from_the_records(records: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = script_module("benchmarks/hidden_law_table.py")
    page, table = records / "page.md", records / "laws.csv"
    page.write_text(f"# Page\n\n{module.BEGIN}\n\nold\n\n{module.END}\n\nafter\n", encoding="utf-8")
    for name, place in (("PAGE", page), ("TABLE", table)):
        monkeypatch.setattr(module, name, place)
    rows = module.rows_of(records)
    assert [(row.case, row.seed) for row in rows] == [("delamination", 3), ("belt-edge", 1)]
    assert [number.covered for number in rows[0].of_law] == [True, False, True]
    assert [number.covered for number in rows[0].of_draft] == [True, True]
    assert rows[1].wrong == ["sun"]
    module.write(rows)
    text = page.read_text(encoding="utf-8")
    assert "old" not in text
    assert text.endswith(f"{module.END}\n\nafter\n")
    assert "Named is the draft in 1 of 2; wrong names: sun." in text
    assert "2 of 3 of the laws, 2 of 2 of the drafts' fits" in text
    assert "speed 1.04 ± 0.03; deflection 2.30 ± 0.10 (!); time 303 ± 4 s | identified, 98 %" in text
    with table.open(encoding="utf-8") as file:
        first, _ = csv.DictReader(file)
    assert (first["held-out rms before [K]"], first["held-out rms after [K]"]) == ("4.20", "0.60")


def test_a_share_of_the_loss_is_compared_by_its_slope() -> None:
    """A (D/D_ref)^p of the loss has the slope A p/(1 + A) at the reference, whatever the base value."""
    module = script_module("benchmarks/hidden_law_table.py")
    reference = 1.0 * 0.4 * module.RATED_DEFLECTION
    entry = exponent("deflection", 0.5, 0.1, reference)
    (number,) = module.numbers_of_law("payne", law(entry, amplitude_1=-0.5, amplitude_sd_1=0.1))
    assert number.hidden == pytest.approx(0.0)
    assert number.mean == pytest.approx(-0.5)
    assert number.sd == pytest.approx((0.1**2 + (0.5 / 0.25 * 0.1) ** 2) ** 0.5)


def test_the_page_has_the_place_that_the_script_fills() -> None:
    module = script_module("benchmarks/hidden_law_table.py")
    text = (ROOT / module.PAGE).read_text(encoding="utf-8")
    assert text.count(module.BEGIN) == text.count(module.END) == 1
    assert text.index(module.BEGIN) < text.index(module.END)
