"""Checks of a machine's heat against its loads and stores."""

from collections.abc import Iterator

from sojourn_config.errors import Problem
from sojourn_config.yaml_file import YamlDocument
from sojourn_machine.names import names_text
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.thermal.thermal_params import ThermalParams


def thermal_problems(thermal: ThermalParams, power: PowerParams, document: YamlDocument) -> Iterator[Problem]:
    """Heaters are loads, what warms is there, every node can give its heat to something."""
    loads = {load.name: load for load in power.loads}
    known = [*loads, *power.all_stores, *power.sources]
    for name in thermal.warms:
        if name not in known:
            yield document.problem(("warms", name), name, "is no load, store or source: " + names_text(name, known))
    for name, heater in thermal.heaters.items():
        load = loads.get(name)
        if load is None:
            yield document.problem(("heaters", name), name, "has no load that feeds it: " + names_text(name, loads))
        elif load.kind == "commanded":
            allowed = "is a load whose motors say what it draws: allowed is constant_power or resistive"
            yield document.problem(("heaters", name), name, allowed)
        elif load.power_w != heater.power_w:
            allowed = f"allowed is the {load.power_w:g} W of the load"
            yield document.problem(("heaters", name, "power_w"), heater.power_w, allowed)
    joined = {end for conductor in thermal.conductors for end in conductor.between}
    for name, node in thermal.nodes.items():
        outside = node.emissivity * (node.area_to_sky + node.area_to_ground) + thermal.convection * node.area_to_air
        if name not in joined and outside == 0.0:
            allowed = "gives its heat to nothing: allowed is a conductor, or a surface with an emissivity"
            yield document.problem(("nodes", name), name, allowed)
