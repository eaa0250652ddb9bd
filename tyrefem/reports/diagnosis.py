"""Files of a diagnosis: record, amended study, tables, pictures, and one self-contained page, verdict first."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tyrefem
from tyrefem.diagnose.amend import Change, difference
from tyrefem.diagnose.forward.worker_queues import Workers, begun
from tyrefem.diagnose.numbers import amount, base_name, correction_amount, parameter_name, percent, run_words
from tyrefem.diagnose.unknowns.candidates import key_of
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.prior_sensitivity import prior_words
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.corrections import corrections
from tyrefem.diagnose.words.discrepancy_record import effect_probability
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.effects import effect_amounts, effect_sentence
from tyrefem.diagnose.words.headline import QUESTIONS, headline, label
from tyrefem.diagnose.words.looks import AGAIN
from tyrefem.diagnose.words.next_steps import next_words
from tyrefem.diagnose.words.record import AMENDED, record, where
from tyrefem.diagnose.words.result_tables import candidate_rows, finite, history_table, set_rows, where_table
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.diagnose.words.set_posteriors import POSTERIOR, posterior_record
from tyrefem.inputs.changes import value_at
from tyrefem.inputs.uncertain_numbers import left_out
from tyrefem.mechanics.nearby_cycles import NearbyCycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.output import atomic_folder, write_json
from tyrefem.reports.diagnosis_figures import pictures
from tyrefem.reports.diagnosis_histories import RunHistory, history_pictures
from tyrefem.reports.diagnosis_law import law_block
from tyrefem.reports.diagnosis_missing import tells_missing_heat
from tyrefem.reports.diagnosis_summary import SUMMARY, summary
from tyrefem.reports.template import embedded, rendered
from tyrefem.reports.words import number, shortened

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

PAGE = "diagnosis.html"
_FILES = ("verdict.json", POSTERIOR, AMENDED, "difference.txt", "where.csv", "histories.csv", PAGE, "rms.png",
          "residual-map*.png", "probabilities.png", "histories-*.png", "missing-heat*.png", "gap.png", SUMMARY,
          "energy-share.png", f"{EFFECTS}/inferred_*.py")  # fmt: skip
#: Largest number of looks at the same data.
MOST_LOOKS = 9
#: Files that `save` may write.
FILES = tuple(f"{AGAIN}/" * look + name for look in range(MOST_LOOKS) for name in _FILES)
#: Number of rows shown; the rest can be unfolded.
SHOWN = 12
#: Smallest gain that gets a row, ln of odds.
TELLS = 0.1


def save(d: DiagnosisData, folder: str | Path, workers: Workers = 1) -> Path:
    """Write all files of a diagnosis into a folder, each completely or not at all; return the page's path.

    ``verdict.json``, ``posterior.json``, ``amended.toml``, ``difference.txt``, ``where.csv``, ``histories.csv``, the
    pictures, ``diagnosis.html``, its `summary` on one page, and the draft effect in ``effects``, if a law of missing
    heat holds. A further look at the data has a folder ``again``, unless there is no gap left.

    workers : processes; the first draws the histories, if they are started.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    folder = Path(folder)
    histories = begun(workers, history_pictures, [RunHistory.of(d, number) for number in range(len(d.gap.runs))])
    with atomic_folder(folder) as temporary:
        write_json(record(d), temporary / "verdict.json")
        write_json(posterior_record(d), temporary / POSTERIOR)
        d.study.save(temporary / AMENDED)
        lines = difference(d.original, d.study)
        (temporary / "difference.txt").write_text("\n".join([*lines, ""]) if lines else "", encoding="utf-8")
        where_table(d).to_csv(temporary / "where.csv", index=False, lineterminator="\n")
        history_table(d).to_csv(temporary / "histories.csv", index=False, lineterminator="\n")
        (temporary / SUMMARY).write_text(summary(d, version=tyrefem.__version__), encoding="utf-8")
        for name, text in draft_effects(d).items():
            (temporary / EFFECTS).mkdir(exist_ok=True)
            (temporary / EFFECTS / name).write_text(text, encoding="utf-8")
        drawn = pictures(d) | histories()
        for name, picture in drawn.items():
            (temporary / name).write_bytes(picture)
        (temporary / PAGE).write_text(page(d, drawn, version=tyrefem.__version__), encoding="utf-8")
    if d.again is not None and d.again.verdict != NO_GAP:
        save(d.again, folder / AGAIN, workers)
    return folder / PAGE


def page(d: DiagnosisData, images: Mapping[str, bytes], *, version: str) -> str:
    """The page's HTML; ``images``: file name -> PNG."""
    place = where(d)
    return rendered(
        "diagnosis.html",
        d=d,
        version=version,
        label=label(d),
        headline=list(zip(QUESTIONS, headline(d), strict=True)),
        sentences=verdict_words(d),
        place=place,
        numbers=_numbers(d),
        named=_named(d),
        candidates=[_candidate(row) for row in candidate_rows(d)],
        sets=[_set(row) for row in set_rows(d)],
        where=_where(d),
        corrections=_corrections(d),
        difference=difference(d.original, d.study),
        reasons=[shortened(reason) for reason in d.judgement.reasons],
        further=next_words(d),
        offered_sensors=_offers(d, "sensors", "place", "run"),
        offered_drives=_offers(d, "drives", "drive", "sensor"),
        assumed=_assumed(d),
        pictures=embedded(images),
        shown=SHOWN,
        law=law_block(d),
        unexplained=d.verdict == UNEXPLAINED and tells_missing_heat(d),
        partly=d.verdict == PARTLY,
        missing=tells_missing_heat(d),
        place_run=run_words(place["run"]),
        negligible=f"{d.gap.settings.negligible:g}",
        discrepancies=_discrepancies(d),
        laws=_laws(d),
        confounded=d.verdict == CONFOUNDED,
    )


def _numbers(d: DiagnosisData) -> list[dict[str, str]]:
    """Root mean square deviations of fitted and held-out runs, original and amended."""
    numbers, reached = [], math.inf
    for held_out, name in ((False, "fitted runs"), (True, "held-out runs")):
        before, after = (d.rms(after=after, held_out=held_out) for after in (False, True))
        if math.isfinite(before):
            reached = min(reached, before, after)
            value = f"{before:.2f} → {after:.2f} K"
            numbers.append({"label": f"rms on {name}", "value": value, "note": "original → amended"})
    # Readings may scatter less than their sensors state.
    note = "smallest rms that a model can reach" if reached >= d.noise else "as their sensors state it"
    if abs(d.noise - d.stated_noise) > 0.01 * d.stated_noise:
        note = f"by the readings' scatter; stated: {d.stated_noise:.2f} K"
    return [*numbers, {"label": "noise of the readings", "value": f"{d.noise:.2f} K", "note": note}]


def _named(d: DiagnosisData) -> list[dict[str, Any]]:
    """Text on the effects that the amended study adds to the original."""
    if d.verdict not in (IDENTIFIED, CONFOUNDED, PARTLY, UNEXPLAINED):
        return []
    return [
        {
            "key": member.key,
            "probability": percent(effect_probability(d, member)),
            "sentence": effect_sentence(member, d.best),
            "source": member.effect.source,
            "amounts": [
                *effect_amounts(member, d.best),
                *([d.movements[member].words] if member in d.movements else []),
            ],
        }
        for member in d.best.members
    ]


def _discrepancies(d: DiagnosisData) -> list[dict[str, str]]:
    """The leading effects beside every discrepancy model."""
    return [
        {
            "words": model.words,
            "probability": "" if math.isnan(model.probability) else percent(model.probability),
            "effects": "; ".join(
                f"{key} {percent(share)}" for key, share in list(model.named.items())[:4] if share > 0.05
            )
            or "none",
        }
        for model in (d.robustness.models if d.robustness else ())
    ]


def _laws(d: DiagnosisData) -> list[dict[str, str]]:
    """Other strain laws with the tyre's heat as in the study, before anything is fitted."""
    return [
        {
            "law": trial.law,
            "factor": f"{math.exp(trial.level):.2f}",
            "rms": f"{trial.rms:.1f} K",
            "held_out": "" if math.isnan(trial.held_out_rms) else f"{trial.held_out_rms:.1f} K",
            "gain": f"{trial.gain:+z,.0f}",
        }
        for trial in d.law_trials
    ]


def _candidate(row: Mapping[str, Any]) -> dict[str, str]:
    return {
        "name": key_of(row["name"], row["variant"], row["runs"]),
        "probability": percent(row["probability"]),
        "gain": f"{row['log_evidence_gain']:+z,.{1 if abs(row['log_evidence_gain']) < 1000 else 0}f}",
        "parameters": "; ".join(
            amount(entry["value"], entry["sd"], entry["unit"]) for entry in row["parameters"].values()
        ),
        "confounded": shortened("; ".join(row["confounded_with"])),
        **_fitness(row),
    }


def _set(row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "name": " + ".join(row["effects"]) or "no effect",
        "probability": percent(row["probability"]),
        "below": f"{-row['log_score_below_best']:z.1f}" if math.isfinite(row["log_score_below_best"]) else "–",
        "credible": row["credible"],
        **_fitness(row),
    }


def _fitness(row: Mapping[str, Any]) -> dict[str, str]:
    """Misfits of a set, empty if the full model was not fitted."""
    shown = {"at_bound": "at a bound" if row.get("at_bound") else ""}
    for keys, form in ((("rms_K", "held_out_rms_K"), ".2f"), (("p_value", "held_out_p"), ".2g")):
        for key in keys:
            value = finite(row, key)
            shown[key] = "" if value is None else format(value, form)
    return shown


def _where(d: DiagnosisData) -> list[dict[Any, Any]]:
    return where_table(d).to_dict(orient="records")


def _corrections(d: DiagnosisData) -> list[dict[str, str]]:
    """Base numbers and sensors that the amended study corrects: original -> amended, with standard deviation.

    Each with its size in standard deviations of what was stated, and the largest change of a reading by it.
    """
    moves = {each.pull.unknown: each for each in corrections(d)}
    rows = []
    for change in (change for change in d.changes if not change.missing):
        each = moves[change.unknown]
        size = f"{each.move.kelvin:+z.1f} K ({each.move.sensor}, {each.move.run})"
        rows.append(_correction(d, change) | {"pull": f"{each.pull.pull:+z.1f}", "moves": size})
    return rows


def _correction(d: DiagnosisData, change: Change) -> dict[str, str]:
    unknown = change.unknown
    if unknown.effect is None:
        new = value_at(d.study.data, unknown.key, d.study.folder)
        kelvins = unknown.kelvins
        prior = f"{number(kelvins * unknown.sd, 2)} K" if kelvins else f"{number(100 * unknown.sd, 2)} %"
        return {
            "what": base_name(unknown),
            "original": str(value_at(d.original.data, unknown.key, d.original.folder)),
            "amended": str(new),
            "change": correction_amount(unknown, change.x, change.sd),
            "prior": f"± {prior}",
        }
    if unknown.effect == "film-scale":
        film = dict(unknown.choice)["film"].replace("_", " ")
        # The parameter is ln of a factor; the page shows the factor.
        return {
            "what": f"film coefficient, {film}",
            "original": "from its law",
            "amended": f"times {math.exp(change.x):.3g}",
            "change": correction_amount(unknown, change.x, change.sd),
            "prior": f"± {number(100 * unknown.sd, 2)} %",
        }
    return {
        "what": f"{', '.join([*dict(unknown.choice).values(), *unknown.runs])}: {parameter_name(unknown)}",
        "original": "as stated",
        "amended": "",
        "change": amount(unknown.value(change.x), change.sd, unknown.unit),
        "prior": _prior(unknown),
    }


def _prior(unknown: Unknown) -> str:
    return "± " + amount(0.0, unknown.sd, unknown.unit).split("± ")[1]


def _offers(d: DiagnosisData, kind: str, what: str, at: str) -> list[dict[str, Any]]:
    """Sensors or drives that would change the probabilities, with their gain."""
    offers = []
    for offer in d.next_experiment.get(kind, ()):
        changes = ", ".join(f"{key} = {value}" for key, value in offer.get("changes", {}).items())
        name = f"{offer[what]} ({changes})" if changes else offer[what]
        offers.append({"what": name, "gain": offer["gain"], "largest_K": offer["largest_K"], "at": offer[at]})
    return [offer for offer in offers if offer["gain"] > TELLS]


def _linear(d: DiagnosisData) -> list[str]:
    """Assumption of the fits on strain cycles by finite elements."""
    if not strain_law(d.original).by_elements:
        return []
    count = len(NearbyCycles(d.original).numbers)
    return [
        f"In the fits, strain cycles by finite elements are linear in {count} numbers, with one solution for each at "
        "every load. Original and amended study are solved without this approximation."
    ]


def _priors(d: DiagnosisData) -> list[str]:
    """What follows if the prior of a leading effect is three times as large, or a third."""
    tried = list(dict.fromkeys(change.effect for change in d.prior_sensitivity))
    first = (
        f"Priors (probability and usual size) of {', '.join(tried)}, each three times as large and a third: "
        f"{sum(change.decides for change in d.prior_sensitivity)} of {len(d.prior_sensitivity)} change the verdict or "
        "its names."
    )
    return [first, *prior_words(d.prior_sensitivity, d.verdict, d.named_effects)]


def _assumed(d: DiagnosisData) -> list[str]:
    choice = d.original.card.diagnosis
    return [
        f"Prior probability that an effect is missing: {percent(choice.effects_expected)}, shared by "
        f"{len({candidate.name for candidate in d.candidates})} effects ({len(d.candidates)} with their variants) "
        "and their sets.",
        f"Relative standard deviation of film coefficients: {100 * choice.film_sd:.0f} %. That of base numbers is in "
        "the cards and the study's [uncertainty] table; that of a sensor's place, lag and offset is in its entry.",
        *(f"Base numbers {line}." for line in left_out(d.original.uncertain_numbers)),
        *_linear(d),
        f"A correct model deviates by {choice.discrepancy:g} K (standard deviation), correlated over "
        f"{choice.correlation_time:g} s. The noise of readings is independent.",
        *_priors(d),
        *([f"Excluded by the study: {', '.join(choice.exclude)}."] if choice.exclude else []),
        *(f"{note[0].upper()}{note[1:]}." for note in d.notes),
        "The model is linear within the uncertainty of every fit (Laplace approximation). Parameters have Gaussian "
        "priors, truncated at physical bounds.",
    ]
