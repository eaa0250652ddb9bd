"""The drive: phases of speed, load, pressure and surroundings, each constant or a ramp."""

from __future__ import annotations

import functools
import math
from bisect import bisect_right
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from tyrefem.cards import Card, Text, Warmth
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.drive_table import DriveTable
from tyrefem.inputs.motion import motion_in
from tyrefem.quantity import Ramp, Unit


@dataclass(frozen=True)
class RampOf:
    """Annotation of a drive quantity: ``"20 mph"``, or ``{ from = "0 mph", to = "150 mph" }``."""

    unit: Unit

    def __call__(self, value: Any) -> Ramp:
        if not isinstance(value, Mapping):
            number = self.unit(value)
            return Ramp(number, number)
        for key in value:
            if key not in ("from", "to"):
                raise InputError(f"unknown key '{key}'{nearest(str(key), ['from', 'to'])}")
        if set(value) != {"from", "to"}:
            raise InputError("a ramp needs both 'from' and 'to'")
        ends = []
        for key in ("from", "to"):
            try:
                ends.append(self.unit(value[key]))
            except InputError as error:
                raise error.within(field=key) from None
        return Ramp(*ends)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        number = self.unit.schema()
        ends = {"from": "Value at the start of the phase.", "to": "Value at its end; linear in time between them."}
        keys = {name: {**number, "description": words} for name, words in ends.items()}
        whole = {"type": "object", "properties": keys, "required": list(keys)}
        ramp = {**whole, "additionalProperties": False, "title": "Ramp, linear in time"}
        plain = {key: value for key, value in number.items() if not key.startswith("x-")}
        return {"anyOf": [plain, ramp], "x-quantity": number["x-quantity"], "examples": number["examples"]}


#: Fastest wheel speed accepted, m/s: the land-speed record is 341 m/s.
FASTEST = 400.0
#: Shortest phase accepted, s: readings of less are one.
SHORTEST = 1e-6


class Phase(Card):
    """A part of the drive. The study's ``[drive]`` table gives missing keys."""

    name: Text = "rolling"
    duration: Annotated[float, Unit("s", ge=SHORTEST, le=1e7)]
    speed: Annotated[Ramp, RampOf(Unit("m/s", ge=0, le=FASTEST))]
    load: Annotated[Ramp, RampOf(Unit("N", ge=0))] | None = None
    deflection: Annotated[Ramp, RampOf(Unit("m", ge=0))] | None = None
    pressure: Annotated[Ramp, RampOf(Unit("Pa", ge=0, le=1e7))]
    ambient: Annotated[Ramp, RampOf(Unit("degC", le=2000))] = Ramp(25.0, 25.0)
    road_temperature: Annotated[Ramp, RampOf(Unit("degC", le=2000))] | None = None
    rim_temperature: Annotated[Ramp, RampOf(Unit("degC", le=2000))] | None = None
    drum_diameter: Annotated[float, Unit("m", gt=0)] = math.inf
    #: Positive under braking, 1 for a locked wheel; negative under driving, to -1 at twice the free rolling speed.
    slip_ratio: Annotated[Ramp, RampOf(Unit("1", ge=-1, le=1))] | None = None
    #: Slip as a speed: forward speed minus the tread's speed.
    slip_speed: Annotated[Ramp, RampOf(Unit("m/s", ge=-FASTEST, le=FASTEST))] | None = None
    #: Angle between the wheel's plane and its motion, of either sign.
    slip_angle: Annotated[Ramp, RampOf(Unit("rad"))] | None = None
    #: Torque of the axle, positive drives, instead of a slip. Only with the law of sliding ``rolling``.
    torque: Annotated[Ramp, RampOf(Unit("N*m"))] | None = None
    #: Lean of the wheel, positive: the side z > 0 comes down. Only with the law of sliding ``rolling``.
    camber: Annotated[Ramp, RampOf(Unit("rad"))] | None = None

    @model_validator(mode="after")
    def _one_of_load_and_deflection(self) -> Phase:
        if (self.load is None) == (self.deflection is None):
            raise InputError("give exactly one of 'load' and 'deflection'")
        return self

    @model_validator(mode="after")
    def _possible_slip(self) -> Phase:
        check_slip(self)
        return self

    @property
    def slides(self) -> bool:
        """True if the tread slides on the road."""
        return slides(self)

    @property
    def stands(self) -> bool:
        """True if the vehicle stands during the whole phase."""
        return self.speed.start == self.speed.end == 0

    @property
    def stops(self) -> bool:
        """True if the vehicle stands at the end."""
        return self.speed.end <= 0

    @property
    def unloads(self) -> bool:
        """True if the tyre carries nothing at the end."""
        carried = self.deflection if self.load is None else self.load
        return carried is not None and carried.end <= 0

    @property
    def steady_motion(self) -> bool:
        """True if the motion is constant and without slip."""
        return self.speed.constant and not self.slides

    @property
    def changes_load(self) -> bool:
        """True if the strain cycle changes during the phase."""
        ramps = [self.load, self.deflection, self.pressure]
        return any(ramp is not None and not ramp.constant for ramp in ramps)


class Drive(DriveTable):
    """The whole drive: ``phases`` in their order, starting at ``initial`` temperature."""

    kind: ClassVar[str] = "drive"
    phase_card: ClassVar[type[Card]] = Phase
    # Before `initial`, whose default is an ambient temperature: an error there must name the phase.
    phases: tuple[Phase, ...]
    initial: Warmth

    @model_validator(mode="after")
    def _distinct_names(self) -> Drive:
        for name, count in Counter(phase.name for phase in self.phases).items():
            if count > 1:
                raise InputError(f"two phases are named '{name}'", field="phases")
        return self

    @functools.cached_property
    def starts(self) -> tuple[float, ...]:
        """Start of each phase, s."""
        total, result = 0.0, []
        for phase in self.phases:
            result.append(total)
            total += phase.duration
        return tuple(result)

    @functools.cached_property
    def end(self) -> float:
        """End of the drive, s."""
        return sum(phase.duration for phase in self.phases)

    @property
    def top_speed(self) -> float:
        """Greatest speed over the road, m/s."""
        return max(max(phase.speed.start, phase.speed.end) for phase in self.phases)

    def locate(self, time: float) -> tuple[int, float]:
        """Number of the phase at a time, and the elapsed fraction of it."""
        starts = self.starts
        number = max(bisect_right(starts, time) - 1, 0)
        fraction = (time - starts[number]) / self.phases[number].duration
        return number, min(max(fraction, 0.0), 1.0)

    def value(self, quantity: str, time: float) -> float | None:
        """A phase's quantity (``speed``, ``ambient``...) at a time, SI; None if the drive does not give it."""
        number, fraction = self.locate(time)
        ramp = getattr(self.phases[number], quantity)
        return None if ramp is None else ramp.at(fraction)

    @functools.cached_property
    def _locked(self) -> tuple[bool, ...]:
        return tuple(is_locked(phase) for phase in self.phases)

    def locked_since(self, time: float) -> float | None:
        """Time at which a locked wheel locked, s; None if the wheel turns at ``time``, or stands with the vehicle."""
        number, _ = self.locate(time)
        if not self._locked[number]:
            return None
        while number > 0 and self._locked[number - 1]:
            number -= 1
        return self.starts[number]


#: Largest slip angle, above which a wheel skids sideways instead of rolling (a judgement).
STEEPEST = math.radians(45.0)


#: Fractions of a phase where its slip is checked.
LOOKS = tuple(i / 50 for i in range(51))


#: Quantities that make the tread slide.
SLIPS = ("slip_ratio", "slip_speed", "slip_angle", "torque", "camber")
#: Largest camber: beyond it a wheel falls over (a judgement).
LEANING = math.radians(30.0)


def slides(phase: Phase) -> bool:
    """True if the phase has slip, torque or camber."""
    ramps = (getattr(phase, key) for key in SLIPS)
    return any(ramp is not None and (ramp.start != 0 or ramp.end != 0) for ramp in ramps)


def is_locked(phase: Phase) -> bool:
    """True if the wheel does not turn during the whole phase while the vehicle moves.

    A ramp that ends at a locked wheel does not count.
    """
    if not slides(phase) or phase.stands:
        return False
    return not any(motion_in(phase, fraction).turns for fraction in (0.0, 0.5, 1.0))


def check_slip(phase: Phase) -> None:
    """Refuse impossible slip; the InputError names the key."""
    if phase.slip_ratio is not None and phase.slip_speed is not None:
        raise InputError("give 'slip_ratio' or 'slip_speed', not both", field="slip_speed")
    if phase.torque is not None and (phase.slip_ratio is not None or phase.slip_speed is not None):
        key = "slip_speed" if phase.slip_ratio is None else "slip_ratio"
        raise InputError(f"give 'torque' or '{key}', not both: one follows from the other", field="torque")
    for key, most in (("slip_angle", STEEPEST), ("camber", LEANING)):
        ramp = getattr(phase, key)
        for angle in () if ramp is None else (ramp.start, ramp.end):
            if abs(angle) > most * (1 + 1e-9):
                limit = math.degrees(most)
                raise InputError(
                    f"{math.degrees(angle):.4g} deg is out of range: -{limit:g} to {limit:g} deg", field=key
                )
    if not slides(phase):
        return
    if phase.stands:
        key = next(key for key in SLIPS if (ramp := getattr(phase, key)) is not None and (ramp.start or ramp.end))
        raise InputError("needs a speed, but the vehicle stands: remove it or make it 0 in this phase", field=key)
    for motion in (motion_in(phase, fraction) for fraction in LOOKS if phase.slip_speed is not None):
        if abs(motion.slip_speed) > motion.forward_speed * (1 + 1e-9):
            raise InputError(
                f"{motion.slip_speed:.4g} m/s is more than the wheel's forward speed, {motion.forward_speed:.4g} m/s, "
                "which is the slip speed of a locked wheel",
                field="slip_speed",
            )
