"""The contents of `verdict.json`: a diagnosis as plain data for programs."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.discrepancy_record import (
    confidence,
    discrepancy_rows,
    effect_probability,
    member_confidence,
    possible_effects,
    support_row,
)
from tyrefem.diagnose.words.headline import headline, label
from tyrefem.diagnose.words.heat import is_told, source_place, source_words
from tyrefem.diagnose.words.law_record import law_record
from tyrefem.diagnose.words.looks import look_folder
from tyrefem.diagnose.words.result_tables import candidate_rows, clearest, parameters, set_rows
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import jsonable, versions

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.materiality import Movement
    from tyrefem.diagnose.heat.over_time import HeatOverTime
    from tyrefem.diagnose.heat.sources import UnknownSource
    from tyrefem.diagnose.unknowns.candidates import Candidate

#: File of the amended study, beside the record.
AMENDED = "amended.toml"


def record(d: DiagnosisData) -> dict[str, Any]:
    """The diagnosis as numbers in SI units and degC, with the unit in the key; NaN becomes null.

    ``headline``: what is wrong, how sure, what to do next. ``summary``: the verdict in more sentences.
    ``runs`` of an effect: the runs in which it acts, null for all.
    ``effects``: members of the most probable set if the verdict is "identified" or "confounded", the effects that act
    whatever else is wrong if it is "partly identified", else empty.
    """
    named = d.best.members if d.verdict in (IDENTIFIED, CONFOUNDED, PARTLY) else ()
    contents = {
        "verdict": d.verdict,
        "label": label(d),
        "headline": list(headline(d)),
        "summary": list(verdict_words(d)),
        "reasons": list(d.judgement.reasons),
        "effects": [
            {
                "name": member.name,
                "variant": dict(member.choice),
                "runs": list(member.runs) or None,
                "probability": effect_probability(d, member),
                "confidence": member_confidence(d, member),
                "parameters": parameters(member.unknowns, d.best),
                "moves": _moves(d, member),
                "support": support_row(d, member),
                "source": member.effect.source,
            }
            for member in named
        ],
        "candidates": candidate_rows(d),
        "notes": list(d.notes),
        "sets": set_rows(d),
        "gap": {
            "before": _rms(d, after=False),
            "after": _rms(d, after=True),
            "noise_K": d.noise,
        },
        "noise": noise(d),
        "confidence": confidence(d),
        "discrepancies": discrepancy_rows(d),
        "possible_effects": possible_effects(d),
        "strain_laws": [trial.to_dict() for trial in d.law_trials],
        "better_strain_law": None if d.better_law is None else d.better_law.to_dict(),
        "conformal": None if d.conformal is None else d.conformal.to_dict(d.judgement.ranking),
        "prior_sensitivity": [asdict(change) for change in d.prior_sensitivity],
        "where": where(d),
        "next_experiment": dict(d.next_experiment),
        "amended_study": AMENDED,
        "changes": change_rows(d),
        "missing_heat": missing_heat(d) if d.verdict in (UNEXPLAINED, PARTLY) else None,
        "again": [_look(look, number) for number, look in enumerate(d.looks[1:], start=2)],
        "study": d.original.name,
        "title": d.original.title,
        "runs": _runs(d),
        "numerics": {
            "tolerance_K": d.original.tolerance,
            "mesh": d.original.mesh().summary() | {"element": d.original.card.mesh.element},
            "assumed": d.original.card.diagnosis.model_dump(),
        },
        "reduced": dict(d.predictions),
        "wall_time_s": d.seconds,
        "versions": versions(),
        **plugin_summary(d.original, [candidate.name for candidate in d.candidates]),
        "random_seed": None,
        "input": dict(d.original.data),
    }  # fmt: skip
    plain: dict[str, Any] = jsonable(contents)
    return plain


def _moves(d: DiagnosisData, member: Candidate) -> dict[str, Any] | None:
    """The largest change of a reading by an effect, with sign, its sensor and run; null if it was not computed."""
    return _movement(d.movements.get(member))


def _movement(move: Movement | None) -> dict[str, Any] | None:
    return None if move is None else {"largest_K": move.kelvin, "sensor": move.sensor, "run": move.run}


def noise(d: DiagnosisData) -> dict[str, Any]:
    """Noise of a reading, rms over all readings: stated, by the readings' scatter, and as used; then by run and sensor.

    ``resolution_K``: step of rounded readings, 0 if they are not rounded.
    """
    return {
        "stated_K": d.stated_noise,
        "from_data_K": d.noise_of_data,
        "used_K": d.noise,
        "correlated": d.correlated_noise,
        "series": [
            {
                "run": run.name,
                "sensor": readings.sensor,
                "stated_K": readings.origin.stated,
                "from_data_K": readings.origin.from_data,
                "used_K": readings.origin.used,
                "resolution_K": readings.origin.resolution,
            }
            for run in d.gap.runs
            for readings in run.sensors
            if readings.origin is not None
        ],
    }


def where(d: DiagnosisData) -> dict[str, Any]:
    """The most significant residual of the original study among those larger than noise."""
    row = clearest(d)
    return {
        "sensor": row["sensor"],
        "region": region_of(d, str(row["sensor"])),
        "phase": row["phase"],
        "run": row["run"],
        "hold_out": bool(row["hold_out"]),
        "speed_m_s": float(row["speed_m_s"]),
        "mean_K": float(row["mean_K"]),
        "rms_K": float(row["rms_K"]),
        "sigma": float(row["sigma"]),
    }


def region_of(d: DiagnosisData, sensor: str) -> str:
    """The region of a sensor; the sensor's name if it is not in the rubber."""
    card = d.original.sensors.get(sensor)
    if card is None:
        return sensor
    section = d.original.new_section
    s, depth = section.locate([d.original.section_place(card)])
    return str(section.region_at(s, depth)[0])


def change_rows(d: DiagnosisData) -> list[dict[str, Any]]:
    """The changes of the amended study: SI value of a parameter or factor of a base number, with standard deviation."""
    return [
        {
            "key": change.unknown.key,
            "keys": list(change.unknown.keys),
            "effect": change.unknown.effect,
            "variant": dict(change.unknown.choice),
            "runs": list(change.unknown.runs) or None,
            "missing": change.missing,
            "original": change.unknown.value(0.0),
            "value": change.unknown.value(change.x),
            "sd": change.sd * (change.unknown.value(change.x) if change.unknown.parameter is None else 1.0),
            "unit": change.unknown.unit,
            "pull": change.x / change.unknown.sd,
            "source": change.source,
        }
        for change in d.changes
    ]


def missing_heat(d: DiagnosisData) -> dict[str, Any]:
    """Heat of unknown origin by station: W/m3 inside while the tyre rolls, W/m2 through the outer surface.

    ``sources``: what the data tell of each place, sign, amount and course in time; see `source_row`.
    ``law``: how the largest of them scales over the runs; see `law_record`.
    """
    heat = d.missing
    over_time = heat.over_time
    return {
        "sources": [] if over_time is None else [source_row(d, source, over_time) for source in over_time.sources],
        "law": law_record(d),
        "cooling_run": None if over_time is None else over_time.cools,
        "kind": heat.kind,
        "region": heat.region,
        "station_m": heat.station,
        "stations_m": heat.stations,
        "watts": heat.watts,
        "runs": [
            {
                "run": run,
                "speed_m_s": float(heat.speeds[number]),
                "heat_W_m3": heat.heat[number],
                "heat_sd_W_m3": heat.heat_sd[number],
                "flux_W_m2": heat.flux[number],
                "flux_sd_W_m2": heat.flux_sd[number],
            }
            for number, run in enumerate(heat.runs)
        ],
    }


def source_row(d: DiagnosisData, source: UnknownSource, over_time: HeatOverTime) -> dict[str, Any]:
    """A source of missing heat (positive) or of too much heat (negative): W/m3 inside, W/m2 through a surface.

    ``stated``: the amount differs from zero by more than two standard deviations. ``amount_at``: run and time of the
    amount, where a free course is clear then, but not its mean. ``depth``: probability of each layer
    and surface at the station. ``course_probabilities``: of each course in time. ``runs``: the amount over time.
    """
    unit = "W_m3" if source.inside else "W_m2"
    return {
        "sentence": source_words(d, source, over_time),
        "stated": source.clear,
        "sign": "heat is missing" if source.amount > 0 else "cooling is missing",
        "station_m": source.station,
        "place": source_place(d, source),
        "where": source.where,
        "inside_told_from_surface": is_told(source),
        "kind": "heat" if source.inside else "flux",
        f"amount_{unit}": source.amount,
        f"amount_sd_{unit}": source.sd,
        "amount_at": None if source.at is None else dict(zip(("run", "time_s"), source.at, strict=True)),
        "moves": _movement(source.move),
        "station_probabilities": [{"station_m": s, "probability": share} for s, share in source.stations.items()],
        "depth": dict(source.depths),
        "course": source.kind,
        "course_probabilities": dict(source.kinds),
        "time_s": source.time,
        "time_sd_s": source.time_sd,
        "log_evidence_gain": source.gain,
        "runs": [
            {"run": run, "times_s": knots, f"amount_{unit}": strength, f"amount_sd_{unit}": sd}
            for run, knots, strength, sd in zip(
                over_time.runs, over_time.knots, source.strength, source.strength_sd, strict=True
            )
        ],
    }


def _look(d: DiagnosisData, number: int) -> dict[str, Any]:
    """A further look at the same data in short; ``folder``: its full results, null if the verdict is "no gap"."""
    return {
        "verdict": d.verdict,
        "effects": [member.key for member in d.best.members] if d.verdict in (IDENTIFIED, CONFOUNDED, PARTLY) else [],
        "reasons": list(d.judgement.reasons),
        "folder": None if d.verdict == NO_GAP else look_folder(number),
    }


def _rms(d: DiagnosisData, *, after: bool) -> dict[str, float]:
    return {"rms_K": d.rms(after=after, held_out=False), "held_out_rms_K": d.rms(after=after, held_out=True)}


def _runs(d: DiagnosisData) -> list[dict[str, Any]]:
    return [
        {
            "run": run.name,
            "hold_out": run.hold_out,
            "drive": run.drive,
            "readings": sum(len(readings.times) for readings in run.sensors),
            "end_s": max(float(readings.times[-1]) for readings in run.sensors),
            "noise_K": {readings.sensor: readings.noise for readings in run.sensors},
        }
        for run in d.gap.runs
    ]
