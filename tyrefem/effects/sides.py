"""The two sides of a full section: what camber and yaw share."""

from __future__ import annotations

from tyrefem.effects.tyre import StudyOfTyre, Tyre


def half_width(tyre: Tyre) -> tuple[float, float]:
    """z of the two shoulders on the meridian, m."""
    line = tyre.study.section.line
    z = float(line.position([line.shoulder_s])[0, 1])
    return -z, z


def needs_full(study: StudyOfTyre) -> str | None:
    """Why an effect that tells the sides apart has no meaning in a study."""
    return None if study.card.mesh.section == "full" else "needs the full section: [mesh] section = 'full'"
