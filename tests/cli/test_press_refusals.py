"""Constructions and loads that cannot be: one clear line from `tyrefem press` and `tyrefem run`."""

from __future__ import annotations

from collections.abc import Callable

import pytest

RADIAL, BIAS = "passenger-205-55r16", "nasa-22x5.5-8pr"
COARSE = ["--set", "mesh.size=12 mm"]
CORDS = "materials.belt-1.cords"
FEM = ["--set", "mechanics.strain=fem", "--set", "drive.duration=10 s"]
LINEAR = ("--set", "mechanics.motion=linear")


@pytest.mark.parametrize(
    ("study", "change", "words"),
    [
        (RADIAL, f"{CORDS}.angle=95 deg", "study.toml: materials.belt-1.cords.angle: 95 deg is out of range"),
        (RADIAL, f"{CORDS}.ends=2000 1/m", "cords.ends: 2000 cords per metre of 0.53 mm do not fit side by side"),
        (RADIAL, "materials.bead.cords.ends=90000 1/m", "cords.ends: "),
        (RADIAL, f"{CORDS}.compression_modulus=900 GPa", "must be at most the modulus in tension"),
        (
            RADIAL,
            "section.layers.2.regions.0.to=110 mm",
            "parts follow each other from crown to bead and cannot overlap",
        ),
        (RADIAL, "section.layers.2.regions.0.to=240 mm", "beyond the section"),
        (RADIAL, "section.layers.1.thickness.values=[-1.1, 1.1]", "layers.1.thickness: must be positive everywhere"),
        (RADIAL, "mesh.size=100 mm", "mesh.size: the mesh of the mechanics, 2 times as coarse"),
        (RADIAL, "drive.drum_diameter=1 mm", "drive.drum_diameter: a drum of 1 mm is too small"),
        (RADIAL, "published.footprint_length.between=['2 m', '1 m']", "the first of the two must be less"),
        (RADIAL, "published.stiffness=3", "published: unknown key 'stiffness'; did you mean 'vertical_stiffness'"),
        (BIAS, "section.rating.cord_angle=90 deg", "crown angles of 10 to 80 deg, not 90 deg"),
        (BIAS, "materials.carcass.cord.crown_angle=95 deg", "cord.crown_angle: '95 deg' is out of range"),
    ],
)
def test_a_bad_construction(refused: Callable[..., str], study: str, change: str, words: str) -> None:
    assert words in refused("press", study, *COARSE, "--set", change)


def test_more_than_the_tyre_can_carry(refused: Callable[..., str]) -> None:
    error = refused("press", BIAS, "--load", "500 kN", *COARSE)
    assert "--load: the tyre cannot carry 5e+05 N: the crown meets the rim at" in error


def test_a_run_says_so_too(refused: Callable[..., str]) -> None:
    """The load law still gives a deflection here; the finite elements do not."""
    error = refused("run", RADIAL, *FEM, *LINEAR, "--set", "mesh.size=20 mm", "--set", "drive.load=60 kN")
    assert "study.toml: drive.load: the tyre cannot carry 60000 N: the crown meets the rim" in error


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--camber", "40 deg"], "--camber: must be between -34.4 and 34.4 deg, not 40 deg"),
        (["--camber", "2"], "--camber: '2' has no unit"),
        (["--at", "treat"], "--at: 'treat' is neither a place like '287 mm, 80 mm' (r, z) nor a region; did you mean"),
        (["--at", "1 m, 2 m"], "--at: '1 m, 2 m' is not in the section, whose nearest point is"),
        (["--drum", "1 mm"], "--drum: a drum of 1 mm is too small"),
        (["--pressure", "50 MPa", "--set", "mesh.size=18 mm"], "--pressure: no equilibrium beyond"),
    ],
)
def test_a_bad_option(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("press", BIAS, *COARSE, *arguments)
