"""A lunar roving vehicle for the tests of this chapter."""

from pathlib import Path

import pytest
import yaml

from sojourn_analysis.vehicle.longitudinal import Course
from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_analysis.vehicle.wheel_traction import ClosedFormWheel, FirmWheel, RollingLoss
from sojourn_config.bundle import read_machine
from sojourn_config.vehicle import vehicle_of_machine
from sojourn_physics.soil.params import SoilParams

CONFIG = Path(__file__).resolve().parents[3] / "config"
MOON = 1.624


@pytest.fixture(scope="session")
def lrv() -> VehicleParams:
    return vehicle_of_machine("lrv", read_machine("lrv", "moon", "lunar_nominal"))


@pytest.fixture(scope="session")
def lunar_soil() -> SoilParams:
    return SoilParams.model_validate(yaml.safe_load((CONFIG / "soils" / "lunar_nominal.yaml").read_text("utf-8")))


@pytest.fixture(scope="session")
def on_soil(lrv: VehicleParams, lunar_soil: SoilParams) -> Course:
    wheel = ClosedFormWheel(lunar_soil, 0.4065, 0.229, MOON)
    return Course(lrv, [wheel, wheel], MOON)


@pytest.fixture(scope="session")
def on_rock(lrv: VehicleParams) -> Course:
    wheel = FirmWheel(0.4065, friction=0.8, loss=RollingLoss(0.02, 1e-3))
    return Course(lrv, [wheel, wheel], MOON)
