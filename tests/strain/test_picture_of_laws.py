"""The picture of strain laws can be read with one law and with several."""

from __future__ import annotations

import tyrefem as tf
from tyrefem.reports.figures.strain_laws import strain_laws_figure
from tyrefem.simulation.law_comparison import compare_laws


def test_labels_of_the_parts_of_one_law_can_be_read() -> None:
    coarse = {"mesh.size": "16 mm", "drive.duration": "20 s"}
    drawn = strain_laws_figure(compare_laws(tf.study("nasa-22x5.5-8pr", coarse), ("arcs",)))
    drawn.canvas.draw()
    labels = drawn.axes[-1].get_xticklabels()
    assert len(labels) == 5
    assert all(label.get_rotation() > 45 for label in labels)
    extents = [label.get_window_extent() for label in labels]
    assert all(drawn.bbox.containsx(x) for extent in extents for x in extent.intervalx)
    assert all(drawn.bbox.containsy(y) for extent in extents for y in extent.intervaly)
