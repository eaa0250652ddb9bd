"""Areas and volumes against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import ring_section

from tyrefem.geometry import Section, SectionCard, build, load
from tyrefem.geometry.outlines import face, stations

pytestmark = pytest.mark.fast


@pytest.fixture
def ring() -> Section:
    return build(SectionCard.check(ring_section.ring_card()))


# The ring of ring_section: centre (0.2, 0), midline radius 0.1; carcass 0.098-0.102, rubber 0.102-0.108; half is 2 rad.
BANDS = {"carcass": (0.098, 0.102, 0.0, 1.7), "bead": (0.098, 0.102, 1.7, 2.0)}
SHOULDER = float(np.arcsin(0.6))
BANDS |= {"tread": (0.102, 0.108, 0.0, SHOULDER), "sidewall": (0.102, 0.108, SHOULDER, 2.0)}


@pytest.mark.parametrize("region", BANDS)
def test_area_and_volume_of_ring_sectors(ring: Section, region: str) -> None:
    inner, outer, start, end = BANDS[region]
    area = (outer**2 - inner**2) / 2 * (end - start)
    # Integral of r dA with r = 0.2 + rho cos(angle), times 2 pi.
    volume = 2 * np.pi * (0.2 * area + (outer**3 - inner**3) / 3 * (np.sin(end) - np.sin(start)))
    assert ring.area(region) == pytest.approx(area, rel=1e-12)
    assert ring.volume(region) == pytest.approx(volume, rel=1e-12)
    assert ring.as_full().volume(region) == pytest.approx(2 * volume, rel=1e-12)


def test_inner_surface_and_gas_volume_of_the_ring(ring: Section) -> None:
    a = 0.098
    surface = 2 * np.pi * a * (0.2 * 2.0 + a * np.sin(2.0))
    assert ring.inner_surface_area() == pytest.approx(surface, rel=1e-12)
    # Integral of pi r^2 dz, r = 0.2 + a cos t, z = a sin t, minus the cylinder under the bead.
    t = np.linspace(0, 2.0, 200001)
    r, z = 0.2 + a * np.cos(t), a * np.sin(t)
    gas = np.pi * float((((r[1:] + r[:-1]) / 2) ** 2 * np.diff(z)).sum()) - np.pi * r[-1] ** 2 * z[-1]
    assert ring.gas_volume() == pytest.approx(gas, rel=1e-8)
    assert ring.as_full().gas_volume() == pytest.approx(2 * gas, rel=1e-8)


def test_sizes_of_the_ring(ring: Section) -> None:
    assert ring.outer_diameter == pytest.approx(2 * 0.308, rel=1e-12)
    assert ring.overall_width == pytest.approx(2 * 0.108, rel=1e-10)


@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])
def test_outline_polygons_converge_to_the_integral_with_order_two(name: str) -> None:
    section = load(name)
    errors = []
    for spacing in (2e-3, 1e-3, 5e-4):
        areas = {region: sum(map(_area, section.outline(region, spacing))) for region in section.regions}
        errors.append(max(abs(areas[region] - section.area(region)) for region in section.regions))
    assert np.log2(errors[0] / errors[1]) > 1.8
    assert np.log2(errors[1] / errors[2]) > 1.8


@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])
def test_inner_surface_of_variable_thickness(name: str) -> None:
    section = load(name)
    line = face(section, 0, stations(section, 0.0, section.line.length, 2e-5))
    lengths = np.linalg.norm(np.diff(line, axis=0), axis=1)
    cones = 2 * np.pi * float(((line[1:, 0] + line[:-1, 0]) / 2 * lengths).sum())
    assert section.inner_surface_area() == pytest.approx(cones, rel=1e-7)
    r_bead = line[-1, 0]
    discs = np.pi * float((((line[1:, 0] + line[:-1, 0]) / 2) ** 2 - r_bead**2) @ np.diff(line[:, 1]))
    assert section.gas_volume() == pytest.approx(discs, rel=1e-6)


@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])
def test_widest_place_of_the_outer_face(name: str) -> None:
    section = load(name)
    outer = face(section, 2, stations(section, 0.0, section.line.length, 1e-5))
    assert section.overall_width == pytest.approx(2 * outer[:, 1].max(), abs=1e-9)
    assert section.overall_width >= 2 * outer[:, 1].max() - 1e-15


def test_a_measured_gas_volume_replaces_the_computed_one() -> None:
    section = load({"base": "nasa-22x5.5-8pr", "parameters": {"inner_volume": "12 l"}})
    assert section.gas_volume() == pytest.approx(0.006)
    assert section.as_full().gas_volume() == pytest.approx(0.012)


def _area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2)
