"""A small tyre's real-time model, made once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

import tyrefem
from tyrefem.api import Study
from tyrefem.realtime.certificate import RealTimeCertificate, export
from tyrefem.realtime.settings import ExportSettings, TablePoints


@dataclass(frozen=True)
class Exported:
    study: Study
    file: Path
    certificate: RealTimeCertificate


RANGES = {
    "speed": ("0 m/s", "12 m/s"),
    "load": ("9 kN", "13 kN"),
    "pressure": ("520 kPa", "600 kPa"),
    "ambient": ("10 degC", "30 degC"),
    "road_temperature": ("10 degC", "40 degC"),
}


@pytest.fixture(scope="session")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Exported:
    study = tyrefem.study(
        "nasa-22x5.5-8pr",
        {
            "mesh.size": "12 mm",
            "mesh.through": 1,
            "sensors": {
                "skin": {"s": "0.3 in", "depth": "0.62 in"},
                "slow": {"s": "2 in", "depth": "0.1 in", "lag": "4 s"},
            },
            "boundaries.rim": {"law": "lumped", "mass": "4 kg", "cooling": "2 W/K", "air": "0.5 W/K"},
        },
    )
    file = tmp_path_factory.mktemp("realtime") / "tyre.npz"
    settings = ExportSettings(TablePoints(9, 11, 4), training=3, fresh=2)
    certificate = export(study, file, ranges=RANGES, duration=80.0, tolerance=0.3, settings=settings)
    return Exported(study, file, certificate)
