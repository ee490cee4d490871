"""An example flight node: a drive controller as another team would write it, from the contract's page alone.

It imports rclpy, ROS messages and the standard library, and nothing of Sojourn. It steers six wheels about a common
centre, turns on the spot towards a goal and drives to it in an arc, and keeps an odometry from wheels and gyro.

    scripts/start.py flat_drive --replace drive="python3 flight_drive.py --start -1 0 0"

Lock-step: it acts at each stamp at which its inputs are in: measurements of that stamp, switches at each fifth period,
points of the hazard camera at each fiftieth (it makes no use of them), and the operator's tick of five periods before,
with all goals that the tick announces. Real time: it acts when joint states come, with the latest of the rest.

With --resumable it takes part in checkpoints, in lock-step: asked on checkpoint/take it says on checkpoint/state, as
text that nobody else has to read, all that it knows after that period; and where the run goes on, which its parameter
resumed_at says, it waits for that text before it is ready.
"""

import argparse
import base64
import json
import math
import signal
import sys
from array import array
from dataclasses import asdict, dataclass, field
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, TwistStamped, Vector3Stamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time
from sensor_msgs.msg import BatteryState, Imu, JointState, PointCloud2
from std_msgs.msg import Header

# The machine, from its drawing: positions of the wheels in base_link [m], rolling radius with grousers [m].
WHEELS = {
    "front_left": (0.705, 0.53), "front_right": (0.705, -0.53),
    "middle_left": (0.0, 0.53), "middle_right": (0.0, -0.53),
    "rear_left": (-0.705, 0.53), "rear_right": (-0.705, -0.53),
}  # fmt: skip
STEERED = ("front_left", "front_right", "rear_left", "rear_right")
ROLLING_RADIUS = 0.131
SLIP = 0.19
"""Part of the wheels' travel that loose level ground does not give back [-]."""

# Control
SPEED, TURN_RATE = 0.08, 0.10
"""[m/s], [rad/s]"""
ACCELERATION = 0.1
"""Change of a wheel's rim speed [m/s^2]."""
STEER_RATE, STEER_READY = 0.3, 0.05
"""Rate of the steering [rad/s], and the error within which the wheels may roll [rad]."""
REACHED_M, REACHED_RAD, ALIGNED_RAD = 0.05, 0.05, 0.1
MAX_CURVATURE = 0.7
CMD_VEL_LIFE_S = 0.5

# The contract
PERIOD = 20_000_000
INPUTS = {
    "joint_states": (JointState, 1, 0),
    "imu/data": (Imu, 1, 0),
    "sun_direction": (Vector3Stamped, 50, 0),  # it steers by its gyro alone
    "power/switches": (DiagnosticArray, 5, 0),
    "battery_state": (BatteryState, 50, 0),  # it forecasts nothing
    "hazcam/points": (PointCloud2, 50, 0),
    "operator/tick": (Header, 5, 5),
}
"""Type, periods between two, and periods that the message lags."""
GOALS = {"goal_pose": PoseStamped, "waypoints": Path, "cmd_vel": TwistStamped, "drive/question": Path}
OUTPUTS = {
    "odom": (Odometry, {"recorder"}),
    "drive/status": (DiagnosticArray, {"operator", "recorder"}),
    "plan": (Path, {"recorder"}),
    "local_costmap/costmap": (OccupancyGrid, {"recorder"}),  # it maps nothing
    "drive_command": (JointState, {"plant", "recorder"}),
    "diagnostics": (DiagnosticArray, {"plant", "recorder"}),
}
"""Type, and the roles that listen."""
FRAMES = ("map", "odom", "base_link")


def wrapped(angle: float) -> float:
    """The angle in -pi..pi."""
    return math.remainder(angle, 2.0 * math.pi)


def yaw_of(q: Any) -> float:
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def stamp_of(message: Any) -> int:
    header = message if isinstance(message, Header) else message.header
    return Time.from_msg(header.stamp).nanoseconds


def status(name: str, stamp: int, values: dict[str, str]) -> DiagnosticArray:
    pairs = [KeyValue(key=key, value=value) for key, value in values.items()]
    message = DiagnosticArray(status=[DiagnosticStatus(name=name, message=values["state"], values=pairs)])
    message.header.stamp = Time(nanoseconds=stamp).to_msg()
    return message


def pose_at(header: Header, x: float, y: float) -> PoseStamped:
    message = PoseStamped(header=header)
    message.pose.position.x, message.pose.position.y = x, y
    return message


@dataclass
class Goal:
    """A place to drive to in odom, with a heading or without."""

    stamp: int
    points: list[tuple[float, float]]
    yaw: float | None


@dataclass
class Controller:
    """Goal follower, steering and odometry; knows no ROS."""

    x: float
    y: float
    yaw: float
    state: str = "idle"
    reason: str = ""
    goal: Goal | None = None
    goal_stamp: int = 0
    twist: tuple[int, float, float, float] = (-(10**18), 0.0, 0.0, 0.0)
    """Stamp [ns], v_x, v_y [m/s] and yaw rate [rad/s] of the last /cmd_vel."""
    steer: dict[str, float] = field(default_factory=lambda: dict.fromkeys(STEERED, 0.0))
    rates: dict[str, float] = field(default_factory=lambda: dict.fromkeys(WHEELS, 0.0))
    velocity: tuple[float, float] = (0.0, 0.0)

    def measure(self, angles: dict[str, float], rates: dict[str, float], yaw_rate: float, dt: float) -> None:
        """Dead reckoning: how far the wheels have rolled along their headings, and how far the gyro has turned."""
        forward = sum(
            rates[name] * math.cos(angles.get(name, 0.0)) + 0.0 for name in WHEELS
        ) * ROLLING_RADIUS / len(WHEELS)  # fmt: skip
        speed = forward * (1.0 - SLIP)
        middle = self.yaw + 0.5 * yaw_rate * dt
        self.x += speed * math.cos(middle) * dt
        self.y += speed * math.sin(middle) * dt
        self.yaw = wrapped(self.yaw + yaw_rate * dt)
        self.velocity = (speed, yaw_rate)

    def way(self) -> list[tuple[float, float]]:
        """Points from here to the goal."""
        return [] if self.goal is None else [(self.x, self.y), *self.goal.points]

    def distance_to_go(self) -> float:
        return sum(map(math.dist, self.way(), self.way()[1:]))

    def wanted_twist(self, stamp: int) -> tuple[float, float, float]:
        """v_x, v_y, yaw rate that the operator or the goal asks for."""
        sent, *twist = self.twist
        if stamp - sent <= CMD_VEL_LIFE_S * 1e9:
            return twist[0], twist[1], twist[2]
        if self.goal is None:
            return 0.0, 0.0, 0.0
        while self.goal.points and math.dist((self.x, self.y), self.goal.points[0]) < REACHED_M:
            self.goal.points.pop(0)
        if not self.goal.points:
            off = 0.0 if self.goal.yaw is None else wrapped(self.goal.yaw - self.yaw)
            if abs(off) < REACHED_RAD:
                self.goal, self.state = None, "reached"
                return 0.0, 0.0, 0.0
            return 0.0, 0.0, math.copysign(TURN_RATE, off)
        x, y = self.goal.points[0]
        distance = math.dist((self.x, self.y), (x, y))
        bearing = wrapped(math.atan2(y - self.y, x - self.x) - self.yaw)
        curvature = 2.0 * math.sin(bearing) / distance
        turning = self.velocity[0] < 0.01
        if abs(bearing) > (ALIGNED_RAD if turning else 0.6) or abs(curvature) > MAX_CURVATURE:
            return 0.0, 0.0, math.copysign(min(TURN_RATE, 0.02 + abs(bearing)), bearing)
        speed = min(SPEED, 0.02 + 0.5 * distance)
        return speed, 0.0, speed * curvature

    def command(self, twist: tuple[float, float, float], angles: dict[str, float], dt: float) -> None:
        """Steer all wheels about the twist's centre; they roll once the steering is there."""
        dt = min(dt, PERIOD * 1e-9)  # after a silence the joints would leap after what was not said meanwhile
        v_x, v_y, w = twist
        wanted = moves = math.hypot(v_x, v_y) + abs(w) > 1e-6
        rims = {}
        for name, (x, y) in WHEELS.items():
            along, across = v_x - w * y, v_y + w * x
            angle, speed = math.atan2(across, along), math.hypot(along, across)
            if abs(angle) > 0.5 * math.pi:  # backwards is nearer
                angle, speed = wrapped(angle + math.pi), -speed
            if name not in STEERED:
                rims[name] = along
                continue
            rims[name] = speed
            if wanted:
                turn = max(-STEER_RATE * dt, min(STEER_RATE * dt, angle - self.steer[name]))
                self.steer[name] += turn
                ready = abs(angle - self.steer[name]) + abs(self.steer[name] - angles[name]) < STEER_READY
                moves = moves and (ready or abs(self.rates[name]) > 0.05)
        for name in WHEELS:
            rate = rims[name] / (ROLLING_RADIUS * (1.0 - SLIP)) if moves else 0.0
            step = ACCELERATION / ROLLING_RADIUS * dt
            self.rates[name] += max(-step, min(step, rate - self.rates[name]))


class FlightDrive(Node):
    """The role `drive` of the contract."""

    def __init__(self, start: tuple[float, float, float], resumable: bool = False) -> None:
        super().__init__("drive", enable_rosout=False)
        self.lockstep: bool = self.declare_parameter("lockstep", True).value
        self.participants = set(self.declare_parameter("participants", [""]).value)
        self.drive = Controller(*start)
        self.inbox: dict[str, dict[int, Any]] = {name: {} for name in INPUTS}
        self.latest: dict[str, Any] = {}
        self.goals: list[tuple[int, str, Any]] = []
        self.received = dict.fromkeys(GOALS, 0)
        self.published: dict[str, int] = {}
        self.period, self.last_stamp = 1, 0
        self.power = 1.0
        self.senders = {name: self.create_publisher(kind, name, 10) for name, (kind, _) in OUTPUTS.items()}
        self.readers = {
            name: self.create_subscription(kind, name, lambda message, name=name: self.receive(name, message), 10)
            for name, (kind, _, _) in INPUTS.items()
        }
        self.goal_readers = [
            self.create_subscription(kind, name, lambda message, name=name: self.receive_goal(name, message), 10)
            for name, kind in GOALS.items()
        ]
        self.readiness = self.create_timer(0.1, self.say_ready)
        self.resumed_at: int = self.declare_parameter("resumed_at", 0).value if resumable else 0
        self.resumed = not self.resumed_at
        if resumable:
            self.handing_over = self.create_publisher(DiagnosticArray, "checkpoint/state", 10)
            self.handed_back = self.create_subscription(DiagnosticArray, "checkpoint/state", self.go_on, 10)
            self.asking = self.create_subscription(Header, "checkpoint/take", self.hand_over, 10)

    # Before the run

    def say_ready(self) -> None:
        if self.last_stamp > self.resumed_at:
            self.readiness.cancel()
            return
        heard = all(
            self.senders[name].get_subscription_count() >= len(roles & self.participants)
            for name, (_, roles) in OUTPUTS.items()
        )
        wanted = [name for name in INPUTS if name != "operator/tick" or "operator" in self.participants]
        fed = all(self.readers[name].get_publisher_count() for name in wanted)
        state = "ready" if heard and fed and self.resumed else "waiting for other nodes"
        resumed = {"resumed": str(self.resumed_at)} if self.resumed_at and self.resumed else {}
        self.senders["diagnostics"].publish(status("drive", 0, {"state": state} | resumed))

    # Checkpoints

    def hand_over(self, asked: Header) -> None:
        if asked.frame_id == "operator":
            return
        stamp = stamp_of(asked)
        lagging = [name for name, (_, every, lag) in INPUTS.items() if lag and stamp // PERIOD % every == 0]
        here = all(stamp in self.inbox[name] for name in lagging if name != "operator/tick" or self.has_operator())
        if self.last_stamp < stamp or not here or not self.goals_are_in(asked):
            later = self.create_timer(0.01, lambda: (later.cancel(), self.hand_over(asked)))
            return
        text = json.dumps({
            "drive": asdict(self.drive),
            "inbox": {name: {at: _text(one) for at, one in kept.items()} for name, kept in self.inbox.items()},
            "goals": [(at, name, _text(message)) for at, name, message in self.goals],
            "received": self.received, "published": self.published, "period": self.period, "power": self.power,
        })  # fmt: skip
        counts = {f"published /{name}": str(count) for name, count in self.published.items()}
        values = {"state": "checkpoint", "part": "1", "of": "1", "data": text} | counts
        self.handing_over.publish(status("drive", stamp, values))

    def go_on(self, message: DiagnosticArray) -> None:
        values = {pair.key: pair.value for pair in message.status[0].values}
        if self.resumed or message.status[0].name != "drive" or stamp_of(message) != self.resumed_at:
            return
        told = json.loads(values["data"])
        drive = told["drive"]
        goal = Goal(**drive["goal"]) if drive["goal"] else None
        self.drive = Controller(**drive | {"goal": goal, "twist": tuple(drive["twist"])})
        for name, kept in told["inbox"].items():
            self.inbox[name] = {int(at): deserialize_message(_bytes(one), INPUTS[name][0]) for at, one in kept.items()}
        self.goals = [(at, name, deserialize_message(_bytes(one), GOALS[name])) for at, name, one in told["goals"]]
        self.received, self.published = told["received"], told["published"]
        self.period, self.power, self.last_stamp = told["period"], told["power"], self.resumed_at
        self.resumed = True

    def has_operator(self) -> bool:
        return "operator" in self.participants

    # What comes in

    def receive_goal(self, name: str, message: Any) -> None:
        self.received[name] += 1
        self.goals.append((max(stamp_of(message), self.last_stamp), name, message))
        self.advance()

    def receive(self, name: str, message: Any) -> None:
        stamp = stamp_of(message)
        if self.lockstep:
            self.inbox[name][stamp] = message
            self.advance()
            return
        self.latest[name] = message
        if name == "joint_states" and stamp > self.last_stamp and "imu/data" in self.latest:
            self.act(stamp, self.latest)

    def due(self) -> dict[str, int]:
        """Stamp of each message that this period needs."""
        return {
            name: (self.period - lag) * PERIOD
            for name, (_, every, lag) in INPUTS.items()
            if self.period % every == 0 and self.period > lag
            and (name != "operator/tick" or "operator" in self.participants)
        }  # fmt: skip

    def advance(self) -> None:
        while self.lockstep and all(stamp in self.inbox[name] for name, stamp in self.due().items()):
            due = self.due()
            if "operator/tick" in due and not self.goals_are_in(self.inbox["operator/tick"][due["operator/tick"]]):
                return
            inputs = {name: self.inbox[name].pop(stamp) for name, stamp in due.items()}
            self.act(self.period * PERIOD, inputs)
            self.period += 1

    def goals_are_in(self, tick: Header) -> bool:
        announced = dict(part.split("=") for part in tick.frame_id.split(";") if "=" in part)
        return all(self.received[name] >= int(announced.get(f"/{name}", 0)) for name in GOALS)

    # What a period consists of

    def act(self, stamp: int, inputs: dict[str, Any]) -> None:
        dt = min((stamp - self.last_stamp) * 1e-9, 0.5) if self.last_stamp else 0.02
        before, self.last_stamp = self.last_stamp, stamp
        for entry in sorted((goal for goal in self.goals if goal[0] <= stamp), key=lambda goal: goal[0]):
            self.goals.remove(entry)
            self.take_goal(*entry)
        if "power/switches" in inputs:
            values = {pair.key: pair.value for pair in inputs["power/switches"].status[0].values}
            words = [values.get(load, "on") for load in ("drive", "steer")]
            self.power = min({"on": 1.0, "off": 0.0}.get(word, 0.0) if not _is_number(word) else float(word)
                             for word in words)  # fmt: skip
        joints = inputs["joint_states"]
        angle = dict(zip(joints.name, joints.position, strict=True))
        rate = dict(zip(joints.name, joints.velocity, strict=True))
        angles = {name: angle[f"steer_{name}_joint"] for name in STEERED}
        rates = {name: rate[f"wheel_{name}_joint"] for name in WHEELS}
        self.drive.measure(angles, rates, inputs["imu/data"].angular_velocity.z, dt)
        v_x, v_y, w = self.drive.wanted_twist(stamp)
        self.drive.command((v_x * self.power, v_y * self.power, w * self.power), angles, dt)
        self.answer(stamp, before)

    def take_goal(self, stamp: int, name: str, message: Any) -> None:
        drive = self.drive
        if name == "drive/question":  # it foresees nothing
            return
        if name == "cmd_vel":
            linear, angular = message.twist.linear, message.twist.angular
            if all(map(math.isfinite, (linear.x, linear.y, angular.z))):
                drive.twist = (stamp, linear.x, linear.y, angular.z)
                if drive.goal is not None:
                    drive.goal, drive.state, drive.reason = None, "stopped", "/cmd_vel took precedence"
            return
        drive.goal_stamp = stamp_of(message) or stamp
        frame = message.header.frame_id
        poses = [message.pose] if name == "goal_pose" else [pose.pose for pose in message.poses]
        numbers = [value for pose in poses for value in (pose.position.x, pose.position.y)]
        if frame not in FRAMES or not poses or not all(map(math.isfinite, numbers)):
            drive.goal, drive.state = None, "refused"
            drive.reason = f"frame {frame!r}, {len(poses)} points: allowed are finite points in {', '.join(FRAMES)}"
            return
        x0, y0, turn = (drive.x, drive.y, drive.yaw) if frame == "base_link" else (0.0, 0.0, 0.0)
        cos, sin = math.cos(turn), math.sin(turn)
        points = [
            (x0 + cos * pose.position.x - sin * pose.position.y, y0 + sin * pose.position.x + cos * pose.position.y)
            for pose in poses
        ]
        last = poses[-1].orientation
        has_yaw = any((last.x, last.y, last.z, last.w))
        drive.goal = Goal(stamp, points, wrapped(turn + yaw_of(last)) if has_yaw else None)
        drive.state, drive.reason = "moving", ""

    def answer(self, stamp: int, before: int) -> None:
        drive, header = self.drive, Header(stamp=Time(nanoseconds=stamp).to_msg())
        names = [f"wheel_{name}_joint" for name in WHEELS] + [f"steer_{name}_joint" for name in STEERED]
        command = JointState(header=header, name=names)
        command.position = array("d", [0.0] * len(WHEELS) + [drive.steer[name] for name in STEERED])
        command.velocity = array("d", [drive.rates[name] for name in WHEELS] + [0.0] * len(STEERED))
        self.publish("drive_command", command)
        odometry = Odometry(header=Header(stamp=header.stamp, frame_id="odom"), child_frame_id="base_link")
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = drive.x, drive.y
        odometry.pose.pose.orientation.z = math.sin(0.5 * drive.yaw)
        odometry.pose.pose.orientation.w = math.cos(0.5 * drive.yaw)
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = drive.velocity
        self.publish("odom", odometry)
        second = 10**9
        if stamp // second == before // second:
            return
        values = {"state": drive.state, "goal_stamp": str(drive.goal_stamp), "reason": drive.reason}
        values["distance_to_go"] = f"{drive.distance_to_go():.3f}"
        self.publish("drive/status", status("drive", stamp, values))
        odom = Header(stamp=header.stamp, frame_id="odom")
        self.publish("plan", Path(header=odom, poses=[pose_at(odom, *point) for point in drive.way()]))
        self.publish("local_costmap/costmap", OccupancyGrid(header=odom))
        self.published["diagnostics"] = self.published.get("diagnostics", 0) + 1
        self.beat("running", stamp)

    def beat(self, state: str, stamp: int) -> None:
        counts = {f"published /{name}": str(count) for name, count in self.published.items()}
        self.senders["diagnostics"].publish(status("drive", stamp, {"state": state} | counts))

    def publish(self, name: str, message: Any) -> None:
        self.published[name] = self.published.get(name, 0) + 1
        self.senders[name].publish(message)


def _text(message: Any) -> str:
    return base64.b64encode(serialize_message(message)).decode()


def _bytes(text: str) -> bytes:
    return base64.b64decode(text)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--start", type=float, nargs=3, default=(0.0, 0.0, 0.0), metavar=("X", "Y", "YAW"))
    parser.add_argument("--resumable", action="store_true")
    given, ros = parser.parse_known_args()
    rclpy.init(args=[sys.argv[0], *ros], signal_handler_options=SignalHandlerOptions.NO)
    stopped: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _frame: stopped.append(number))
    node = FlightDrive(tuple(given.start), given.resumable)
    while not stopped:
        rclpy.spin_once(node, timeout_sec=0.1)
    node.beat("ended", node.last_stamp)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
