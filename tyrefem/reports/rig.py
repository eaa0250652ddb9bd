"""Files of a rig's simulation, identification (with one HTML page) and layer study: tables, then pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.heating_test.layer_cards import bases, layer_cards
from tyrefem.heating_test.selection import COVERAGE
from tyrefem.heating_test.summary import diffusivities, ranked, summary
from tyrefem.heating_test.verdict import name_in_words, sentences
from tyrefem.interruption import keeping
from tyrefem.output import atomic_folder, jsonable, versions
from tyrefem.plugins.named import named_plugins, rows_of_plugins
from tyrefem.reports.figures.style import png
from tyrefem.reports.rig_figures import heated_patch, histories, layers_figure, pictures, references
from tyrefem.reports.template import embedded, rendered
from tyrefem.reports.words import number

if TYPE_CHECKING:
    from tyrefem.heating_test.card import RigCard
    from tyrefem.heating_test.identification import IdentificationData
    from tyrefem.heating_test.layer_study import LayerStudy
    from tyrefem.heating_test.simulation import Simulation


def page(identification: IdentificationData, pictures: Mapping[str, bytes], cards: Mapping[str, Any]) -> str:
    """The page's HTML; ``pictures`` maps file name -> PNG, ``cards`` layer -> material card data."""
    return rendered(
        "rig.html",
        identification=identification,
        sentences=sentences(identification),
        coverage=COVERAGE,
        references=references(identification.card),
        name_in_words=name_in_words,
        number=number,
        pictures=embedded(pictures),
        cards=cards,
        diffusivities=diffusivities(identification),
        ranked=[
            (", ".join(map(name_in_words, key)) or "all constant", value) for key, value in ranked(identification, 6)
        ],
        complaint=any(estimate.verdict != "determined" for estimate in identification.properties),
    )


#: Files that `save` may write.
FILES = ("report.html", "rig.json", "estimates.csv", "residuals.csv", "residuals-*.png", "intervals.png",
         "correlation.png", "histories*.png", "materials/*.toml")  # fmt: skip


#: Files that `save_layers` writes.
LAYER_FILES = ("layers.csv", "layers.png")


def save(identification: IdentificationData, folder: str | Path, base: str | Sequence[str] | None = None) -> Path:
    """Write the files of an identification: ``report.html``, ``rig.json``, ``summary.json``, CSV, PNG, material cards.

    ``base``: card, or ``LAYER=CARD`` entries, with data that the rig cannot measure; without it no card is written.
    """
    import tomli_w

    folder = Path(folder)
    given = [base] if isinstance(base, str) else list(base or [])
    cards = layer_cards(identification, bases(identification.card, given))
    data = summary(identification)
    data["materials"] = {layer: f"materials/{layer}.toml" for layer in cards}
    with atomic_folder(folder) as place:
        put_json(place / "rig.json", data)
        short = (
            "rig",
            "file",
            "determined",
            "not_determined",
            "poorly_determined",
            "doubtful",
            "words",
            "estimates",
            "materials",
            "versions",
            "plugins",
        )
        put_json(place / "summary.json", {key: data[key] for key in short} | {"random_seed": None})
        identification.table.to_csv(place / "estimates.csv", index=False)
        _residuals(identification).to_csv(place / "residuals.csv", index=False)
        if cards:
            (place / "materials").mkdir()
        for layer, card in cards.items():
            (place / "materials" / f"{layer}.toml").write_text(tomli_w.dumps(card), encoding="utf-8")
    with keeping(f"{folder} has the tables and cards, but not the page"), atomic_folder(folder) as place:
        drawn = pictures(identification)
        for name, content in drawn.items():
            (place / name).write_bytes(content)
        (place / "report.html").write_text(page(identification, drawn, cards), encoding="utf-8")
    return folder


def _residuals(identification: IdentificationData) -> Any:
    import pandas as pd

    parts = [
        pd.DataFrame(
            {
                "run": block.series.test,
                "sensor": block.series.sensor,
                "time_s": block.series.times,
                "measured_degC": block.series.readings,
                "computed_degC": block.computed,
                "residual_K": block.residual,
                "readings": block.series.counts,
            }
        )
        for block in identification.fit.blocks
    ]
    return pd.concat(parts, ignore_index=True)


def simulation_files(card: RigCard) -> list[str]:
    """The files that `write_simulation` writes: a table per run, pictures."""
    return [*(f"{escape(name)}.csv" for name in card.runs), "readings.png", "patch.png"]


def write_simulation(done: Simulation, folder: Path) -> Path:
    """Write simulated tables (``RUN.csv``, which `identify` reads), ``summary.json`` and pictures."""
    sensors = list(done.card.sensors)
    runs = {name: (run.times, run.temperatures.to_numpy()) for name, run in done.runs.items()}
    powers = {name: run.power for name, run in done.card.runs.items()}
    on = done.clock.heating.size - 1
    strongest = max(powers, key=lambda name: powers[name])
    borders = [done.values[f"{layer.name}.thickness"] for layer in done.card.layers]
    layers = " | ".join(layer.name for layer in done.card.layers)
    words = f"{powers[strongest]:g} W, laser from above; layers: {layers}"
    record = {
        "rig": done.card.title,
        "file": done.file,
        "values": dict(done.values),
        "runs": {
            name: {
                "power_W": powers[name],
                "hottest_degC": float(done.fields[name].max()),
                "end_of_heating_degC": dict(zip(sensors, _at_switch(done, name), strict=True)),
            }
            for name in done.runs
        },
        "words": list(done.words),
        "versions": versions(),
        "plugins": rows_of_plugins(named_plugins(done.card.model_dump())),
        "random_seed": done.seed,
    }
    with atomic_folder(folder) as place:
        for name, run in done.runs.items():
            run.write(place / f"{name}.csv")
        put_json(place / "summary.json", record)
    with keeping(f"{folder} has the tables, but not the pictures"), atomic_folder(folder) as place:
        patch = heated_patch(done.twin.grid(done.values), done.fields[strongest][on], borders, words)
        (place / "readings.png").write_bytes(png(histories(done.card.phases, runs, sensors, powers)))
        (place / "patch.png").write_bytes(png(patch))
    return folder


def _at_switch(done: Simulation, name: str) -> list[float]:
    seen = done.twin.readings_of_fields(done.values, done.clock, done.fields[name])
    return [float(value) for value in seen[done.clock.heating.size - 1]]


def save_layers(done: LayerStudy, folder: Path, *, seed: int | None = None) -> Path:
    """Write ``layers.csv``, ``layers.png`` and ``summary.json``; ``seed``: of simulated readings."""
    save_layer_table(done, folder, seed=seed)
    with keeping(f"{folder} has the table, but not its picture"), atomic_folder(folder) as place:
        (place / "layers.png").write_bytes(png(layers_figure(done)))
    return folder


def save_layer_table(done: LayerStudy, folder: Path, *, complete: bool = True, seed: int | None = None) -> Path:
    """Write ``layers.csv`` and ``summary.json``; ``complete``: the table has all fits. ``seed``: of simulated readings;
    None: measured ones."""
    table = done.table()
    with atomic_folder(folder) as place:
        table.to_csv(place / "layers.csv", index=False)
        used = {plugin for fit in done.fits for plugin in named_plugins(fit.card.model_dump())}
        rows = {
            "complete": complete, "rows": table.to_dict("records"), "versions": versions(),
            "plugins": rows_of_plugins(used), "random_seed": seed,
        }  # fmt: skip
        put_json(place / "summary.json", rows)
    return folder


def put_json(path: Path, data: dict[str, Any]) -> None:
    """Write JSON into a temporary folder, which is later moved as a whole."""
    path.write_text(json.dumps(jsonable(data), indent=1) + "\n", encoding="utf-8")
