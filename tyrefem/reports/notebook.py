"""Objects as HTML for notebooks: the verdict first, a picture, the main facts. Nothing but one piece of HTML.

Text and lines take the notebook's colour, so that they are seen on light and dark; no styles outside the piece.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief, cut, heading_of, short
from tyrefem.mechanics.cautions import warnings_of
from tyrefem.reports.figures.style import FILLS

if TYPE_CHECKING:
    from tyrefem.compare.comparison import ComparisonData
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.result import ResultData
    from tyrefem.sweep.design import DesignData

#: Colours that are seen on white and on black: of what is good, what is not, and what is neither.
GOOD, BAD, PLAIN = "#2a9d6f", "#d9601a", "#3b8fd0"
#: Width and height of a picture, pixels.
WIDTH, HEIGHT = 340, 220
#: Most rows of facts and most bars of a picture.
ROWS, BARS = 12, 10


def page(thing: Brief, verdict: str, picture: str, *, colour: str = PLAIN, leave_out: Sequence[str] = ()) -> str:
    """One piece of HTML: heading and verdict, facts of the object, and a picture."""
    facts = {name: value for name, value in thing._facts().items() if name not in leave_out}
    cell = "padding:1px 10px 1px 0;text-align:left;vertical-align:top;border:none;background:none;color:inherit"
    rows = "".join(
        f'<tr style="background:none"><th style="{cell};font-weight:normal;opacity:.65;white-space:nowrap">'
        f'{escape(name)}</th><td style="{cell};white-space:normal">{escape(_text(value))}</td></tr>'
        for name, value in list(facts.items())[:ROWS]
    )
    table = "border-collapse:collapse;margin:0;border:none;font-size:inherit;color:inherit;flex:1 1 320px"
    return (
        f'<div style="font-size:13px;line-height:1.45;max-width:900px;color:inherit">'
        f'<div style="border-left:4px solid {colour};padding-left:10px;margin-bottom:6px"><strong>{escape(verdict)}'
        f'</strong><br><span style="opacity:.65">{escape(heading_of(thing))}</span></div>'
        f'<div style="display:flex;flex-wrap:wrap;gap:18px;align-items:flex-start"><div>{picture}</div>'
        f'<table style="{table}">{rows}</table>'
        "</div></div>"
    )


def _text(value: Any) -> str:
    return cut(value if isinstance(value, str) else short(value), 220)


def _svg(content: str, label: str, width: float = WIDTH, height: float = HEIGHT) -> str:
    return (
        f'<svg role="img" aria-label="{escape(label, quote=True)}" viewBox="0 0 {width:g} {height:g}" '
        f'width="{width:g}" height="{height:g}" style="max-width:100%;color:inherit" font-size="11" '
        f'font-family="sans-serif" fill="currentColor">{content}</svg>'
    )


# -- study -------------------------------------------------------------------------------------------------------------


def study_page(study: StudyData) -> str:
    """A study: whether it can run as it is, and its section with the regions and sensors."""
    warnings = warnings_of(study)
    ready = f"Ready to run: {study.title}"
    if warnings:
        ready += f" - {len(warnings)} warning{'s' if len(warnings) > 1 else ''}, the first: {warnings[0]}"
    return page(study, ready, section_picture(study), colour=BAD if warnings else GOOD, leave_out=("title",))


def section_picture(study: StudyData) -> str:
    """The section with its regions, both sides, and the places of the sensors."""
    section = study.section
    outlines = {region: section.outline(region, 1e-3) for region in section.regions}
    every = np.concatenate([polygon for polygons in outlines.values() for polygon in polygons])
    (low, high), half = (every[:, 0].min(), every[:, 0].max()), np.abs(every[:, 1]).max()
    scale = min((WIDTH - 10) / (2 * half), (HEIGHT - 10) / (high - low))

    def at(points: Any, sign: float = 1.0) -> np.ndarray:
        r, z = np.asarray(points, dtype=float).T
        return np.column_stack([WIDTH / 2 + sign * z * scale, 5 + (high - r) * scale])

    shapes = []
    for number, (region, polygons) in enumerate(outlines.items()):
        for polygon in polygons:
            for sign in (1.0, -1.0) if section.half else (1.0,):
                path = " ".join(f"{x:.1f},{y:.1f}" for x, y in at(polygon, sign))
                shapes.append(
                    f'<polygon points="{path}" fill="{FILLS[number % len(FILLS)]}" stroke="#404040" '
                    f'stroke-width=".5"><title>{escape(region)}</title></polygon>'
                )
    for name, place in study.stated_places.items():
        ((x, y),) = at([place])
        shapes.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#fff" stroke="#1b1b1b"><title>{escape(name)}</title>'
            "</circle>"
        )
    label = f"section with the regions {', '.join(section.regions)}"
    return _svg("".join(shapes), label, height=10 + (high - low) * scale)


# -- result ------------------------------------------------------------------------------------------------------------


def result_page(result: ResultData) -> str:
    """A result: the hottest place, the rolling resistance, and the temperatures at the end."""
    peaks = result.peaks
    hot = max((region for region in peaks if region != "tyre"), key=lambda name: peaks[name].temperature)
    resistance = result.rolling_resistance
    verdict = f"{peaks['tyre'].temperature:.1f} °C at most, in the {hot} after {peaks['tyre'].time:g} s"
    if resistance.phase:
        verdict += f"; rolling resistance {resistance.force:.1f} N, coefficient {resistance.coefficient:.4f}"
    if result.history.interrupted:
        verdict = f"Interrupted at {result.times[-1]:g} s. {verdict}"
    doubtful = result.history.interrupted or bool(result.warnings)
    picture = temperature_picture(result) + histories_picture(result)
    return page(result, verdict, picture, colour=BAD if doubtful else GOOD)


def temperature_picture(result: ResultData) -> str:
    """The section's temperature at the end, with a scale."""
    from tyrefem.reports.figures.cells import triangles
    from tyrefem.reports.raster import COLOURS, png, raster

    operators, values = result.tyre.problem.operators, np.asarray(result.history.values[-1])
    corners, _ = triangles(operators)
    r, z = operators.points
    low, high = float(values.min()), float(max(values.max(), values.min() + 0.01))
    across = 2 * np.abs(z).max()
    # Two pixels of the picture on one of the page, for fine screens.
    scale = 2 * WIDTH / across
    shape = (round(np.ptp(r) * scale), 2 * WIDTH)
    sides = (1.0, -1.0) if result.study.section.half else (1.0,)
    points = [np.column_stack([(across / 2 + sign * z) * scale, (r.max() - r) * scale]) for sign in sides]
    images = [raster(each, corners, values, shape) for each in points]
    content = png(np.where(np.isnan(images[0]), images[-1], images[0]), low, high)
    stops = ",".join(f"#{colour}" for colour in COLOURS)
    return (
        f'<img alt="temperatures of the section at {result.times[-1]:g} s" width="{WIDTH}" style="max-width:100%;'
        f'background:none" src="data:image/png;base64,{base64.b64encode(content).decode("ascii")}">'
        f'<div style="display:flex;gap:6px;align-items:center;width:{WIDTH}px;max-width:100%">{low:.1f}'
        f'<div style="flex:1;height:8px;background:linear-gradient(to right,{stops})"></div>{high:.1f} °C</div>'
    )


def histories_picture(result: ResultData) -> str:
    """Readings over time as lines, with their ranges."""
    readings = result.readings
    names = [name for name in readings.columns if name != "time_s"]
    t = readings["time_s"].to_numpy()
    values = readings[names].to_numpy()
    low, high = float(values.min()), float(max(values.max(), values.min() + 0.01))
    width, height, left = WIDTH, 90.0, 34.0
    chosen = np.unique(np.linspace(0, len(t) - 1, min(len(t), 120)).astype(int))
    span = max(float(t[-1] - t[0]), 1e-9)

    def line(name: str, number: int) -> str:
        xs = left + (t[chosen] - t[0]) / span * (width - left - 4)
        ys = 4 + (high - values[chosen, number]) / (high - low) * (height - 22)
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(xs, ys, strict=True))
        return (
            f'<polyline points="{path}" fill="none" stroke="{(PLAIN, BAD, GOOD)[number % 3]}" stroke-width="1.3">'
            f"<title>{escape(name)}</title></polyline>"
        )

    content = "".join(line(name, number) for number, name in enumerate(names))
    content += f'<text x="0" y="12">{high:.0f} °C</text><text x="0" y="{height - 16:g}">{low:.0f}</text>'
    content += f'<text x="{width:g}" y="{height - 2:g}" text-anchor="end">{t[-1]:g} s</text>'
    return "<br>" + _svg(content, f"readings of {', '.join(names)} over time", width, height)


# -- comparison, diagnosis, sweep --------------------------------------------------------------------------------------


def comparison_page(comparison: ComparisonData) -> str:
    """A comparison: how many histories are beyond the uncertainty, and the deviation of every sensor."""
    whole = comparison.table[comparison.table["phase"] == "all"]
    beyond = int(whole["beyond"].sum())
    verdict = (
        f"{'Within' if not beyond else 'Beyond'} the validation uncertainty: {beyond} of {len(whole)} sensor histories "
        f"beyond (k = {comparison.k:g}); {comparison.rms_K:.2f} K rms, {comparison.bias_K:+.2f} K on average"
    )
    rows = whole.sort_values("rms_K", ascending=False).head(BARS)
    several = rows["run"].nunique() > 1
    bars = {
        (f"{row['sensor']}, {row['run']}" if several else str(row["sensor"])): (
            float(row["rms_K"]), BAD if row["beyond"] else GOOD,
        )
        for row in rows.to_dict("records")
    }  # fmt: skip
    picture = bars_picture(bars, "K", "root mean square deviation")
    return page(comparison, verdict, picture, colour=BAD if beyond else GOOD)


def diagnosis_page(diagnosis: DiagnosisData) -> str:
    """A diagnosis: what is wrong and how sure, and the sets of effects with their probabilities."""
    from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, NO_GAP
    from tyrefem.diagnose.words.headline import headline, label

    wrong, sure, _ = headline(diagnosis)
    sets = diagnosis.judgement.ranking[:BARS]
    bars = {entry.key or "no effect": (100 * float(entry.probability), PLAIN) for entry in sets}
    colour = GOOD if label(diagnosis) in (IDENTIFIED, NO_GAP) else BAD
    verdict = f"{label(diagnosis)}: {wrong} {sure}"
    return page(diagnosis, verdict, bars_picture(bars, "%", "probability of sets of effects"), colour=colour)


def diagnosis_record_page(record: Any) -> str:
    """A diagnosis from its folder, as `diagnosis_page` has it: an `api.DiagnosisRecord`."""
    bars = {name: (100 * share, PLAIN) for name, share in list(record.sets.items())[:BARS]}
    colour = GOOD if record.label in ("identified", "no gap") else BAD
    verdict = f"{record.label[0].upper()}{record.label[1:]}: {' '.join(record.headline[:2])}"
    return page(record, verdict, bars_picture(bars, "%", "probability of sets of effects"), colour=colour)


def design_page(design: DesignData) -> str:
    """A sweep: its first answer, and the variants by their first two answers, those on the Pareto front filled."""
    words = design.words
    verdict = words[0] if words else "no answer"
    if design.interrupted:
        verdict = f"Interrupted: {design.interrupted}. {verdict}"
    return page(design, verdict, variants_picture(design), colour=BAD if design.interrupted or design.failed else GOOD)


def variants_picture(design: DesignData) -> str:
    """Variants by the first two answers of the Pareto front; nothing without a table of two answers."""
    if design.swept is None and design.optimum is None:
        return ""
    table, front = design.table, design.pareto
    usual = ("hottest_degC", "rolling_resistance_coefficient")
    goals = [name for name in (design.card.pareto or usual) if name in table]
    if len(goals) < 2:
        return ""
    x, y = goals[0], goals[1]
    chosen = table[[x, y]].dropna()
    if chosen.empty:
        return ""
    ends = [(float(chosen[name].min()), float(max(chosen[name].max(), chosen[name].min() + 1e-12))) for name in (x, y)]
    on_front = set(front.index)

    def circle(index: Any, row: Mapping[str, float]) -> str:
        px, py = ((float(row[name]) - low) / (high - low) for name, (low, high) in zip((x, y), ends, strict=True))
        fill = GOOD if index in on_front else "none"
        place = f'cx="{40 + px * (WIDTH - 60):.1f}" cy="{HEIGHT - 40 - py * (HEIGHT - 60):.1f}"'
        words = escape(f"{x} {row[x]:.4g}, {y} {row[y]:.4g}")
        return f'<circle {place} r="4" fill="{fill}" stroke="{PLAIN}"><title>{words}</title></circle>'

    content = "".join(circle(index, dict(row)) for index, row in chosen.head(2000).iterrows())
    content += f'<text x="40" y="{HEIGHT - 16}">{ends[0][0]:.4g}</text>'
    content += f'<text x="{WIDTH - 4}" y="{HEIGHT - 16}" text-anchor="end">{ends[0][1]:.4g}</text>'
    content += f'<text x="{WIDTH / 2}" y="{HEIGHT - 3}" text-anchor="middle">{escape(x)}</text>'
    content += f'<text x="4" y="14">{ends[1][1]:.4g} {escape(y)}</text>'
    content += f'<text x="4" y="{HEIGHT - 32}">{ends[1][0]:.4g}</text>'
    return _svg(content, f"variants by {x} and {y}")


def bars_picture(bars: Mapping[str, tuple[float, str]], unit: str, label: str) -> str:
    """Named bars with their values and colours."""
    if not bars:
        return ""
    longest = max((value for value, _ in bars.values() if np.isfinite(value)), default=0.0) or 1.0
    content = []
    for number, (name, (value, colour)) in enumerate(bars.items()):
        y = 24 * number
        width = max((WIDTH - 60) * (value if np.isfinite(value) else 0.0) / longest, 1.0)
        content.append(
            f'<text x="0" y="{y + 9}">{escape(cut(name, 52))}</text><rect x="0" y="{y + 11}" width="{width:.1f}" '
            f'height="5" fill="{colour}"/><text x="{width + 4:.1f}" y="{y + 18}">{value:.3g} {escape(unit)}</text>'
        )
    return _svg("".join(content), f"{label}, {unit}", height=24 * len(bars) + 2)
