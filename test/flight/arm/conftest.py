"""Two arms for the tests of this folder: a small one of the same topology, and the explorer's."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sojourn_config.arms import load_arm
from sojourn_config.machine_reader import joined_machine
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.serial_arm import SerialArm

ROOT = Path(__file__).resolve().parents[3]


def _link(name: str, mass: float, com: str, collision: str) -> str:
    inertia = mass * 0.01
    return f"""<link name="{name}"><inertial><origin xyz="{com}"/><mass value="{mass}"/>
      <inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{inertia * 1.2}" iyz="0" izz="{inertia * 1.4}"/>
      </inertial>
      {collision}</link>"""


def _joint(name: str, kind: str, parent: str, child: str, xyz: str, axis: str = "", limit: str = "") -> str:
    rest = f'<axis xyz="{axis}"/><limit {limit}/>' if axis else ""
    return f"""<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
      <origin xyz="{xyz}"/>{rest}</joint>"""


def _box(size: str, at: str = "0 0 0") -> str:
    return f'<collision><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></collision>'


def _tube(radius: float, length: float, at: str, rpy: str = "0 0 0") -> str:
    return f"""<collision><origin xyz="{at}" rpy="{rpy}"/><geometry>
      <cylinder radius="{radius}" length="{length}"/></geometry></collision>"""


def _limit(lower: float, upper: float) -> str:
    return f'lower="{lower}" upper="{upper}" effort="80" velocity="2"'


_PARTS = [
    '<?xml version="1.0"?><robot name="small"><link name="root_link"/>',
    # The base is not the root, and stands turned in it.
    """<joint name="root_joint" type="fixed"><parent link="root_link"/><child link="base_link"/>
      <origin xyz="0.3 0.1 0.5" rpy="0 0 0.4"/></joint>""",
    _link("base_link", 50.0, "0 0 0", _box("0.8 0.5 0.3")),
    _link("mast_link", 3.0, "0 0 0.3", _tube(0.04, 0.7, "0 0 0.35")),
    _joint("mast_joint", "fixed", "base_link", "mast_link", "0.36 0.2 0.15"),
    _link("rocker_link", 2.0, "0 0 0", _box("0.5 0.04 0.06", "0.2 0 -0.1")),
    _joint("rocker_joint", "revolute", "base_link", "rocker_link", "0.1 0.35 -0.05", "0 1 0", _limit(-1, 1)),
    _link("wheel_link", 2.0, "0 0 0", '<collision><geometry><sphere radius="0.12"/></geometry></collision>'),
    _joint(
        "wheel_joint",
        "continuous",
        "rocker_link",
        "wheel_link",
        "0.45 0 -0.2",
        "0 1 0",
        'effort="20" velocity="2"',
    ),
    _link("shoulder_link", 1.0, "0 0 0.03", _tube(0.04, 0.08, "0 0 0.04")),
    _joint("shoulder_joint", "revolute", "base_link", "shoulder_link", "0.45 -0.1 0", "0 0 1", _limit(-2.5, 2.5)),
    _link("upper_link", 1.5, "0.2 0 0.01", _tube(0.03, 0.4, "0.2 0 0", "0 1.5707963 0")),
    _joint("upper_joint", "revolute", "shoulder_link", "upper_link", "0.05 0 0.05", "0 1 0", _limit(-1.8, 1.8)),
    _link("fore_link", 1.2, "0.18 0.01 0", _tube(0.025, 0.36, "0.2 0 0", "0 1.5707963 0")),
    _joint("fore_joint", "revolute", "upper_link", "fore_link", "0.4 0 0", "0 1 0", _limit(-2.7, 2.7)),
    _link("hand_link", 0.6, "0.02 0 0", _box("0.08 0.05 0.05", "0.04 0 0")),
    _joint("hand_joint", "revolute", "fore_link", "hand_link", "0.4 0 0", "0 1 0", _limit(-1.9, 1.9)),
    _link(
        "tool_link",
        1.0,
        "0.01 0 -0.02",
        _tube(0.03, 0.06, "0.05 0 0", "0 1.5707963 0") + _box("0.03 0.03 0.08", "0.05 0 -0.05"),
    ),
    _joint("tool_joint", "revolute", "hand_link", "tool_link", "0.05 0 0", "1 0 0", _limit(-2.9, 2.9)),
    '<link name="tip_link"/>',
    """<joint name="tip_joint" type="fixed"><parent link="tool_link"/><child link="tip_link"/>
      <origin xyz="0.05 0 -0.1" rpy="3.1415926535897931 0 0"/></joint></robot>""",
]
SMALL_URDF = "\n".join(_PARTS)

SMALL_PARAMS: dict[str, Any] = {
    "joint_names": ("shoulder_joint", "upper_joint", "fore_joint", "hand_joint", "tool_joint"),
    "tip_link": "tip_link",
    "max_velocity": (0.5, 0.5, 0.6, 0.8, 0.8),
    "max_acceleration": (1.0, 1.0, 1.2, 1.5, 1.5),
    "max_jerk": (5.0, 5.0, 6.0, 8.0, 8.0),
    "named_poses": {"stow": (1.5, -0.4, 2.4, 0.0, 0.0), "unfold": (0.0, -1.0, 1.9, -0.9, 0.0)},
    "ground_contact_links": ("tool_link",),
}


@dataclass(frozen=True, repr=False)
class Arm:
    """An arm with what belongs to it."""

    params: ArmParams
    model: ArmModel
    urdf: str

    def random_posture(self, generator: np.random.Generator) -> NDArray[np.float64]:
        """Joint positions anywhere within the limits."""
        return generator.uniform(self.model.lower, self.model.upper)


@pytest.fixture(scope="session")
def small_urdf() -> str:
    """Text of the small arm's URDF."""
    return SMALL_URDF


@pytest.fixture(scope="session")
def small_values() -> dict[str, Any]:
    """Parameters of the small arm as a dictionary, to be copied and spoilt."""
    return SMALL_PARAMS


@pytest.fixture(scope="session")
def small() -> Arm:
    """The small arm."""
    params = ArmParams(**SMALL_PARAMS)
    return Arm(params, build_arm_model(SMALL_URDF, params), SMALL_URDF)


@pytest.fixture(scope="session")
def explorer() -> Arm:
    """The explorer's arm as it is delivered."""
    machine = joined_machine("explorer")
    return Arm(machine.arm, build_arm_model(machine.urdf.text, machine.arm), machine.urdf.text)


@pytest.fixture(params=["small", "explorer"])
def arm(request: pytest.FixtureRequest) -> Arm:
    """Both arms, one after the other."""
    chosen: Arm = request.getfixturevalue(request.param)
    return chosen


ARM_NAMES = ("cartesian", "cylindrical", "explorer_arm", "puma560", "scara", "srms", "ssrms")


@pytest.fixture(params=ARM_NAMES)
def named_arm(request: pytest.FixtureRequest) -> SerialArm:
    """Each arm that is delivered, one after the other."""
    return load_arm(request.param)
