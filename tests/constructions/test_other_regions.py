"""A tyre whose regions have other names than those of the shipped ones."""

from __future__ import annotations

from typing import Any

import tyrefem as tf


def test_a_tread_of_another_name_meets_the_road() -> None:
    quick = {"mesh.size": "8 mm", "drive.duration": "60 s", "mechanics.strain": "given"}
    study = tf.study("passenger-205-55r16", quick)

    def renamed(table: dict[str, Any]) -> dict[str, Any]:
        return {("cap" if region == "tread" else region): value for region, value in table.items()}

    other = study.replace(
        {
            "section.layers.tread.regions.0.name": "cap",
            "materials": renamed(study.data["materials"]),
            "mechanics.energy.regions": renamed(study.data["mechanics"]["energy"]["regions"]),
        }
    )
    assert "tread" not in other.section.regions
    assert other.run().readings.equals(study.run().readings)
