"""Contracts that every effect of the catalogue keeps."""

from __future__ import annotations

import re

import numpy as np
import pytest
from suitable import NAMES, base, change, choice, entry, has_amplitude, result, signature, suitable

import tyrefem as tf
from tyrefem.effects import catalogue
from tyrefem.effects.effect import FAMILIES, PORTS

AMPLITUDES = [name for name in NAMES if has_amplitude(catalogue()[name])]


@pytest.mark.parametrize("name", NAMES)
def test_it_says_what_it_is(name: str) -> None:
    effect = catalogue()[name]
    assert effect.__module__ == f"tyrefem.effects.{name.replace('-', '_')}"
    assert effect.sentence.endswith(".")
    assert effect.family in FAMILIES
    assert "estimate" in effect.source or re.search(r"\b(19|20)\d\d\b|Roberts", effect.source)
    # Several amplitudes are the components of one quantity, as of a displacement.
    assert len({parameter.prior.unit for parameter in effect.parameters() if parameter.prior.amplitude}) <= 1
    for parameter in effect.parameters():
        assert parameter.prior.meaning
        assert parameter.prior.low <= parameter.prior.origin <= parameter.prior.high
        assert parameter.prior.low < parameter.prior.origin + parameter.prior.scale < parameter.prior.high


@pytest.mark.parametrize("name", AMPLITUDES)
def test_at_null_it_is_not_there(name: str) -> None:
    assert suitable(name).replace({"effects": [entry(name, 0.0)]}).effects == ()


def test_at_null_the_run_is_the_same_to_the_bit() -> None:
    study = suitable("hot-road")
    shared = [name for name in AMPLITUDES if not signature(name).changes]
    assert len(shared) > 10
    null = study.replace({"effects": [entry(name, 0.0) for name in shared]})
    assert null.run().readings.equals(base("hot-road").readings)


@pytest.mark.parametrize("name", NAMES)
def test_it_shows_and_has_the_sign_of_physics(name: str) -> None:
    changed = change(name, 1.0)
    assert np.isfinite(changed).all()
    columns = list(base(name).readings.columns[1:])
    seen = {column: sign * changed[:, columns.index(column)] for column, sign in signature(name).signs.items()}
    assert {column: series.mean() > 0 for column, series in seen.items()} == dict.fromkeys(seen, True)
    assert max(series.max() for series in seen.values() or [np.abs(changed)]) > 0.1


@pytest.mark.parametrize("name", AMPLITUDES)
def test_a_small_amplitude_does_half_of_twice_as_much(name: str) -> None:
    small, twice = change(name, 0.05), change(name, 0.1)
    assert np.abs(small).max() > 1e-3
    assert np.linalg.norm(twice - 2 * small) < 0.1 * np.linalg.norm(twice)


@pytest.mark.parametrize("name", NAMES)
def test_the_heat_budget_closes(name: str) -> None:
    budget = result(name, 1.0).heat_budget
    assert budget.imbalance < 1e-5
    left = budget.total("generated") - budget.total("stored") - budget.total("lost")
    assert abs(left) < 1e-5 * sum(abs(series[-1]) for series in budget.energies.values())


def _fits(name: str, study: tf.Study) -> bool:
    try:
        return bool(study.replace({"effects": [entry(name, 1.0)]}).effects)
    except tf.InputError:
        return False


def test_order_in_the_file_does_not_matter() -> None:
    # Two of each port that several effects share, of those that this study takes.
    study = suitable("hot-road")
    taken = [name for name in NAMES if catalogue()[name].refusal(study) is None and _fits(name, study)]
    sharing = {port.name: [name for name in taken if catalogue()[name].overrides(port.name)] for port in PORTS}
    together = list(dict.fromkeys(name for names in sharing.values() if len(names) > 1 for name in names[:2]))
    assert len(together) >= 10, together
    entries = [entry(name, 1.0) for name in together]
    there, back = (study.replace({"effects": order}).run().readings for order in (entries, entries[::-1]))
    assert np.allclose(there, back, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_a_number_beyond_its_bounds_is_refused(name: str) -> None:
    table = {key: value for key, value in entry(name, 1.0).items() if key != "name"}
    for parameter in catalogue()[name].parameters():
        for beyond in (parameter.prior.low - parameter.prior.scale, parameter.prior.high + parameter.prior.scale):
            written = parameter.prior.text(beyond)
            with pytest.raises(tf.InputError, match=rf"{parameter.name}.*is out of range: must be at (least|most)"):
                catalogue()[name].check(table | {parameter.name: written})


@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_is_read(name: str) -> None:
    effect = catalogue()[name]
    for parameter in effect.parameters():
        for value in (
            parameter.prior.low,
            parameter.prior.origin,
            parameter.prior.high,
            parameter.prior.origin + parameter.prior.scale,
        ):
            read = effect.check({**choice(name), parameter.name: parameter.prior.text(value, 12)})
            assert read.values[parameter.name] == pytest.approx(value, rel=1e-11, abs=1e-15)


@pytest.mark.parametrize("name", NAMES)
def test_every_variant_fits_its_study(name: str) -> None:
    study, effect = suitable(name), catalogue()[name]
    assert effect.refusal(study) is None
    variants = effect.variants(study)
    assert variants
    for variant in variants:
        checked = effect.check(dict(variant))
        assert checked.choice == dict(variant)
        assert checked.problem(study) is None
    assert len({tuple(variant.items()) for variant in variants}) == len(variants)
