"""Schema of `config/arms/NAME.yaml`: how an arm may be moved, and what it brings along to a machine that carries it."""

from functools import partial
from typing import Annotated

from pydantic import BeforeValidator, Field, SerializeAsAny

from sojourn_flight.arm.params import ArmParams
from sojourn_machine.actuator_choice import Drive
from sojourn_machine.power.loads import LoadParams
from sojourn_machine.sensor_choice import SensorParams
from sojourn_machine.supports import PadParams
from sojourn_physics.sensors.params import JointGroupParams, read_sensor

Wrist = Annotated[SerializeAsAny[SensorParams] | None, BeforeValidator(partial(read_sensor, "wrist"))]


class ArmConfig(ArmParams):
    """One arm. Names of joints and links are those of its own URDF; on a machine they get the prefix of its mount."""

    urdf: str | None = Field(
        default=None,
        min_length=1,
        description="of an arm that a machine may carry on a mount: file in urdf/, or a table such as dh/puma560.yaml",
    )
    urdf_root: str | None = Field(
        default=None, min_length=1, description="link with which the arm begins in that file; left out: the outermost"
    )
    inertias_as_published: tuple[str, ...] = Field(
        default=(),
        description="links whose inertia is kept as published, though no body can have it: without a mass, or with "
        "moments that do not fit together",
    )
    drives: tuple[Drive, ...] = Field(default=(), description="what drives groups of its joints")
    joint_groups: dict[str, JointGroupParams] = Field(default_factory=dict, description="encoders by group of joints")
    load: LoadParams | None = Field(
        default=None, description="what its motors draw from the bus, for a machine whose bus has no load of that name"
    )
    pads: tuple[PadParams, ...] = Field(default=(), description="points of the arm that may touch the ground")
    wrench_sensor_link: str | None = Field(
        default=None, min_length=1, description="link of the arm that hangs on a force/torque sensor"
    )
    wrist: Wrist = Field(default=None, description="that force/torque sensor")
