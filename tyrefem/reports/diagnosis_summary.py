"""One page that prints well: the numbers of a diagnosis that a colleague needs."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.brief import counted
from tyrefem.diagnose.numbers import correction_amount, correction_subject, percent
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.corrections import corrections
from tyrefem.diagnose.words.discrepancy_record import effect_probability
from tyrefem.diagnose.words.effects import effect_amounts, effect_sentence
from tyrefem.diagnose.words.headline import QUESTIONS, headline, label
from tyrefem.diagnose.words.heat import course_words, source_amount, source_place
from tyrefem.diagnose.words.law import law_words
from tyrefem.diagnose.words.next_steps import next_words
from tyrefem.diagnose.words.result_tables import set_rows
from tyrefem.diagnose.words.sentences import noise_words
from tyrefem.output import versions
from tyrefem.reports.diagnosis_gap import gap_figure
from tyrefem.reports.diagnosis_missing import tells_missing_heat
from tyrefem.reports.figures.style import picture
from tyrefem.reports.template import rendered

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.materiality import Movement

SUMMARY = "summary.html"
#: A4 between its margins, mm; height of a line of text and the space above a heading, mm.
WIDTH, HEIGHT, MARGIN, LINE, GAP = 186.0, 273.0, 12.0, 4.1, 1.8
#: Characters that surely fit a line of text, and a line of small text.
CHARACTERS, SMALL_CHARACTERS = 112, 124
#: Of them, those of the link to the whole page.
LINK = 28
#: Least and largest height of the picture, mm.
LEAST_PICTURE, MOST_PICTURE = 55.0, 125.0
#: Rows of each table, panels and sensors of the picture.
ROWS, RUNS, SENSORS = 6, 8, 10


@dataclass(frozen=True)
class SummaryTable:
    """A small table: ``words`` are the numbers of the columns that are text."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: tuple[int, ...] = (0,)


def summary(d: DiagnosisData, *, version: str) -> str:
    """The summary as a self-contained HTML page that fills at most one page of A4.

    The lines of text are counted, and the picture gets the height that they leave; a table shows at most `ROWS` rows.
    """
    tables, sentences = summary_tables(d), [clipped(sentence) for sentence in headline(d)]
    made = [clipped(sentence) for sentence in _made(d)]
    origin = clipped(_origin(d, version), SMALL_CHARACTERS - LINK)
    drawn = gap_figure(d, 7.6, RUNS, SENSORS if len(d.gap.runs) <= RUNS / 2 else SENSORS // 2)
    return rendered(
        "diagnosis_summary.html",
        d=d,
        label=label(d),
        headline=list(zip(QUESTIONS, sentences, strict=True)),
        origin=origin,
        picture=base64.b64encode(picture(drawn, ".svg")).decode("ascii"),
        picture_mm=f"{picture_height(tables, sentences, made):.0f}",
        tables=tables,
        made=made,
        margin=f"{MARGIN:g}",
        width=f"{WIDTH:g}",
        line=f"{LINE:g}",
        gap=f"{GAP:g}",
    )


def clipped(sentence: str, most: int = 4 * CHARACTERS) -> str:
    """Text with at most ``most`` characters, cut after a sentence or clause in its second half, else between words.

    >>> clipped("a thermocouple at the crown", 16)
    'a thermocouple …'
    >>> clipped("it is late; as is the one at the crown (by 3 s)", 20)
    'it is late; …'
    """
    if len(sentence) <= most:
        return sentence
    left = sentence[: most - 1]
    end = max(left.rfind(mark) for mark in (". ", "; ")) + 1
    return f"{left[:end] if end > most / 2 else left.rpartition(' ')[0]} …"


def picture_height(tables: tuple[SummaryTable, ...], sentences: list[str], made: list[str]) -> float:
    """Height that text and tables leave to the picture, mm."""
    longest = max(len(question) for question in QUESTIONS) + 2
    lines = 1 + sum(math.ceil((len(sentence) + longest) / CHARACTERS) for sentence in sentences)
    lines += 1 + sum(math.ceil(len(sentence) / SMALL_CHARACTERS) for sentence in made)
    headings = len(tables) + 1
    lines += headings + sum(1 + sum(_height(row, table) for row in table.rows) for table in tables)
    text = 6.0 + LINE * (1 + lines) + GAP * (2 + headings) + 0.4 * headings
    return min(max(HEIGHT - text - 3.0, LEAST_PICTURE), MOST_PICTURE)


def _height(row: tuple[str, ...], table: SummaryTable) -> int:
    """Lines of a table's row: columns of text share the width that the numbers leave."""
    numbers = sum(len(cell) + 2 for number, cell in enumerate(row) if number not in table.words)
    words = [row[number] for number in table.words]
    longest = max(len(cell) for cell in words)
    share = max((SMALL_CHARACTERS - numbers) * longest / max(sum(len(cell) + 2 for cell in words), 1), 10)
    return math.ceil(longest / share)


def summary_tables(d: DiagnosisData) -> tuple[SummaryTable, ...]:
    """The tables of the summary; those without rows are left out."""
    sets = _beside(d) if d.verdict == PARTLY else _sets(d)
    tables = (_missing(d), _effects(d), _rms(d), _corrections(d), sets)
    return tuple(table for table in tables if table.rows)


def _effects(d: DiagnosisData) -> SummaryTable:
    members = d.best.members if d.verdict not in (NO_GAP, UNEXPLAINED) else ()
    rows = [
        (
            f"{member.key}: {effect_sentence(member, d.best)}",
            "; ".join(effect_amounts(member, d.best)),
            _moves(d.movements.get(member)),
            percent(effect_probability(d, member)),
        )
        for member in members
    ]
    head = ("effect", "value ± sd", "moves at most", "probability")
    return SummaryTable("What the amended study has beside the original", head, tuple(rows[:ROWS]), (0, 1))


def _missing(d: DiagnosisData) -> SummaryTable:
    """The stated sources of missing heat, if the verdict tells of some."""
    sources = d.missing.clear if tells_missing_heat(d) else ()
    rows = [
        (
            source_place(d, source),
            source_amount(source),
            _moves(source.move),
            course_words(source),
        )
        for source in sources
    ]
    head = ("missing heat (+) or missing cooling (-)", "amount ± sd", "moves at most", "course in time")
    about = "What is left, as heat of unknown origin (not in the amended study)"
    return SummaryTable(about if d.verdict == PARTLY else "Heat of unknown origin", head, tuple(rows[:ROWS]), (0, 3))


#: Verdicts that name every cause.
_NAMED = (IDENTIFIED, CONFOUNDED, NO_GAP)


def _rms(d: DiagnosisData) -> SummaryTable:
    rows = []
    for held_out, name in ((False, "fitted"), (True, "held out, used in no fit")):
        before, after = (d.rms(after=after, held_out=held_out) for after in (False, True))
        if math.isfinite(before):
            numbers = d.gap.held_out if held_out else d.gap.fitted
            names = clipped(", ".join(d.gap.runs[number].name for number in numbers), 60)
            rows.append((f"{name}: {names}", f"{before:.2f} K", f"{after:.2f} K", f"{d.noise:.2f} K"))
    head = ("runs", "rms, original", "rms, amended", "noise")
    return SummaryTable("Measured - computed", head, tuple(rows))


def _corrections(d: DiagnosisData) -> SummaryTable:
    shown = corrections(d)
    rows = [
        (
            correction_subject(each.pull.unknown),
            correction_amount(each.pull.unknown, each.pull.x, each.pull.sd),
            f"{each.pull.pull:+z.1f}",
            _moves(each.move),
        )
        for each in shown[:ROWS]
    ]
    more = f"; the {ROWS} that move most of {len(shown)}" if len(shown) > ROWS else ""
    head = ("number or sensor", "change ± sd", "in sd of what was stated", "moves at most")
    return SummaryTable(f"Corrections fitted together with it{more}", head, tuple(rows))


def _beside(d: DiagnosisData, most: int = 4) -> SummaryTable:
    """The partly identified effects beside each discrepancy model."""
    models = d.robustness.models[:most] if d.robustness else ()
    keys = [member.key for member in d.best.members]
    rows = [
        (
            model.words,
            percent(model.probability),
            "; ".join(f"{key} {percent(model.named.get(key, 0.0))}" for key in keys),
        )
        for model in models
    ]
    return SummaryTable(
        "If more is wrong than effects", ("the study with", "probability", "effects beside it"), tuple(rows), (0, 2)
    )


def _sets(d: DiagnosisData, most: int = 3) -> SummaryTable:
    rows: list[tuple[str, ...]] = []
    for row in set_rows(d, most):
        rms = row.get("held_out_rms_K") if d.gap.held_out else row.get("rms_K")
        known = rms is not None and math.isfinite(rms)
        rows.append(
            (" + ".join(row["effects"]) or "no effect", percent(row["probability"]), f"{rms:.2f} K" if known else "")
        )
    held = "held-out" if d.gap.held_out else "fitted"
    return SummaryTable("The most probable sets of effects", ("set", "probability", f"rms, {held} runs"), tuple(rows))


def _moves(move: Movement | None) -> str:
    if move is None or not math.isfinite(move.kelvin):
        return ""
    return f"{move.kelvin:+z.1f} K ({move.sensor}, {move.run})"


def _origin(d: DiagnosisData, version: str) -> str:
    tables = dict.fromkeys(Path(str(entry.table)).name for entry in d.original.measured)
    read = f", tables {', '.join(tables)}" if tables else ""
    return f"Diagnosis of study {d.original.name}{read}, by tyrefem {version}"


def _made(d: DiagnosisData) -> list[str]:
    """Runs, candidates, mesh, versions, and the best next experiment."""
    readings = sum(len(series.times) for run in d.gap.runs for series in run.sensors)
    sensors = len({series.sensor for run in d.gap.runs for series in run.sensors})
    mesh, choice = d.original.mesh().summary(), d.original.card.diagnosis
    lines = [
        f"{counted(readings, 'reading')} of {counted(sensors, 'sensor')} in {counted(len(d.gap.runs), 'run')}; "
        f"{counted(len(d.candidates), 'effect')} tried; "
        f"prior probability that any is missing {percent(choice.effects_expected)}; discrepancy of a right model "
        f"{choice.discrepancy:g} K over {choice.correlation_time:g} s; films uncertain by "
        f"{100 * choice.film_sd:.0f} %.",
        f"Mesh: {mesh['elements']} elements of {mesh['size_m'] * 1e3:.3g} mm. "
        + ", ".join(f"{name} {number}" for name, number in versions().items())
        + ".",
    ]
    following = next_words(d)
    first = [f"Next experiment: {following}"] if following else []
    if d.verdict not in _NAMED:
        first += [f"{sentence}." for sentence in law_words(d)[:1]]
    return [*first, *noise_words(d), *lines]
