"""Write docs/effects.md, its table of bounds and the picture of every effect's signature (run from the root).

`python tools/make_effects_page.py` writes all; with names of effects only their pictures, with `--text` none.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import tyrefem as tf
from tyrefem.effects import Effect, catalogue
from tyrefem.effects.description import by_family, equation, parameter_rows
from tyrefem.effects.signature import STUDY
from tyrefem.output import atomic_path

PAGE = Path("docs/effects.md")
BOUNDS = Path("docs/evidence/tables/effect-parameters.csv")
PICTURES = Path("docs/pictures")
DRAWING = {"mesh.size": "4 mm", "numerics.tolerance": "0.02 delta_degC", "output": {"every": "10 s", "fields": 2}}
INTRODUCTION = """\
# Effects

What a model of a rolling tyre may lack, one class per effect. A study takes an effect as an entry of `[[effects]]`;
a [diagnosis](diagnosis.md) fits them all.

```sh
tyrefem list effects
tyrefem show effect hot-road              # equation, source, parameters, an entry to copy
python tools/make_effects_page.py         # writes this page and its pictures from the classes
```

![What a road 10 K warmer changes in the readings](pictures/effect-hot-road.png)

```toml
[[effects]]
name = "hot-road"
warmer_by = "10 delta_degC"
from = "diagnosis of run-1.csv"          # optional: where the value comes from
sd = { warmer_by = "2 delta_degC" }      # optional: its standard deviation, within which a diagnosis fits it
```

Every quantity is (base + sum of addends) x product of factors; films take resistances in series last. Values beyond
the bounds, an effect twice, and effects without meaning in a study are refused.

Each parameter has an *sd*, its standard deviation before any data: the effect's typical size. Meanings and bounds: see
the [table](evidence/tables/effect-parameters.csv). A *shape* does nothing while the amplitude is 0. An "estimate" is a
judgement, not a measurement. Pictures show what one sd changes in the readings of `example-validation` (22x5.5 8PR,
2700 lbf, 83 psi, 20 mph for 600 s, then at rest; noise of a thermocouple 0.5 K).

Not on this page are CALIBRATION. A diagnosis
uses them for corrections and for heat of unknown origin; they state no cause. `tyrefem show effect NAME` explains each.

## An effect in some runs only

Road, sun, water and air change from one day to the next. `runs` names the measured runs in which an effect acts:

```toml
[[effects]]
name = "hot-road"
runs = ["run-2"]                         # default: every run
warmer_by = "25 delta_degC"
```

- `tyrefem compare` and `tyrefem diagnose` let it act in these runs alone. An entry for all runs may stand beside it:
  the two add up. Two entries of one effect in the same run are refused.
- A run has the name that its table gives, or else the name of the file without `.csv`. A name that the study's tables
  do not have is an error.
- `tyrefem run` follows no measured run: it leaves the effect out, and the report says so. With the run's name it acts:
  `tyrefem run STUDY --set run=run-2`. The same holds for sweeps, campaigns and real-time models.
- A diagnosis tries OF_THE_DAY also in each fitted run alone, as
  `hot-road in run-2`. An effect of your own takes part with `of_the_day: ClassVar[bool] = True`.

## An effect of your own

A Python file in a folder that `TYREFEM_PLUGINS` names (older name: `TYREFEM_EFFECTS`). `tyrefem new effect lamp`
writes this effect, `tyrefem check` tries it: [extending](extending.md).

```python
from typing import Annotated, ClassVar

from tyrefem.effects import Effect, Prior


class Lamp(Effect):
    \"\"\"Flux through the outer sidewall.\"\"\"

    name: ClassVar[str] = "lamp"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A lamp shines on the sidewall."
    source: ClassVar[str] = "estimate: a halogen lamp of 500 W at 1 m"
    surfaces: ClassVar[tuple[str, ...]] = ("outside_air",)

    shine: Annotated[float, Prior("W/m**2", "flux through the sidewall", 50.0, 0.0, 1e4)] = 0.0

    def flux(self, tyre, surface, x, t):
        return self.shine
```

A [diagnosis](diagnosis.md#its-law-over-the-runs) that finds heat of unknown origin writes such a file: a draft with
the law of the heat, its amplitude and standard deviation, and the source "inferred from ...".
`tyrefem diagnose --effects FOLDER` judges it as any other effect.

`Prior` takes unit, meaning, sd, lower and upper bound. A parameter without a value at which the effect is absent, such
as a place or a period, has a start of the fit, which is its default:
`Prior("s", "period", 50.0, 1.0, 1e4, start=60.0, amplitude=False)`. The method is one of the ports of
`tyrefem.effects.Effect`; `tyrefem/effects/tyre.py` lists what a port may ask of its `tyre`. The class's docstring is
the equation that commands and pages show. A choice (a sensor, a side) is a field with
`Field(description=..., examples=[...])`. `of_drive: ClassVar[bool] = True` says that films,
surroundings and rim depend on time through the drive alone: reduced models then evaluate the effect once per phase.
`of_place: ClassVar[bool] = True` says that `heat_factor` depends on the place alone: it is then evaluated once per set
of points. A port that jumps within a phase states when, in seconds of the drive:
`jumps: ClassVar[tuple[float, ...]] = (300.0,)`; a time that is a parameter by a property `jumps`, as
`tyrefem/effects/missing_flux.py` does.

## An effect with a state of its own

Wear, water on the tread, a warm brake disc: `states` gives unit and scale, `state_rates` the rates per second;
ports read a state with `tyre.state(self, name, t)`. Copy `tyrefem/effects/brake_disc.py` or
`tests/effects/drying_tread.py`.

- A state is a number, or an array with one value per place, as `initial_states` returns it (default 0).
- One error-controlled step of third order takes states and temperatures together; `scale` is the change of a state that
  matters as much as 1 K.
- `temperatures` gives `surface("road")`, `region("tread")`, `at(points)` and `reservoir("contained-air")` in degC.
- `result.states` holds every state over time; `summary.json` its start, end, least and largest value.
- A diagnosis simulates every point with such an effect; reduced and real-time models refuse it.
"""


def _shown(effect: type[Effect]) -> bool:
    """Effects that a diagnosis may name; corrections of base numbers are described in docs/method/diagnosis.md."""
    return effect.__module__.startswith("tyrefem.") and not effect.calibration


def page() -> str:
    """The text of docs/effects.md."""
    families = by_family({name: effect for name, effect in catalogue().items() if _shown(effect)})
    parts = [INTRODUCTION.replace("CALIBRATION", _names("calibration")).replace("OF_THE_DAY", _names("of_the_day"))]
    for family, members in families.items():
        parts += [f"## Family: {family}\n", *(_entry(effect) for effect in members)]
    return "\n".join(parts)


def _names(flag: str) -> str:
    """The shipped effects whose class says so, as a list in words."""
    shipped = {name: effect for name, effect in catalogue().items() if effect.__module__.startswith("tyrefem.")}
    *names, last = [f"`{name}`" for name, effect in shipped.items() if getattr(effect, flag)]
    return f"{', '.join(names)} and {last}"


def _entry(effect: type[Effect]) -> str:
    where = effect.signature.words
    return "\n".join(
        [
            f"### {effect.name}\n",
            f"{effect.sentence}\n",
            f"    {equation(effect)}\n",
            f"{_parameters(effect)}",
            f"{_source(effect)}." + (f" Drawn {where}." if where else "") + "\n",
            f"![Signature](pictures/effect-{effect.name}.png)\n",
        ]
    )


def _source(effect: type[Effect]) -> str:
    """The source; an estimate says so itself."""
    estimate = effect.source.startswith("estimate")
    return effect.source[0].upper() + effect.source[1:] if estimate else f"Source: {effect.source}"


def _parameters(effect: type[Effect]) -> str:
    """Every parameter with its prior sd, the choices after them."""
    priors = {parameter.name: parameter.prior for parameter in effect.parameters()}
    texts = [
        f"`{name}` ({'' if prior.amplitude else 'shape, '}sd {prior.text(prior.scale)})"
        for name, prior in priors.items()
    ]
    return ", ".join([*texts, *(f"`{row[0]}`" for row in parameter_rows(effect) if row[0] not in priors)]) + "."


def bounds() -> str:
    """The table of docs/evidence/tables/effect-parameters.csv: each number in the unit of its row."""
    rows = ["effect,parameter,meaning,kind,unit,starts at,least,largest,prior sd"]
    for effect in filter(_shown, catalogue().values()):
        for parameter in effect.parameters():
            prior = parameter.prior
            texts = [prior.text(value).partition(" ") for value in (prior.origin, prior.low, prior.high, prior.scale)]
            kind = "amplitude" if prior.amplitude else "shape"
            meaning = f'"{prior.meaning}"' if "," in prior.meaning else prior.meaning
            row = [effect.name, parameter.name, meaning, kind, texts[-1][2] or "1", *(number for number, _, _ in texts)]
            rows.append(",".join(row))
    return "\n".join(rows) + "\n"


def _study(effect: type[Effect]) -> tf.Study:
    return tf.study(STUDY).replace({**DRAWING, **effect.signature.changes})


def draw(effect: type[Effect], base: tf.Result) -> None:
    """The picture of one effect's signature."""
    from tyrefem.reports.figures.phases import draw_phases, make_room
    from tyrefem.reports.figures.style import FONT, QUIET, Label, add_axes, figure, line_ends, line_style, png, tidy

    study = _study(effect)
    choice = effect.signature.choice or effect.variants(study)[0]
    values = {one.name: one.prior.text(one.prior.usual, 12) for one in effect.parameters() if one.prior.amplitude}
    readings = study.replace({"effects": [{"name": effect.name, **choice, **values}]}).run().readings
    change, t = readings - base.readings, readings["time_s"].to_numpy() / 60
    drawn = figure(6.4, 2.5)
    axes = add_axes(drawn, 0.6, 0.42, 4.0, 1.95)
    labels = []
    for number, name in enumerate(column for column in change.columns if column != "time_s"):
        series = change[name].to_numpy()
        style = {"color": QUIET, "ls": "-"} if name in ("contained-air", "rim") else line_style(number)
        axes.plot(t, series, lw=1.3, **style)
        labels.append(Label(name, float(t[-1]), float(series[-1]), color=style["color"]))
    axes.set_ylabel("change [K]", fontsize=FONT)
    axes.set_xlabel("time [min]", fontsize=FONT)
    axes.set_xlim(0, t[-1])
    phases = [(phase.name, phase.start / 60, phase.end / 60) for phase in base.phases]
    make_room(axes, phases)
    draw_phases(axes, phases)
    tidy(axes)
    line_ends(axes, labels, room=1.7)
    PICTURES.mkdir(exist_ok=True)
    with atomic_path(PICTURES / f"effect-{effect.name}.png") as temporary:
        _few_colours(png(drawn)).save(temporary, format="PNG", optimize=True)


def _few_colours(data: bytes) -> Any:
    """The same picture with a palette: a quarter of the bytes."""
    import io

    from PIL import Image

    return (
        Image.open(io.BytesIO(data))
        .convert("RGB")
        .quantize(colors=96, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    )


def main() -> None:
    """Write the page, and the pictures unless only the text is asked for."""
    if "--text" not in sys.argv:
        bases: dict[str, tf.Result] = {}
        names = sys.argv[1:]
        for effect in filter(_shown, catalogue().values()):
            if names and effect.name not in names:
                continue
            changes = repr(effect.signature.changes)
            if changes not in bases:
                bases[changes] = _study(effect).run()
            draw(effect, bases[changes])
            print(effect.name, flush=True)
    BOUNDS.parent.mkdir(exist_ok=True)
    for file, text in ((PAGE, page()), (BOUNDS, bounds())):
        with atomic_path(file) as temporary:
            temporary.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
