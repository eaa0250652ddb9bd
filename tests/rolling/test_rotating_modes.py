"""Waves of rotating rings and tyres: splitting in closed form, at rest as the standing tyre, critical speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.natural_frequencies import natural_frequencies
from tyrefem.mechanics.footprint.vibration import Vibration
from tyrefem.mechanics.rolling.example_rings import ElasticRing
from tyrefem.mechanics.rolling.rotating_modes import RotatingWaves, rotating_frequencies
from tyrefem.mechanics.rolling.standing_waves import SteadyWaves


@pytest.mark.parametrize("n", [2, 3])
def test_splitting_of_a_rotating_ring(n: int) -> None:
    """w = 2 n W/(n^2 + 1) +- sqrt(w_0^2 + (n (n^2 - 1) W/(n^2 + 1))^2), in the ring's frame (Bryan 1890)."""
    # The ring carries its centrifugal load as hoop stress rho (W R)^2.
    spin, ring = 3.0, ElasticRing(0.02)
    ring = replace(ring, tension=ring.line_density * (spin * ring.radius) ** 2)
    (backward, forward), exact = ring.splitting(n, spin), ring.rotating(n, spin)
    assert backward == pytest.approx(exact[0], rel=2e-3)
    assert forward == pytest.approx(exact[1], rel=4e-3)
    assert backward + forward == pytest.approx(4 * n * spin / (n**2 + 1), rel=2e-3)


def test_at_rest_both_directions_are_the_standing_modes() -> None:
    state = PlainTyre().state(along=6)
    vibration = Vibration(Harmonics(state), np.full(state.bulk.shape, 1100.0))
    for n in (1, 2, 3):
        modes = [mode.frequency for mode in vibration.modes(n, 2)]
        waves = [w / (2 * np.pi) for w, _, _ in RotatingWaves(vibration, 0.0).frequencies(n, 2)]
        for direction in (1, -1):
            assert sorted(direction * w for w in waves if w * direction > 0)[:2] == pytest.approx(modes, rel=1e-7)


def test_a_backward_wave_stands_at_the_critical_speed() -> None:
    """w = n W of the rotating tyre is K_n x = W^2 M_n x of steady motion."""
    state = PlainTyre().state(along=6)
    vibration = Vibration(Harmonics(state), np.full(state.bulk.shape, 1100.0))
    for n in (3, 6):
        wave = SteadyWaves(vibration).waves(n, 1)[0]
        waves = RotatingWaves(vibration, wave.angular_speed).frequencies(n, 3)
        nearest = min((w for w, _, _ in waves), key=lambda w: abs(w - n * wave.angular_speed))
        assert nearest == pytest.approx(n * wave.angular_speed, rel=1e-6)


def test_a_rotating_tyre_splits_its_waves() -> None:
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "16 mm"})
    turning = rotating_frequencies(study, 30.0, (0, 1, 2), count=2)
    standing = natural_frequencies(study, (0, 1, 2), 2)
    table = turning.table
    assert set(table.direction[table.harmonic == 0]) == {"standing"}
    for n in (1, 2):
        rows = table[table.harmonic == n]
        assert rows.direction.value_counts().to_dict() == {"forward": 2, "backward": 2}
        ahead, behind = (rows[rows.direction == way].frequency_Hz.min() for way in ("forward", "backward"))
        assert ahead < behind
        first = min(mode.mode.frequency for mode in standing.modes if mode.mode.harmonic == n)
        assert (ahead + behind) / 2 == pytest.approx(first, rel=0.15)
        spin = n * turning.angular_speed / (2 * np.pi)
        forward = rows[rows.direction == "forward"]
        assert (forward.axle_frequency_Hz - forward.frequency_Hz).tolist() == pytest.approx([spin] * 2)
    with pytest.raises(InputError, match="more than 0 m/s"):
        rotating_frequencies(study, 0.0, (1,))
