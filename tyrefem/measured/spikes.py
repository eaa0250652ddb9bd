"""Spikes: single readings far from those before and after, as loggers write at a loose contact or an ignition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import counted

#: K; least height of a spike above noise and resolution of usual loggers. Estimate.
LEAST = 5.0
#: Least height over the median of all heights: nearly 7 standard deviations of noise.
OVER_SCATTER = 10.0
#: Most change from the reading before to the one after over the height: a step or a steep ramp is none.
LARGEST_CHANGE = 1.0 / 3.0
#: Fewest readings, of which the scatter is taken.
FEWEST = 8


def spikes(times: NDArray[np.float64], readings: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Indices of single readings that stand alone, and their heights.

    The height of reading i is |T_i - L_i|, with L the line from the reading before to the one after.
    A spike is at least `LEAST` K and `OVER_SCATTER` medians of all heights high, and
    |T_(i+1) - T_(i-1)| is at most `LARGEST_CHANGE` times its height.

    Parameters
    ----------
    times : (n,) s, increasing. readings : (n,) degC of one sensor in one run; NaN where there is none.

    Returns
    -------
    (m,) indices, and (m,) heights in K; none with fewer than `FEWEST` readings.

    >>> indices, heights = spikes(np.arange(9.0), np.array([20.0, 21, 22, 23, 57, 25, 26, 27, 28]))
    >>> indices.tolist(), heights.tolist()
    ([4], [33.0])
    """
    read = np.flatnonzero(np.isfinite(readings))
    if len(read) < FEWEST:
        return read[:0], np.zeros(0)
    t, values = times[read], readings[read]
    share = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    heights = np.abs(values[1:-1] - values[:-2] - share * (values[2:] - values[:-2]))
    least = max(LEAST, OVER_SCATTER * float(np.median(heights)))
    alone = (heights >= least) & (np.abs(values[2:] - values[:-2]) <= LARGEST_CHANGE * heights)
    return read[1:-1][alone], heights[alone]


def spike_notes(
    heading: str,
    numbers: Sequence[int],
    readings: NDArray[np.float64],
    rows_of_runs: Mapping[str, NDArray[np.intp]],
    times_of_runs: Mapping[str, NDArray[np.float64]],
) -> tuple[str, ...]:
    """A note on the spikes of a sensor, which a comparison takes as they are; none without spikes.

    Parameters
    ----------
    heading : of the sensor's column. numbers : line of every row. readings : (n_rows,) degC. rows_of_runs : run -> its
        rows. times_of_runs : run -> their times, s.
    """
    places: list[int] = []
    highest = 0.0
    for run, times in times_of_runs.items():
        rows = rows_of_runs[run]
        indices, heights = spikes(times, readings[rows])
        places += [numbers[row] for row in rows[indices]]
        highest = max(highest, *heights.tolist(), 0.0)
    if not places:
        return ()
    places.sort()
    shown = ", ".join(map(str, places[:4])) + (", ..." if len(places) > 4 else "")
    on, off, where, what = (
        ("is", f"{highest:.1f} K", "line", "the cell")
        if len(places) == 1
        else ("are", f"up to {highest:.1f} K", "lines", "the cells")
    )
    return (
        f"{counted(len(places), 'reading')} of '{heading[:60]}' {on} {off} off the readings before and after "
        f"({where} {shown}): empty {what} if the logger is wrong",
    )
