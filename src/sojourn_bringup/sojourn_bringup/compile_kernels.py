"""Has every kernel compiled and kept, so that no run waits for the compiler: one step of each model of a scenario."""

from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_mechanics.arm import controller
from sojourn_mechanics.arm.model import build_arm_model
from sojourn_mechanics.plant.state import zeros_command
from sojourn_mechanics.plant.step import step
from sojourn_mechanics.power import manager
from sojourn_mechanics.sensors import suite
from sojourn_mechanics.steering.drive import DriveModel
from sojourn_plant.start import build_plant

SCENARIO = "lunar_sample"
"""Has all kinds of ground in it."""


def main() -> None:
    """Compile; prints nothing, takes about a minute the first time and some seconds after."""
    scenario = load_scenario(SCENARIO)
    _step_plant(scenario)
    suite.warm_up(scenario.sensors, scenario.gravity)
    DriveModel(scenario.drive, scenario.steering).warm_up()
    controller.warm_up(scenario.arm, build_arm_model(scenario.urdf_xml, scenario.arm))
    manager.warm_up(scenario.power_manager)


def _step_plant(scenario: LoadedScenario) -> None:
    model, state = build_plant(scenario)
    step(model, state, zeros_command(len(model.joints.names), len(model.bus.loads)))


if __name__ == "__main__":
    main()
