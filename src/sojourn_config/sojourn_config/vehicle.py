"""The vehicle of the analysis from a machine's files, with what `analysis.yaml` of its folder says beside them.

What URDF and parameter sets tell is not told again: `analysis.yaml` has what they leave out (linkages, published
figures) and what a source gives in place of it. Its `axles` are a table by the names of the axles.
"""

import dataclasses

from sojourn_analysis.vehicle.from_machine import BusSupply, vehicle_of
from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import Bundle
from sojourn_config.errors import ConfigError
from sojourn_config.extends import read_document
from sojourn_config.load import validate
from sojourn_config.machine_body import STOWED
from sojourn_config.paths import SUFFIX, resolve
from sojourn_config.yaml_file import Data, KeyPath, YamlDocument
from sojourn_machine.names import names_text
from sojourn_machine.power.battery import SECONDS_PER_HOUR

ANALYSIS = f"analysis{SUFFIX}"
AXLES = "axles"


def vehicle_of_machine(name: str, bundle: Bundle, standing: StandingMachine | None = None) -> VehicleParams:
    """The vehicle of a machine, arm stowed.

    Args:
        name: in `config/machines`, or the path of its folder. bundle: that machine. standing: the same, if it is there.

    Raises:
        ConfigError: the machine stands fast, or its `analysis.yaml` does not fit.
        InvalidValueError: wheels that do not make axles of two.
    """
    standing = standing or StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)
    path = resolve("machines", name)
    speed, angles = bundle.drive.limits.max_speed, bundle.arm_pose(STOWED)
    vehicle = vehicle_of(path.parent.name, standing, supply_of(bundle), speed, angles)
    beside = path.with_name(ANALYSIS)
    return validate(_over(vehicle, read_document(beside, "machines")), VehicleParams) if beside.is_file() else vehicle


def supply_of(bundle: Bundle) -> BusSupply:
    """Voltage of the half full first store, the energy of all full ones, and what the loads beside the motors take."""
    house = sum(load.power_w for load in bundle.power.loads if load.kind != "commanded")
    stores = list(bundle.power.all_stores.values())
    energy = sum(store.stored_energy(1.0) / SECONDS_PER_HOUR for store in stores)
    return BusSupply(stores[0].open_circuit_voltage(0.5), energy, house)


def _over(vehicle: VehicleParams, document: YamlDocument) -> YamlDocument:
    """The document with the vehicle's keys below its own. Raises ConfigError for an axle that there is not."""
    data: dict[str, Data] = vehicle.model_dump(mode="json")
    places = {axle.name: index for index, axle in enumerate(vehicle.axles)}
    own = document.data.get(AXLES, {})
    if not isinstance(own, dict):
        raise ConfigError([document.problem((AXLES,), own, "allowed is a table by the names of the axles")])
    unknown = [name for name in own if name not in places]
    if unknown:
        raise ConfigError([document.problem((AXLES, name), own[name], names_text(name, places)) for name in unknown])
    axles: list[Data] = [{**axle.model_dump(mode="json"), **_table(own.get(axle.name))} for axle in vehicle.axles]

    def placed(path: KeyPath) -> KeyPath:
        return (AXLES, places[str(path[1])], *path[2:]) if path[0] == AXLES and len(path) > 1 else path

    return dataclasses.replace(
        document,
        data={**data, **document.data, AXLES: axles},
        lines={placed(path): line for path, line in document.lines.items()},
        origins={placed(path): origin for path, origin in document.origins.items()},
    )


def _table(value: Data) -> dict[str, Data]:
    return value if isinstance(value, dict) else {}
