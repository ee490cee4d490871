"""The app of each role."""

from collections.abc import Iterable
from typing import Any

from sojourn_arm.app import ArmApp
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.app import App
from sojourn_contract.disturbed_app import disturbed
from sojourn_contract.run_table import table_of
from sojourn_drive.app import DriveApp
from sojourn_operator.app import OperatorApp
from sojourn_plant.app import PlantApp
from sojourn_power.app import PowerApp
from sojourn_sensors.app import SensorsApp

_KINDS = (PlantApp, SensorsApp, DriveApp, ArmApp, PowerApp, OperatorApp)
APPS: dict[str, type[App[Any]]] = {kind.role: kind for kind in _KINDS}
"""All roles but the recorder, in the order of the contract."""


def make_apps(scenario: LoadedScenario, roles: Iterable[str]) -> dict[str, App[Any]]:
    """The apps of these roles, the recorder left out, in the order of the contract."""
    wanted = set(roles)
    made = {role: kind.of(scenario) for role, kind in APPS.items() if role in wanted}
    if not scenario.disturbances:
        return made
    table = table_of(scenario)
    return {role: disturbed(app, table, scenario.disturbances) for role, app in made.items()}
