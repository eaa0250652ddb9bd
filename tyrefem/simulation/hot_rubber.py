"""A warning of rubber that gets hotter than it bears."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.conduction.field import Peak

#: degC above which rubber cured with sulphur reverts: it softens and loses strength within minutes. Estimate, from
#: memory: tyres are cured at 150 to 180 degC.
REVERSION = 150.0


def hot_rubber(peaks: Mapping[str, Peak]) -> tuple[str, ...]:
    """A warning if a region gets hotter than `REVERSION`; ``peaks``: highest temperatures by region.

    >>> from tyrefem.conduction.field import Peak
    >>> hot_rubber({"tyre": Peak(163.2, (0.3, 0.1), 1200.0), "shoulder": Peak(163.2, (0.3, 0.1), 1200.0)})
    ('shoulder: 163 degC at 1200 s; above about 150 degC rubber loses its strength (an estimate), which no property here
    follows',)
    """
    region = max((name for name in peaks if name != "tyre"), key=lambda name: peaks[name].temperature)
    peak = peaks[region]
    if peak.temperature <= REVERSION:
        return ()
    return (
        f"{region}: {peak.temperature:.0f} degC at {peak.time:g} s; above about {REVERSION:g} degC rubber loses its "
        "strength (an estimate), which no property here follows",
    )
