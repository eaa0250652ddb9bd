"""The standing wave of a diagnosis: numbers of the tyre's mechanics where a drive is fast, else the general ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hidden import study

import tyrefem as tf
from tyrefem.api import Study
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, catalogue_candidates
from tyrefem.diagnose.unknowns.computed_wave import NAME, ComputedWave, WithWave, computed_wave, recorded_wave
from tyrefem.diagnose.unknowns.unknown import with_values
from tyrefem.diagnose.words.set_posteriors import SetPosterior, read_posteriors
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.rolling.amplification import Onset
from tyrefem.mechanics.rolling.critical_speed import ring_speed

FEM = {"mesh.size": "16 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}
FAST = 60.0


def waves(looked_at: StudyData) -> tuple[Candidate, ...]:
    return tuple(each for each in catalogue_candidates(looked_at) if each.name in (NAME, "hot-road"))


def driven(speed: float, **changes: object) -> Study:
    return tf.study("nasa-22x5.5-8pr", {**FEM, "drive.speed": f"{speed} m/s", **changes})


def of(tyre: StudyData) -> tuple[ComputedWave, list[str]]:
    """The computed wave, and what was said of the work."""
    ticks: list[str] = []
    return computed_wave([tyre], waves(tyre), ticks.append), ticks


def test_a_slow_drive_keeps_the_numbers_of_the_catalogue() -> None:
    tyre = driven(0.4 * ring_speed(driven(1.0), 83 * 6894.76))
    wave, ticks = of(tyre)
    assert (wave, ticks) == (ComputedWave(), [])
    assert WithWave(waves, wave)(tyre) == waves(tyre)


def test_without_the_effect_nothing_is_computed() -> None:
    tyre = driven(FAST)
    assert computed_wave([tyre], [each for each in waves(tyre) if each.name != NAME]) == ComputedWave()


@pytest.fixture(scope="module")
def fast() -> ComputedWave:
    slow, quick = driven(9.0), driven(FAST)
    return computed_wave([slow, quick], waves(quick))


def test_a_fast_drive_has_numbers_of_its_tyre(fast: ComputedWave) -> None:
    """Those of `tyrefem press --critical-speed --rise` in the 22x5.5 at 83 psi: 55 m/s and gain 2.7 on a finer mesh."""
    assert fast.onset is not None
    assert fast.onset.critical_speed == pytest.approx(55.0, rel=0.15)
    assert fast.onset.gain == pytest.approx(2.7, rel=0.4)
    assert "onset at" in fast.note
    assert "mechanics of this tyre" in fast.note
    again, ticks = of(driven(FAST))
    assert again.onset == fast.onset
    assert ticks == ["computing the standing wave"]


def test_the_candidate_has_them(fast: ComputedWave) -> None:
    assert fast.onset is not None
    tyre = driven(FAST)
    (candidate,) = (each for each in WithWave(waves, fast)(tyre) if each.name == NAME)
    (gain,), (speed,) = candidate.amplitudes, candidate.shapes
    assert gain.sd == pytest.approx(fast.onset.gain)
    assert speed.value(0.0) == pytest.approx(fast.onset.critical_speed)
    assert speed.sd == pytest.approx(0.15 * fast.onset.critical_speed)
    assert (speed.value(speed.low), speed.value(speed.high)) == pytest.approx((15.0, 150.0))
    # With the gain alone the onset is at the computed speed, too.
    (alone,) = with_values(tyre, {gain: 1.0}).effects
    assert alone.critical_speed == pytest.approx(fast.onset.critical_speed, rel=1e-6)
    (both,) = with_values(tyre, {gain: 1.0, speed: 5.0}).effects
    (turned,) = with_values(tyre, {speed: 5.0, gain: 1.0}).effects
    assert both.critical_speed == turned.critical_speed == pytest.approx(fast.onset.critical_speed + 5, rel=1e-6)


def test_by_another_strain_law_a_note_says_why_not() -> None:
    wave, ticks = of(tf.study("nasa-22x5.5-8pr", {"drive.speed": f"{FAST} m/s"}))
    assert wave.onset is None
    assert ticks == []
    assert 'those of this tyre need mechanics.strain = "fem"' in wave.note


def test_a_tyre_without_a_solution_keeps_the_numbers_with_a_note() -> None:
    wave, ticks = of(driven(FAST, **{"drive.load": "4 MN"}))
    assert wave.onset is None
    assert ticks
    assert "could not be computed" in wave.note


def test_a_diagnosis_takes_and_notes_them(tmp_path: Path, fast: ComputedWave) -> None:
    assert fast.onset is not None
    tyre = study(tmp_path / "study").replace({**FEM, "drive.speed": f"{FAST} m/s", "diagnosis.exclude": []})
    readings = tyre.run().readings[["time_s", *tyre.sensors]]
    names = {"time_s": "time [s]", **{name: f"{name} [degC]" for name in tyre.sensors}}
    readings.rename(columns=names).to_csv(tmp_path / "slow.csv", index=False)
    settings = DiagnosisSettings(mesh_size="16 mm", largest=1, looks=1)
    diagnosis = tyre.diagnose(
        tmp_path / "slow.csv", settings=settings, candidates=waves, rerun=False, verdict_only=True
    )
    assert diagnosis.notes[0] == fast.note
    (candidate,) = (each for each in diagnosis.candidates if each.name == NAME)
    assert candidate.shapes[0].value(0.0) == pytest.approx(fast.onset.critical_speed)


@pytest.mark.parametrize("wave", [ComputedWave(), ComputedWave(Onset(2.7, 55.0, 0.1))])
def test_a_plan_reads_the_numbers_of_the_diagnosis(wave: ComputedWave) -> None:
    tyre = driven(9.0)
    candidates = WithWave(waves, wave)(tyre)
    (member,) = (each for each in candidates if each.name == NAME)
    stored = SetPosterior((member,), 1.0, member.unknowns, np.array([1.0, 0.1]), np.eye(2))
    record = {"runs": ["fast"], "standing_wave": recorded_wave(candidates), "sets": [stored.to_dict()]}
    (read,) = read_posteriors(record, tyre, DiagnosisSettings())
    assert read.members == (member,)
    assert read.unknowns == member.unknowns
