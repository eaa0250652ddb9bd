"""Places (s, depth) and points (r, z)."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.geometry import Section, load

NAMES = ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"]


@pytest.fixture(params=NAMES)
def section(request: pytest.FixtureRequest) -> Section:
    return load(request.param, half=False)


def scattered(section: Section, n: int = 500) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(11)
    s = rng.uniform(-section.line.length, section.line.length, n)
    return s, rng.uniform(0, 1, n) * section.total_thickness(s)


def test_locate_inverts_place(section: Section) -> None:
    s, depth = scattered(section)
    found_s, found_depth = section.locate(section.place(s, depth))
    assert np.abs(found_s - s).max() < 1e-9
    assert np.abs(found_depth - depth).max() < 1e-9


def test_locate_reaches_slightly_outside(section: Section) -> None:
    s, _ = scattered(section, 100)
    for depth in (-2e-3, section.total_thickness(s) + 2e-3):
        found_s, found_depth = section.locate(section.place(s, depth))
        assert np.abs(found_s - s).max() < 1e-9
        assert np.abs(found_depth - depth).max() < 1e-9
        assert not section.contains(section.place(s, depth)).any()


def test_half_section_folds_the_other_side_over(section: Section) -> None:
    s, depth = scattered(section)
    half = section.as_half()
    points = section.place(s, depth)
    found_s, found_depth = half.locate(points)
    assert np.abs(found_s - np.abs(s)).max() < 1e-9
    assert np.abs(found_depth - depth).max() < 1e-9
    assert (half.contains(points) == (s >= 0)).all()
    assert section.contains(points).all()


def test_thicknesses_add_up_and_cross_the_table(section: Section) -> None:
    s, _ = scattered(section)
    layers = section.thickness("carcass", s) + section.thickness("rubber", s)
    assert np.allclose(layers, section.total_thickness(s), atol=1e-15)
    regions = section.thickness("tread", s) + section.thickness("sidewall", s)
    assert np.allclose(regions, section.thickness("rubber", s), atol=1e-15)
    # The chord from the inner to the outer face is the thickness.
    chord = section.place(s, section.total_thickness(s)) - section.place(s, 0.0)
    assert np.allclose(np.linalg.norm(chord, axis=1), section.total_thickness(s), atol=1e-12)


def test_midline_offset_is_measured_from_the_carcass(section: Section) -> None:
    s, depth = scattered(section)
    half_carcass = section.thickness("carcass", s) / 2
    assert np.allclose(section.midline_offset(s, depth), depth - half_carcass, atol=1e-12)
    assert np.allclose(section.midline_offset(section.place(s, depth)), depth - half_carcass, atol=1e-9)


def test_readings_of_the_report() -> None:
    # 8PR: the printed R is the carcass midline; 12PR: it is the middle of the whole thickness.
    s = np.linspace(0, 0.14, 50)
    assert np.allclose(load("nasa-22x5.5-8pr").carcass_offset(s), 0.0, atol=1e-15)
    twelve = load("nasa-22x5.5-12pr")
    assert np.allclose(twelve.carcass_offset(s), -twelve.thickness("rubber", s) / 2, atol=1e-15)


def test_region_at_follows_the_borders(section: Section) -> None:
    shoulder, t = section.line.shoulder_s, float(section.thickness("carcass", 0.05))
    s = [0.05, 0.05, -shoulder + 1e-6, -shoulder - 1e-6, 0.14]
    depth = [t - 1e-6, t + 1e-6, 0.015, 0.015, 1e-3]
    assert section.region_at(s, depth).tolist() == ["carcass", "tread", "tread", "sidewall", "bead"]
    assert str(section.region_at(0.01, 1.0)) == "tread"


def test_clamp_keeps_a_displaced_sensor_in_the_rubber(section: Section) -> None:
    s, depth = section.clamp([0.3, -0.01, 0.05], [0.1, -0.02, 0.004], margin=1e-4)
    assert section.contains(section.place(s, depth)).all()
    assert (s[2], depth[2]) == (0.05, 0.004)
    assert np.allclose(depth[:2], [section.total_thickness(s[0]) - 1e-4, 1e-4])


def test_boundary_lines_close_the_section(section: Section) -> None:
    for whole in (section, section.as_half()):
        ends = [
            tuple(line[i].round(9)) for name in whole.boundaries for line in whole.boundary_line(name) for i in (0, -1)
        ]
        assert all(ends.count(end) == 2 for end in ends)


def test_unknown_names_say_the_nearest(section: Section) -> None:
    with pytest.raises(InputError, match="did you mean 'tread'"):
        section.area("tred")
    with pytest.raises(InputError, match="did you mean 'road'"):
        section.boundary_line("raod")
    with pytest.raises(InputError, match=r"allowed|Allowed"):
        section.thickness("belt", 0.0)
