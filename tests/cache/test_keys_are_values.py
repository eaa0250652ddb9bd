"""What is remembered follows the content of its inputs, whatever objects hold it."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.conduction.operators import operators_of
from tyrefem.geometry.wall import wall_of
from tyrefem.mechanics import arcs
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.simulation import surroundings
from tyrefem.simulation.surroundings import Surroundings

QUICK = {"mesh.size": "12 mm", "drive.duration": "30 s"}


@pytest.fixture(scope="module")
def study() -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", QUICK)


def test_places_follow_an_array_that_is_changed_in_place(study: tf.Study) -> None:
    points = study.section.place(np.array([0.02, 0.05]), 0.004).T
    around = Surroundings(study)
    first = around.places(points)[0].copy()
    crown = arcs.places(study.section, True, points).s.copy()
    points[:] = study.section.place(np.array([0.01, 0.03]), 0.004).T
    np.testing.assert_allclose(first, [0.02, 0.05], atol=1e-9)
    np.testing.assert_allclose(around.places(points)[0], [0.01, 0.03], atol=1e-9)
    assert np.all(arcs.places(study.section, True, points).s < crown)


def test_equal_points_are_located_once(study: tf.Study) -> None:
    around, points = Surroundings(study), study.section.place(np.linspace(0.01, 0.05, 9), 0.004).T
    assert around.places(points) is around.places(points.copy())


def test_places_that_are_remembered_are_few(study: tf.Study) -> None:
    around = Surroundings(study)
    for s in np.linspace(0.0, 0.05, surroundings._PLACES.size + 10):
        points = study.section.place(np.array([s]), 0.004).T
        around.places(points)
        arcs.places(study.section, True, points)
    assert len(surroundings._PLACES) == surroundings._PLACES.size
    assert len(arcs._PLACES) == arcs._PLACES.size


def test_studies_read_twice_share_what_depends_on_their_section(study: tf.Study) -> None:
    other = tf.study("nasa-22x5.5-8pr", QUICK)
    assert other.section is not study.section
    assert wall_of(other.mesh()) is wall_of(study.mesh())
    mesh, again = study.mesh().mesh, other.mesh().mesh
    assert mesh is not again
    assert operators_of(mesh) is operators_of(again)


def test_meshes_that_differ_in_a_name_only_do_not_share_operators(study: tf.Study) -> None:
    mesh = study.mesh().mesh
    renamed = mesh.with_subdomains({"another": mesh.subdomains["tread"]})
    assert operators_of(renamed) is not operators_of(mesh)
    assert "another" not in operators_of(mesh).mesh.subdomains


def test_a_schedule_gives_the_same_at_a_time_before_and_after_it_forgets(study: tf.Study) -> None:
    schedule = cycle_schedule(study.replace({"drive.load": {"from": "1000 lbf", "to": "2700 lbf"}}))
    first = schedule.weights(7.5), schedule.revolutions_per_second(7.5)
    for time in np.linspace(0.0, 30.0, 1000):
        schedule.weights(float(time))
    assert schedule._weights.cache_info().currsize <= 512
    assert (schedule.weights(7.5), schedule.revolutions_per_second(7.5)) == first
    assert sum(weight for _, _, weight in first[0]) == pytest.approx(1.0)


def test_threads_that_run_different_studies_get_the_answers_of_one_thread() -> None:
    changes = [
        QUICK | {"drive.speed": f"{speed} mph", "section.crown_radius": f"{radius} in"}
        for speed in (10, 20)
        for radius in (3.5, 3.6)
    ]

    def hottest(change: dict[str, str]) -> np.ndarray:
        return tf.study("nasa-22x5.5-8pr", change).run().readings.to_numpy()

    alone = [hottest(change) for change in changes]
    with ThreadPoolExecutor(2) as pool:
        together = list(pool.map(hottest, changes * 2))
    for number, readings in enumerate(together):
        np.testing.assert_allclose(readings, alone[number % len(changes)], rtol=1e-12)
