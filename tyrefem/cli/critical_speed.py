"""`tyrefem press --critical-speed`: critical speeds over pressures and temperatures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.cli.common import warn
from tyrefem.cli.progress import progress
from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.api import Study
    from tyrefem.mechanics.rolling.amplification import Amplification
    from tyrefem.mechanics.rolling.critical_speed import CriticalSpeed


def print_critical_speeds(
    study: Study,
    pressures: str | None,
    temperatures: str | None,
    out: Path | None,
    *,
    force: bool,
    pictures: bool,
    rise: bool = False,
) -> None:
    """Work out, write and print the critical speeds of all pressures and temperatures."""
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.mechanics.rolling import amplification
    from tyrefem.mechanics.rolling.critical_speed import NEEDS, critical_speed
    from tyrefem.quantity import Unit
    from tyrefem.reports.critical_speed import FILES, write_files

    NEEDS.check(study)
    if rise:
        amplification.check(study)
    given = _numbers("--pressure", pressures, Unit("Pa", gt=0))
    warmed = _numbers("--temperature", temperatures, Unit("degC"))
    options = {"pressure": pressures, "temperature": temperatures}
    warn(study.warnings)
    place = out or Path("results") / f"{study.name}-critical-speed"
    with (
        results_folder(place, "critical-speed", FILES, origin=StudyOrigin(study), force=force) as folder,
        progress(f"{study.name}: critical speed"),
    ):
        try:
            results = [critical_speed(study, pressure=p, temperature=t) for p in given for t in warmed]
            rises = [
                amplification.amplification(
                    result.study, wave.speed, pressure=result.pressure, temperature=result.temperature
                )
                for result in results
                if rise and (wave := result.belt or result.any_wave) is not None
            ]
        except InputError as error:
            raise _placed(error, study, options) from None
        write_files(results, folder, rises=rises, pictures=pictures)
    rows = {"study": study.name, "critical": [result.row() for result in results]}
    answer_with({**rows, "rises": [each.summary() for each in rises]} if rise else rows)
    say(_words(results))
    several = len({each.temperature for each in rises}) > 1
    for each in rises:
        say(_rise_words(each, several=several))
    say(f"results in {folder}")


def _placed(error: InputError, study: Study, options: dict[str, str | None]) -> InputError:
    """The error with its field: the option, or the drive's pressure."""
    if error.field in options and options[error.field] is not None:
        return InputError(error.message, field=f"--{error.field}")
    if error.field == "pressure":
        return study.as_written(InputError(error.message, field="drive.phases.0.pressure", file=study.file))
    return error if error.file else InputError(error.message, field=error.field, file=study.file)


def _numbers(option: str, text: str | None, unit: object) -> list[float | None]:
    """The numbers of a list with units, or None for the default."""
    if text is None:
        return [None]
    try:
        return [unit(part.strip()) for part in text.split(",")]  # type: ignore[operator]
    except InputError as error:
        raise error.within(field=option) from None


def _words(results: list[CriticalSpeed]) -> str:
    study = results[0].study
    lines = [
        study.title,
        f"  critical speeds of the unloaded tyre without loss, waves up to {results[0].highest} round the wheel",
        "  pressure  moduli at   wave of the belt                        any wave           belt, tyre at rest",
    ]
    for result in results:
        belt, least = result.belt, result.any_wave
        warm = "cards" if result.temperature is None else f"{result.temperature:.4g} degC"
        wave = (
            "none, or no equilibrium, below 200 m/s"
            if belt is None
            else f"{belt.speed:6.1f} m/s, {belt.harmonic} waves of {belt.wavelength * 1e3:.0f} mm"
        )
        slowest = "none" if least is None else f"{least.speed:.1f} m/s, {least.region}"
        rest = "none" if result.at_rest is None else f"{result.at_rest:.1f} m/s"
        lines.append(f"  {result.pressure / 1e3:5.0f} kPa  {warm:11} {wave:39} {slowest:18} {rest}")
    fastest = _fastest(results[0])
    slow = min((result.belt.speed for result in results if result.belt is not None), default=None)
    if slow is not None and fastest > slow:
        lines.append(f"  warning: the drive's {fastest:.4g} m/s are above the critical speed of {slow:.4g} m/s")
    return "\n".join(lines)


def _rise_words(rises: Amplification, *, several: bool) -> str:
    """Lines on a rise; ``several``: of several temperatures."""
    warm = f", {rises.temperature:.4g} degC" if several else ""
    state = f"{rises.pressure / 1e3:.0f} kPa{warm}, {rises.load / 1e3:.3g} kN"
    lines = [f"  heat and strain over those without inertia, {state}"]
    for rise in rises.rises:
        doubt = "  loss alone limits some waves" if rise.limited else ""
        lines.append(f"    {rise.speed:6.1f} m/s  heat {rise.loss:.3f}  strain {rise.strain:.3f}{doubt}")
    if rises.refused is not None:
        lines.append(f"    {rises.refused[0]:6.1f} m/s  no solution: {rises.refused[1]}")
    onset = rises.onset
    if onset is None:
        lines.append("    the heat rises too little for the effect standing-wave")
    else:
        lines.append(
            f"    nearest effect: standing-wave with gain = {onset.gain:.3g}, "
            f'critical_speed = "{onset.critical_speed:.3g} m/s"; its factor is off by up to {onset.error:.2f}'
        )
    return "\n".join(lines)


def _fastest(result: CriticalSpeed) -> float:
    from tyrefem.inputs.motion import motion_in

    phases = result.study.card.drive.phases
    return max(motion_in(phase, share).speed for phase in phases for share in (0.0, 1.0))
