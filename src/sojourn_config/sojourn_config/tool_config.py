"""Schema of `config/tools/NAME.yaml`: the tool at an arm's end, and the sensor of its actuator."""

from pydantic import Field

from sojourn_config.errors import MISSING, Problem
from sojourn_config.machine import MachineConfig
from sojourn_config.yaml_file import YamlDocument
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_machine.tools import TOOL_JOINT, ToolParams
from sojourn_physics.sensors.encoder import EncoderParams
from sojourn_physics.sensors.params import JointGroupParams, SensorSuiteParams
from sojourn_physics.soil.params import SoilParams

GROUP = "tool"


class ToolSet(Params):
    """One tool."""

    description: str = Field(min_length=1, description="what tool this is")
    tool: ToolParams
    encoder: EncoderParams = Field(description="on its actuator")
    effort_resolution: float = Field(gt=0.0, le=1e3, description="step of the measured effort [N m or N]")
    effort_noise: float = Field(ge=0.0, le=1e3, description="standard deviation of the measured effort [N m or N]")


def pad_problem(config: MachineConfig, tool: ToolSet, document: YamlDocument) -> Problem | None:
    """Why the tool does not fit onto the machine, if it does not."""
    pads = [pad.name for pad in config.pads]
    if tool.tool.pad in pads:
        return None
    return document.problem(
        ("tool", "pad"), tool.tool.pad, "is no pad of the machine: " + names_text(tool.tool.pad, pads)
    )


def tool_ground_problems(tool: ToolSet | None, soil: SoilParams, document: YamlDocument) -> list[Problem]:
    """What the tool needs of a soil and its file does not give."""
    if tool is None or tool.tool.kind != "drill" or soil.specific_energy is not None:
        return []
    return [document.problem(("specific_energy",), MISSING, "the key is missing: needed by the drill")]


def with_tool(sensors: SensorSuiteParams, tool: ToolSet) -> SensorSuiteParams:
    """The sensors with that of the tool."""
    group = JointGroupParams(
        joints=(TOOL_JOINT,),
        encoder=tool.encoder,
        effort_resolution=tool.effort_resolution,
        effort_noise=tool.effort_noise,
    )
    return sensors.model_copy(update={"joint_groups": {**sensors.joint_groups, GROUP: group}})
