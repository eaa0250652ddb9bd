"""A section whose numbers have closed forms: a ring sector of constant thickness around one circle."""

from __future__ import annotations

from typing import Any


def ring_card() -> dict[str, Any]:
    """Both arcs of one radius (100 mm) about (200 mm, 0), 2 radians long; 4 mm carcass inside, 6 mm tread outside."""
    return {
        "title": "ring",
        "line": {"kind": "two-arcs", "reference": "carcass", "source": "made up for a test"},
        "parameters": {
            "crown_midline_radius": "300 mm",
            "nominal_width": "160 mm",
            "shoulder_fraction": "0.75",
            "crown_radius": "100 mm",
            "sidewall_radius": "100 mm",
            "meridian_length": "200 mm",
            "bead_length": "30 mm",
            "rim_length": "20 mm",
            "source": "made up for a test",
        },
        "layers": [
            {
                "name": "carcass",
                "s": ["0 mm", "200 mm"],
                "thickness": ["4 mm", "4 mm"],
                "regions": [{"name": "carcass", "to": "bead_start"}, {"name": "bead"}],
                "source": "made up for a test",
            },
            {
                "name": "rubber",
                "s": {"unit": "mm", "values": [0, 200]},
                "thickness": {"unit": "mm", "values": [6, 6]},
                "regions": [{"name": "tread", "to": "shoulder"}, {"name": "sidewall"}],
                "source": "made up for a test",
            },
        ],
        "boundaries": [
            {"name": "road", "to": "shoulder"},
            {"name": "outside_air", "to": "rim_start"},
            {"name": "rim"},
        ],
    }
