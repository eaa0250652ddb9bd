"""The strain round the wheel and what a revolution loses."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.materials.card import material
from tyrefem.materials.loss_tangent import FrequencyTable, OfTemperature, PowerLaw, Prony, Shift
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

REGIONS = ("ply", "belt", "tread", "sidewall")


@pytest.fixture(scope="module")
def cycle() -> StrainHarmonics:
    return StrainHarmonics(Pressing(PlainTyre().state(along=12)).at_deflection(0.02, 54))


def test_strain_is_the_symmetric_gradient_of_the_displacement(cycle: StrainHarmonics) -> None:
    h = cycle.gradient(0.1)
    e = cycle.strain(np.array([0.1]))[..., 0]
    assert e[:3] == pytest.approx(np.stack([h[0, 0], h[1, 1], h[2, 2]]), abs=1e-12)
    assert e[3:] == pytest.approx(np.stack([h[0, 1] + h[1, 0], h[0, 2] + h[2, 0], h[1, 2] + h[2, 1]]), abs=1e-12)


def test_belt_is_bent_under_the_footprint_and_at_rest_opposite(cycle: StrainHarmonics) -> None:
    angles = np.linspace(-np.pi, np.pi, 73)
    history = cycle.at(0.3105, 0.0, angles)
    assert np.abs(history[2]).argmax() in range(30, 43)
    assert np.abs(history[2, [0, -1]]).max() < 0.1 * np.abs(history[2]).max()
    # Even in t but for the two shears with t, which are odd.
    assert history[:4] == pytest.approx(history[:4, ::-1], abs=1e-9)
    assert history[4:] == pytest.approx(-history[4:, ::-1], abs=1e-9)


def test_belt_edge_shear_is_found_at_the_belt_edge(cycle: StrainHarmonics) -> None:
    shear = cycle.belt_edge_shear("belt")
    members = cycle.elements.mesh.subdomains["belt"]
    assert shear.place[1] > 0.9 * cycle.elements.points[1][members].max()
    assert 0.02 < shear.range < 1.0
    history = cycle.at(*shear.place, np.linspace(-np.pi, np.pi, 180))
    assert np.ptp(history[3:], axis=-1).max() == pytest.approx(shear.range, rel=1e-12)
    with pytest.raises(InputError, match="did you mean 'belt'"):
        cycle.belt_edge_shear("belts")


def test_cords_across_the_hoop_feel_the_hoop_strain(cycle: StrainHarmonics) -> None:
    direction = np.zeros((3, *cycle.elements.radii.shape))
    direction[2] = 1.0
    angles = np.array([0.0, 1.0])
    assert cycle.along(direction, angles) == pytest.approx(cycle.strain(angles)[2])


def test_loss_is_the_area_of_the_hysteresis_loop(cycle: StrainHarmonics) -> None:
    """int stress d(strain) over the revolution, with each harmonic's stress leading its strain by delta."""
    revolution_loss = RevolutionLoss(cycle, {name: PowerLaw(0.1, 0.3) for name in REGIONS}, 20.0)
    storage = cycle.footprint.pressing.state.storage
    angles = np.arange(512) * 2 * np.pi / 512
    e, p = cycle.nearest(0.315, 0.03)
    n = np.arange(cycle.footprint.harmonics + 1)
    tan = np.array([0.0] + [float(revolution_loss.tangent(k * revolution_loss.frequency)[e, p]) for k in n[1:]])
    a = cycle.amplitudes[:, :, e, p]
    phase = np.multiply.outer(angles, n)
    even, odd = [0, 1, 2, 3], [4, 5]
    rate, stress = np.zeros((2, 512, 6))
    for parts, wave, slope in ((even, np.cos, lambda x: -np.sin(x)), (odd, np.sin, np.cos)):
        rate[:, parts] = (slope(phase) * n) @ a[:, parts]
        stress[:, parts] = wave(phase) @ a[:, parts] + (slope(phase) * tan) @ a[:, parts]
    loop = np.einsum("ti,ij,tj->", stress, storage[:, :, e, p], rate) * 2 * np.pi / 512
    assert revolution_loss.density[e, p] == pytest.approx(loop, rel=1e-10)


def test_prony_loss_is_that_of_a_maxwell_element_in_time() -> None:
    """A step-by-step integration of q' = e' - q / tau over many revolutions, against harmonics 1 to 8."""
    tau, equilibrium, modulus, frequency = 0.004, 1.0, 2.0, 12.0
    law = Prony(equilibrium, (modulus,), (tau,))
    amplitudes = np.array([0.0, 1.0, 0.8, 0.5, 0.4, 0.2, 0.1, 0.1, 0.05])
    omega, n = 2 * np.pi * frequency, np.arange(9)
    steps, h = 8000, 1 / (frequency * 8000)
    t = np.arange(20 * steps) * h
    rate = -(np.sin(np.multiply.outer(t, n * omega)) * n * omega) @ amplitudes
    q, memory, decay = np.zeros_like(t), 0.0, np.exp(-h / tau)
    gain = tau * (1 - decay)
    for k in range(len(t) - 1):
        memory = decay * memory + gain * (rate[k] + rate[k + 1]) / 2
        q[k + 1] = memory
    lost = modulus * (q[-steps:] * rate[-steps:]).sum() * h
    total = 0.0
    for k in n[1:]:
        x = k * omega * tau
        storage = equilibrium + modulus * x * x / (1 + x * x)
        total += k * np.pi * float(law(k * frequency, np.array(20.0))) * storage * amplitudes[k] ** 2
    assert total == pytest.approx(lost, rel=1e-3)


def test_heat_is_rolling_resistance_times_speed(cycle: StrainHarmonics) -> None:
    card = material("nasa-tread").loss_tangent
    revolution_loss = RevolutionLoss(cycle, {name: OfTemperature(card) for name in REGIONS}, 15.0, 60.0)
    volume = (cycle.elements.weights.sum(axis=1) * 2 * np.pi * 2).astype(float)
    power = float((revolution_loss.heat_source * volume).sum())
    assert power == pytest.approx(revolution_loss.rolling_resistance * 15.0, rel=1e-12)
    assert sum(revolution_loss.by_region.values()) == pytest.approx(revolution_loss.energy, rel=1e-12)
    assert revolution_loss.by_harmonic.sum() == pytest.approx(revolution_loss.total(revolution_loss.density), rel=1e-12)
    assert revolution_loss.coefficient * cycle.footprint.load * 15.0 == pytest.approx(power, rel=1e-12)
    assert 1e-4 < revolution_loss.coefficient < 0.1


def test_stored_energy_is_the_mean_over_the_wheel(cycle: StrainHarmonics) -> None:
    """1/2 e : C' : e, mean over the angle, is what all harmonics store together."""
    revolution_loss = RevolutionLoss(cycle, {}, 20.0)
    storage, mean = cycle.footprint.pressing.state.storage, np.zeros(cycle.elements.radii.shape)
    for t in np.arange(128) * 2 * np.pi / 128:
        e = cycle.strain(np.array([t]))[..., 0]
        mean += np.einsum("iep,ijep,jep->ep", e, storage, e) / 2 / 128
    assert revolution_loss.stored_by_harmonic.sum() == pytest.approx(revolution_loss.total(mean), rel=1e-9)


def test_loss_follows_its_tangent(cycle: StrainHarmonics) -> None:
    def lost(law: object, temperature: float = 25.0) -> RevolutionLoss:
        return RevolutionLoss(cycle, dict.fromkeys(REGIONS, law), 20.0, temperature)  # type: ignore[arg-type]

    single, two = lost(OfTemperature(0.1)), lost(OfTemperature(0.2))
    assert two.energy == pytest.approx(2 * single.energy)
    power = lost(PowerLaw(0.1, 0.5, reference=single.frequency))
    n = np.arange(1, 55)
    assert power.by_harmonic[1:] == pytest.approx(single.by_harmonic[1:] * np.sqrt(n))
    card = material("nasa-tread").loss_tangent
    ratio = lost(OfTemperature(card), 75.0).energy / lost(OfTemperature(card), 25.0).energy
    assert ratio == pytest.approx(np.exp(-0.0148 * 50))
    assert RevolutionLoss(cycle, {"tread": OfTemperature(0.1)}, 20.0).energy < single.energy


def test_one_cycle_convention_is_half_of_the_sinusoid(cycle: StrainHarmonics) -> None:
    revolution_loss = RevolutionLoss(cycle, dict.fromkeys(REGIONS, OfTemperature(0.1)), 20.0)
    nasa, sinusoid = (revolution_loss.total(revolution_loss.one_cycle_density(name)) for name in ("nasa", "sinusoid"))
    assert sinusoid == pytest.approx(2 * nasa)
    # pi U tan d at a point: U is the largest energy of the strain less that opposite the footprint.
    e, p = cycle.nearest(0.315, 0.03)
    change = cycle.at(0.315, 0.03, np.linspace(0, np.pi, 180))
    change = change - change[:, -1:]
    energy = np.einsum("it,ij,jt->t", change, cycle.footprint.pressing.state.storage[:, :, e, p], change) / 2
    assert revolution_loss.one_cycle_density()[e, p] == pytest.approx(np.pi * 0.1 * energy.max(), rel=1e-9)
    assert 0.2 < nasa / revolution_loss.energy < 5
    with pytest.raises(InputError, match="did you mean 'nasa'"):
        revolution_loss.one_cycle_density("nsa")


def test_time_temperature_shift_moves_the_peak_of_tan_delta() -> None:
    """Half a decade colder by a_T is the same as a_T times the frequency."""
    shift = Shift(8.86, 101.6, 20.0)
    law = Prony(1.0, (1.0, 1.0, 2.0), (1e-1, 1e-3, 1e-5), shift)
    factor = float(shift(np.array(-10.0)))
    assert factor > 10
    warm = float(law(10.0 * factor, np.array(20.0)))
    assert float(law(10.0, np.array(-10.0))) == pytest.approx(warm, rel=1e-12)
    table = FrequencyTable((1.0, 100.0), (0.1, 0.3))
    assert float(table(10.0, np.array(20.0))) == pytest.approx(0.2)
    with pytest.raises(InputError, match="rising positive"):
        FrequencyTable((10.0, 1.0), (0.1, 0.2))
    with pytest.raises(InputError, match="positive moduli"):
        Prony(1.0, (1.0,), (-1.0,))


def test_bad_requests_are_refused(cycle: StrainHarmonics) -> None:
    with pytest.raises(InputError, match="did you mean 'tread'"):
        RevolutionLoss(cycle, {"treads": OfTemperature(0.1)}, 20.0)
    with pytest.raises(InputError, match="speed must be positive"):
        RevolutionLoss(cycle, {"tread": OfTemperature(0.1)}, 0.0)


def test_linearised_strains_become_coarser_with_deflection() -> None:
    pressing = Pressing(PlainTyre().state(along=10))
    small, large = (StrainHarmonics(pressing.at_deflection(d, 36)).coarseness() for d in (0.002, 0.03))
    assert small.max() < 0.4 * large.max()
