"""The body ply goes down inside the bead, round below it and up as the turn-up."""

from __future__ import annotations

import numpy as np
import pytest
from constructions import RADIALS

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.geometry.layup import Wrap
from tyrefem.geometry.meshing import build
from tyrefem.mechanics.solid.inflation import inflate
from tyrefem.mechanics.solid.tyre_body import tyre_body

BODY = {"passenger": "body-ply", "truck": "body-ply", "aircraft": "body-plies"}


@pytest.mark.parametrize("name", RADIALS)
def test_a_cord_can_be_followed_from_the_body_ply_round_the_bead_into_the_turn_up(name):
    """Along the field of directions in steps of 0.1 mm, from the middle of the ply above the bead."""
    section = RADIALS[name].section
    wrap = section.wrapping
    start = next(piece.start for piece in section.pieces if piece.region == "bead-wrap")
    low, high = wrap.layers[0], wrap.layers[-1]
    faces = section.interfaces(start)
    y = faces[low + 1] - wrap.thickness / 2
    place = section.line.position(start - 2e-3) + y * section.line.normal(start - 2e-3)
    seen, before = [], section.ply_direction(place)
    for _ in range(600):
        direction = section.ply_direction(place)
        # A line element has no sign: it goes on the way it came.
        direction = direction if direction @ before > 0 else -direction
        assert direction @ before > np.cos(np.radians(15.0))
        before, place = direction, place + 1e-4 * direction
        s, depth = (float(coordinate) for coordinate in section.locate(place))
        region = str(section.region_at(s, depth))
        if not seen or seen[-1] != region:
            seen.append(region)
        if region == "turn-up" and s < start - 2e-3:
            break
    assert seen == [BODY[name], "bead-wrap", "turn-up"]
    # Not at the turn-up's edge: the meridian bends, so that the strip below the bead is thicker outside.
    s, y = section.line.nearest(place)
    assert 0.2 < float(y - section.interfaces(s)[high]) / wrap.thickness < 0.8


@pytest.mark.usefixtures("needs_gmsh")
@pytest.mark.parametrize(("name", "mesher"), [*((name, "mapped") for name in RADIALS), ("passenger", "gmsh")])
def test_both_meshers_have_the_wrap_and_its_cords(name, mesher):
    section = RADIALS[name].section
    mesh = build(section, mesher=mesher, size=RADIALS[name].size, through=1)
    assert mesh.area("bead-wrap") == pytest.approx(section.area("bead-wrap"), rel=2e-3)
    pieces = [piece for piece in section.pieces if piece.region == "bead-wrap"]
    across = sum(float(section.layers[piece.layer].thickness(piece.start)) for piece in pieces)
    # The meridian bends here, about a centre 20 to 30 mm away: what lies outside of it is shorter or longer.
    middle = (pieces[0].start + pieces[0].end) / 2
    faces = section.interfaces(middle)
    y = (faces[pieces[0].layer] + faces[pieces[-1].layer + 1]) / 2
    bent = 1 + float(section.line.curvature(middle)) * y
    assert mesh.area("bead-wrap") == pytest.approx(bent * across * section.wrapping.thickness, rel=0.03)
    middle = mesh.mesh.p[:, mesh.mesh.t[:, mesh.mesh.subdomains["bead-wrap"]]].mean(axis=1)
    s, y = section.line.nearest(middle.T)
    turned = np.abs((mesh.along_meridian(middle).T * section.line.normal(s)).sum(axis=1))
    faces = section.interfaces(s)
    between = (y > faces[pieces[1].layer]) & (y < faces[pieces[1].layer + 1])
    assert between.any()
    assert turned[between] == pytest.approx(1.0, abs=1e-9)
    assert ((turned[~between] > 0.02) & (turned[~between] < 0.999)).all()
    ply = mesh.mesh.p[:, mesh.mesh.t[:, mesh.mesh.subdomains[BODY[name]]]].mean(axis=1)
    s, _ = section.line.nearest(ply.T)
    assert np.abs((mesh.along_meridian(ply).T * section.line.normal(s)).sum(axis=1)).max() < 1e-9


def test_the_other_half_of_a_full_section_is_the_mirror_image():
    half = RADIALS["truck"].section
    full = half.as_full()
    rng = np.random.default_rng(3)
    start = half.wrapping._stretch[0]
    places = half.place(rng.uniform(start - 4e-3, start + 4e-3, 60), rng.uniform(1e-3, 25e-3, 60))
    first, other = full.ply_direction(places), full.ply_direction(places * [1.0, -1.0])
    assert np.abs((first * other * [1.0, -1.0]).sum(axis=1)) == pytest.approx(1.0, abs=1e-6)


def test_a_wrap_in_pieces_is_refused():
    with pytest.raises(InputError, match="must lie on each other"):
        Wrap(RADIALS["passenger"].section, "chafer")
    with pytest.raises(InputError, match="no region 'bead-rap'; did you mean 'bead-wrap'"):
        tf.study("passenger-205-55r16", {"section.wrap.region": "bead-rap"})


def test_the_bead_wires_carry_the_ply_that_is_wrapped_round_them():
    """T = p (r_w^2 - r_b^2)/2: the ply's pull r N_phi = p (r^2 - r_w^2)/2 at the bundle, r_w the widest place."""
    study = tf.study("passenger-205-55r16", {"mesh.size": "8 mm"})
    section = study.section
    tyre = inflate(study, None, build(section, size=16e-3, through=1))
    s = np.linspace(0, section.line.length, 2000)
    line = section.line.position(s)
    widest = float(line[line[:, 1].argmax(), 0])
    bundle = next(piece for piece in section.pieces if piece.region == "bead")
    radius = float(section.line.position((bundle.start + bundle.end) / 2)[0])
    netting = tyre.pressure * (widest**2 - radius**2) / 2
    # Rubber and the flange take the rest.
    assert 0.4 < tyre.bead_tension / netting < 1.1
    ends = tyre_body(study, build(section, size=16e-3, through=1)).parts["bead-wrap"].cords[0]
    assert np.degrees(ends.angle) == pytest.approx(90.0)
