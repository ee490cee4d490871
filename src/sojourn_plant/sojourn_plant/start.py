"""The plant of a scenario, settled on its ground, or let go in its orbit."""

import math

from sojourn_config.expected_heat import site_heat
from sojourn_config.machine_body import STOWED
from sojourn_config.scenario import LoadedScenario
from sojourn_physics.plant.afloat import AfloatStart, afloat_state
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import PlantState
from sojourn_physics.plant.step import initial_state
from sojourn_physics.terrain.height_field import HeightField


def build_plant(scenario: LoadedScenario, terrain: HeightField | None = None) -> tuple[PlantModel, PlantState]:
    """Model and first state: the machine at the scenario's start, its arm, if it has one, stowed, at rest on its soil.

    Args:
        terrain: another ground than that of the scenario.

    Raises:
        MachineError: parameters that do not fit together. ConfigError: a terrain that cannot be made.
    """
    ground = terrain or scenario.height_field()
    site = Site(
        ground,
        list(scenario.soils.values()),
        scenario.gravity_field,
        scenario.terrain.memory_cell if scenario.terrain.memory else 0.0,
        scenario.config.objects,
        scenario.sun_over(lambda: ground),
        scenario.moving_air,
        site_heat(scenario),
    )
    model = PlantModel(
        scenario.urdf_xml,
        scenario.machine,
        site,
        scenario.power,
        scenario.simulation,
        scenario.tool,
    )
    start, soc, stowed = scenario.config.start, scenario.config.battery_soc, scenario.arm_pose(STOWED)
    if scenario.machine.floats:
        x, y, z = map(math.radians, start.rates_deg_per_s)
        let_go = AfloatStart((start.x, start.y, start.z), start.yaw, start.velocity, (x, y, z))
        return model, afloat_state(model, let_go, soc, stowed)
    return model, initial_state(model, start.x, start.y, start.yaw, soc, stowed)
