"""The ``[drive]`` table as written: the defaults of its phases, and the place of an error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from tyrefem.cards import Card
from tyrefem.errors import InputError, nearest

#: Alternative keys: a phase's key replaces the alternative of the drive.
EXCLUSIVE_KEYS = {
    "load": ["deflection"],
    "deflection": ["load"],
    "slip_ratio": ["slip_speed", "torque"],
    "slip_speed": ["slip_ratio", "torque"],
    "torque": ["slip_ratio", "slip_speed"],
}


class DriveTable(Card):
    """A table with a list of ``phases``, cards of type ``phase_card``, whose missing keys the table gives."""

    phase_card: ClassVar[type[Card]]

    @model_validator(mode="before")
    @classmethod
    def _spread_defaults(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        defaults = {key: value for key, value in data.items() if key not in ("phases", "initial")}
        allowed = cls.phase_card.model_fields
        for key in defaults:
            if key not in allowed:
                raise InputError(f"unknown key '{key}'{nearest(str(key), {*allowed, *cls.model_fields})}")
        phases = data.get("phases", [{}])
        if not isinstance(phases, list) or not phases:
            raise InputError("must be a list of at least one phase", field="phases")
        filled = [_filled(defaults, phase, number, len(phases)) for number, phase in enumerate(phases)]
        initial = data.get("initial", _start_of(filled[0].get("ambient", "25 degC")))
        return {"initial": initial, "phases": filled}

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """The table as written: every key of a phase, and phases without those keys."""
        table = handler.resolve_ref_schema(handler(core))
        whole = handler.resolve_ref_schema(handler(cls.phase_card.__pydantic_core_schema__))
        phase = {key: value for key, value in whole.items() if key != "required"}
        phases = {**table["properties"]["phases"], "items": phase, "minItems": 1}
        table["properties"] = {**phase["properties"], **table["properties"], "phases": phases}
        table.pop("required", None)
        return table


def _filled(defaults: Mapping[str, Any], phase: Any, number: int, count: int) -> dict[str, Any]:
    if not isinstance(phase, Mapping):
        raise InputError("must be a table of keys", field=f"phases.{number}")
    dropped = {other for key, others in EXCLUSIVE_KEYS.items() if key in phase for other in others}
    named = {"name": f"phase {number + 1}" if count > 1 else "rolling"}
    return named | {key: value for key, value in defaults.items() if key not in dropped} | dict(phase)


def _start_of(value: Any) -> Any:
    return value.get("from") if isinstance(value, Mapping) else value


def as_written(drive: Mapping[str, Any], field: str) -> str:
    """The field of a study file that gives a phase's field: of ``[drive]`` if the phase does not set it.

    >>> as_written({"ambient": "25 lbf"}, "drive.phases.0.ambient")
    'drive.ambient'
    >>> drive = {"ambient": "25 degC", "phases": [{"name": "taxi", "speed": "20 mph"}, {"ambient": "5 lbf"}]}
    >>> as_written(drive, "drive.phases.taxi.ambient.from"), as_written(drive, "drive.phases.1.ambient")
    ('drive.ambient.from', 'drive.phases.1.ambient')
    """
    listed = drive.get("phases")
    phases = listed if isinstance(listed, list) and listed else [{"name": drive.get("name", "rolling")}]
    for number, phase in enumerate(phases):
        given = phase if isinstance(phase, Mapping) else {}
        for which in (str(number), str(given.get("name", f"phase {number + 1}"))):
            if f"{field}.".startswith(f"drive.phases.{which}."):
                rest = field.removeprefix(f"drive.phases.{which}").removeprefix(".")
                key = rest.partition(".")[0]
                from_drive = listed is None or (key in drive and key not in given)
                return f"drive.{rest}".removesuffix(".") if from_drive else field
    return field
