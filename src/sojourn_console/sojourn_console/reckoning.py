"""A drive reckoned in seconds: the laws of the drive on the ground of the map, on a machine that does as it is told.

The drive is the one that flies (`sojourn_flight.supervision.drive`), with its camera's view of the map's ground: it
sees rocks, plans ways round them, turns, waits and stops as it would. What moves it is left out: joints follow their
references at once, its odometry is right, and it stands on the plane under its supports. What the way takes follows
from the costs that were measured for the machine:

    T = sum over the periods of dt t(grade) / t(0)
    E = sum over the way of e(grade) ds  +  stops E_stop  +  turns E_turn  +  angle E_radian  +  P_house T

(symbols as in `sojourn_flight.planning.energy_forecast`). Range: ground and soil on which those costs were measured;
slip that stops a machine is not in it. Steps of DT, five control periods.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_console.rehearsed import RECKONED, RehearsedDrive
from sojourn_contract.hazcam import TOPIC as CLOUD
from sojourn_contract.hazcam import hazard_camera_of
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_drive.goals import goal_of
from sojourn_flight.hazards.keep_out import KeepOut
from sojourn_flight.mobility.mobility import InertialMeasurement, MobilityJoints
from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.planning.energy_forecast import SECONDS_PER_HOUR, on_grade
from sojourn_flight.planning.energy_params import EnergyParams
from sojourn_flight.supervision.drive import DriveModel
from sojourn_flight.supervision.drive_types import DriveInput
from sojourn_machine.params import FloatArray
from sojourn_operator.steps.step import RunFacts, View
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams, HazcamView
from sojourn_physics.terrain.standing_ground import StandingGround

DT = 0.1
"""[s]"""
STILL = 1e-3
"""Slower than this it stands [m/s], [rad/s]."""
LONGEST_S = 7200.0


class TripAccount:
    """What has been taken. costs: of the machine."""

    def __init__(self, costs: EnergyParams) -> None:
        self.costs = costs
        self.seconds = self.motion = self.length = 0.0
        self._level = on_grade(costs, costs.time_per_metre, 0.0)
        self._moved = self._turned = False

    @property
    def energy_wh(self) -> float:
        """[Wh]"""
        return (self.motion + self.costs.house_power * self.seconds) / SECONDS_PER_HOUR

    def add(self, speed: float, yaw_rate: float, grade: float) -> None:
        """A step: speed [m/s], yaw rate [rad/s], grade, up positive [rad]."""
        costs, way = self.costs, speed * DT
        moves, turns = speed > STILL, speed <= STILL and abs(yaw_rate) > STILL
        slower = on_grade(costs, costs.time_per_metre, grade) / self._level if moves and self._level > 0.0 else 1.0
        self.seconds += DT * max(slower, 1.0)
        self.length += way
        self.motion += way * on_grade(costs, costs.energy_per_metre, grade)
        self.motion += abs(yaw_rate) * DT * costs.energy_per_radian if turns else 0.0
        self.motion += costs.stop_energy * (moves and not self._moved) + costs.turn_energy * (
            turns and not self._turned
        )
        self._moved, self._turned = moves, turns


def reckon(loaded: LoadedScenario, look: int = 0) -> Iterator[RehearsedDrive]:
    """The last step of a scenario, a way for the drive, from its start; what is found, step by step.

    Each look has other noise of the camera: near rocks it decides which way round is taken, and by how much the
    drive may come to other figures.

    Nothing is yielded for a machine whose costs are not known.
    """
    known = loaded.as_believed()
    if known.driving is None or known.drive.energy is None:
        return
    model = DriveModel(known.drive, known.mobility(), hazard_camera_of(known), keep_out=KeepOut(known.keep_out))
    ability = model.mobility.ability
    ground = StandingGround(loaded.height_field(), ability.supports, ability.ride_height)
    eyes = _Eyes(loaded, ground, look)
    action = loaded.config.steps[-1].action
    start = known.start
    position, roll, pitch = ground.pose(start.x, start.y, start.yaw)
    state = model.initial_state(start.x, start.y, start.yaw, float(position[2]))
    message = action.goal(View(0, 0, {}, RunFacts()))
    goal = goal_of(action.topic, message, state.odometry, 1)
    account, found = TripAccount(known.drive.energy), RehearsedDrive(RECKONED, "moving", look=look)
    here = state.odometry
    rolling = np.isin(model.mobility.joints, [support.joint for support in known.machine.rolling])
    joints = MobilityJoints(*(np.zeros(len(rolling)) for _ in range(2)))
    for count in range(round(LONGEST_S / DT)):
        cloud = eyes.look(count, position, (roll, pitch, here.yaw))
        felt = InertialMeasurement(roll_pitch=(roll, pitch))
        asked = goal if count == eyes.first + 1 else None  # it has looked round once, as a machine that stands has
        state, output = model.step(state, DriveInput(joints, felt, cloud=cloud, goal=asked), DT)
        here, references = state.odometry, output.references
        rolled = joints.position + DT * references.velocity
        joints = MobilityJoints(np.where(rolling, rolled, references.position), references.velocity)
        position, roll, pitch = ground.pose(here.x, here.y, here.yaw)
        if count <= eyes.first:
            continue
        speed = math.hypot(here.v_x, here.v_y)
        account.add(speed, here.yaw_rate, -pitch if here.v_x >= 0.0 else pitch)
        tilt = math.degrees(math.acos(math.cos(roll) * math.cos(pitch)))
        found = replace(
            found, time_s=account.seconds, length_m=account.length, energy_wh=account.energy_wh,
            tilt_deg=max(found.tilt_deg, tilt),
        )  # fmt: skip
        if output.outcomes:
            last = output.outcomes[-1]
            yield replace(found, state=last.kind, reason=last.reason, is_over=True)
            return
        yield found


class _Eyes:
    """The hazard camera on the map's ground. loaded: the scenario. ground: it. look: which noise it has."""

    def __init__(self, loaded: LoadedScenario, ground: StandingGround, look: int) -> None:
        params = loaded.sensors.first(HazcamParams)
        self._ground, self.first = ground, 0
        self._camera = None if params is None else hazcam.hazcam_on(params, loaded.urdf_xml)
        if self._camera is None:
            return
        self._noise = hazcam.initial_state(self._camera, loaded.config.seed + look)
        row = table_of(loaded).topic(CLOUD)
        self._every = max(1, round(row.every * CONTROL_PERIOD_S / DT))

    def look(self, count: int, position: FloatArray, angles: tuple[float, float, float]) -> FloatArray | None:
        """Points in base_link, shape (n, 3) [m], at a step in which it looks. angles: roll, pitch, yaw [rad]."""
        if self._camera is None or count % self._every:
            return None
        seen = HazcamView(self._ground.field)
        self._noise, points = hazcam.step(self._camera, self._noise, seen, position, rotation_of(*angles))
        return points.astype(np.float64)
