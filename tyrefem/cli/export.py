"""`tyrefem export`: write a certified real-time model of a study as one file, optionally as an FMU too."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tyrefem.cli.common import (
    CaseOption,
    ForceOption,
    SetOption,
    StudyArgument,
    settings,
    warn,
)
from tyrefem.cli.progress import stages
from tyrefem.cli.shell import answer_with, notify, say
from tyrefem.errors import InputError
from tyrefem.output.file import results_file
from tyrefem.threads import usable_cores

if TYPE_CHECKING:
    from tyrefem.realtime.certificate import RealTimeCertificate


def _range(text: str | None, name: str) -> dict[str, tuple[str, str]]:
    """Parse the range of an input.

    >>> _range("0 mph:30 mph", "speed"), _range("83 psi", "pressure"), _range(None, "load")
    ({'speed': ('0 mph', '30 mph')}, {'pressure': ('83 psi', '83 psi')}, {})
    """
    if text is None:
        return {}
    ends = [part.strip() for part in text.split(":")]
    if len(ends) > 2 or not all(ends):
        raise InputError(f"'{text}' is not FROM:TO, e.g. '10 mph:40 mph'", field=f"--{name.replace('_', '-')}")
    return {name: (ends[0], ends[-1])}


def export(
    study: StudyArgument,
    out: Annotated[Path | None, typer.Option("--out", help="File; default: results/STUDY.npz.")] = None,
    speed: Annotated[
        str | None, typer.Option(metavar="FROM:TO", help="Range of the speed; default: 0 to 1.5 times the study's.")
    ] = None,
    load: Annotated[
        str | None, typer.Option(metavar="FROM:TO", help="Range of the load; default: 0.5 to 1.25 times the study's.")
    ] = None,
    pressure: Annotated[
        str | None,
        typer.Option(
            metavar="FROM:TO", help="Range of the cold gauge pressure; default: 0.8 to 1.2 times the study's."
        ),
    ] = None,
    ambient: Annotated[
        str | None,
        typer.Option(
            metavar="FROM:TO", help="Range of the ambient temperature; default: 20 K below to 20 K above the study's."
        ),
    ] = None,
    road_temperature: Annotated[
        str | None,
        typer.Option(
            metavar="FROM:TO", help="Range of the road temperature; default: 20 K below to 40 K above the study's."
        ),
    ] = None,
    tolerance: Annotated[str, typer.Option(help="Largest temperature error that the certificate allows.")] = "0.2 K",
    duration: Annotated[
        str | None, typer.Option(help="Duration of the drives for training and certification; default: the study's.")
    ] = None,
    changes: SetOption = None,
    case: CaseOption = None,
    fmu: Annotated[bool, typer.Option("--fmu", help="Write an FMU (FMI 2.0, co-simulation) beside the file.")] = False,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; default: one per core.")] = None,
    force: ForceOption = False,
) -> None:
    """Export a real-time model: inputs speed, load, pressure, ambient, road; outputs sensors, contained air.

    Full runs of the study in the ranges train it; fresh full runs certify it. Its time steps run in
    tyrefem/realtime/tyre.py
    and need only numpy.
    """
    from tyrefem.api import study as loaded
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.realtime.certificate import NEEDS
    from tyrefem.realtime.certificate import export as write
    from tyrefem.variants.schedulers import Here, Local

    given: dict[str, tuple[str, str]] = {}
    inputs = {"speed": speed, "load": load, "pressure": pressure, "ambient": ambient}
    for name, text in {**inputs, "road_temperature": road_temperature}.items():
        given |= _range(text, name)
    chosen = loaded(study, settings(changes), case)
    NEEDS.check(chosen)
    warn(chosen.warnings)
    path = out or Path("results") / f"{chosen.name}.npz"
    allowed = _read("--tolerance", tolerance, "delta_degC")
    if not allowed > 0:
        raise InputError(f"must be positive, not {tolerance}", field="--tolerance")
    lasting = None if duration is None else _read("--duration", duration, "s")
    if lasting is not None and not lasting >= 1:
        raise InputError(f"must be a second or more, not {duration}", field="--duration")
    count = workers or usable_cores()
    files = {"file": path} | ({"fmu": path.with_suffix(".fmu")} if fmu else {})
    origin = StudyOrigin.beside(chosen, path)
    with results_file(path, (".npz",), also=files.values(), origin=origin, force=force):
        try:
            with stages() as tick:
                certificate = write(
                    chosen,
                    path,
                    ranges=given,
                    tolerance=allowed,
                    duration=lasting,
                    scheduler=Local(count) if count > 1 else Here(),
                    progress=tick,
                )
        except InputError as error:
            if error.file is None and error.field in (*inputs, "road_temperature", "tolerance"):
                raise InputError(error.message, field=f"--{error.field}".replace("_", "-")) from None
            raise
        if fmu:
            from tyrefem.realtime.fmu import write_fmu

            write_fmu(path, files["fmu"])
    answer_with({**vars(certificate), **{name: str(file) for name, file in files.items()}})
    for line in words(certificate):
        say(line)
    for file in files.values():
        say(f"wrote {file} ({file.stat().st_size / 1e3:.0f} kB)")
    if fmu and not has_binary(files["fmu"]):
        notify("no C compiler is installed: the FMU holds only its source, which the importing tool has to compile")


def _read(option: str, text: str, unit: str) -> float:
    from tyrefem.quantity import parse

    try:
        return parse(text, unit)
    except InputError as error:
        raise error.within(field=option) from None


def has_binary(path: Path) -> bool:
    """True if an FMU holds a compiled library."""
    import zipfile

    with zipfile.ZipFile(path) as stored:
        return any(name.startswith("binaries/") for name in stored.namelist())


def words(certificate: RealTimeCertificate) -> list[str]:
    """Lines of text that describe a certificate."""
    lines = [
        f"trained on {certificate.trained_on} full runs, certified on {certificate.cases[0]} steady and "
        f"{certificate.cases[1]} changing ones of {certificate.duration:g} s in steps of 1 s: "
        f"largest error {certificate.worst:.3g} K (allowed {certificate.tolerance:g} K)"
    ]
    for kind, errors in (("steady", certificate.steady), ("changing", certificate.driven)):
        listed = ", ".join(f"{name} {value:.2g}" for name, value in errors.items() if name != "rolling_resistance")
        lines.append(f"  {kind}, K: {listed}; rolling resistance {errors['rolling_resistance']:.2g} N")
    return lines


#: Place among the commands.
ORDER = 16


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(export)
