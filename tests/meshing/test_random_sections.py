"""Whatever parameters a study tries: a sound section and mesh, or an InputError."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tyrefem.errors import InputError
from tyrefem.geometry import load
from tyrefem.geometry.meshing import build


def inches(low: float, high: float) -> st.SearchStrategy[str]:
    return st.floats(low, high, allow_nan=False).map(lambda value: f"{value:.6g} in")


CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "outer_diameter": inches(-1, 60),
        "crown_radius": inches(0, 12),
        "sidewall_radius": inches(0, 8),
        "meridian_length": inches(0, 14),
        "nominal_width": inches(0, 14),
        "overall_width": inches(0, 14),
        "bead_length": inches(0, 7),
        "rim_length": inches(0, 7),
        "thickness_scale": st.dictionaries(
            st.sampled_from(["carcass", "tread", "sidewall", "bead"]), st.floats(-0.5, 8).map(str)
        ),
    },
)
BASES = st.sampled_from(["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(base=BASES, parameters=CHANGES, half=st.booleans(), cell=st.sampled_from(["quad", "tri"]))
def test_sound_or_refused(base: str, parameters: dict[str, object], half: bool, cell: str) -> None:
    try:
        section = load({"base": base, "parameters": parameters}, half=half)
        tyre = build(section, size=6e-3, cell=cell)
    except InputError:
        return
    assert all(section.area(region) > 0 for region in section.regions)
    assert section.overall_width > 0
    assert tyre.element_areas.min() > 0
    assert tyre.quality["scaled_jacobian"] > 0
    assert np.array_equal(np.sort(np.concatenate(list(tyre.mesh.boundaries.values()))), tyre.mesh.boundary_facets())


# Changes of a few per cent, as in a design study: every one of them must be buildable.
NEARBY = st.fixed_dictionaries(
    {
        "crown_radius": inches(3.3, 3.7),
        "sidewall_radius": inches(1.85, 2.1),
        "meridian_length": inches(5.6, 6.0),
        "nominal_width": inches(5.3, 5.7),
        "thickness_scale": st.fixed_dictionaries({name: st.floats(0.8, 1.2).map(str) for name in ("tread", "carcass")}),
    }
)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(parameters=NEARBY)
def test_nearby_variants_are_all_buildable(parameters: dict[str, object]) -> None:
    section = load({"base": "nasa-22x5.5-8pr", "parameters": parameters})
    tyre = build(section)
    for region in section.regions:
        assert abs(tyre.volume(region) / section.volume(region) - 1) < 3e-3
