"""Bench of the commands: how long it takes in real time from a /cmd_vel to the /drive_command that obeys it.

All nodes run as processes, the recorder among them. The rover drives straight ahead, and this process changes its
speed a little, again and again, at moments spread evenly over the control period. The first /drive_command whose
rates go another way than the last one's is the answer; the time is that from before publishing to the callback here,
with both ways through the middleware. The drive acts once a period of 20 ms, on the measurements of that period, as
it does in lock-step: so a command waits for 10 ms on average and for 20 ms at most, and the rest is computing and
the middleware.
"""

import os
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from sensor_msgs.msg import JointState

from sojourn_config.command_errors import CommandError
from sojourn_config.ros_environment import ros_variables
from sojourn_contract import qos
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_contract.topics import topic
from sojourn_studies.probed_stack import ProbedStack

SCENARIO = "flat_drive"
SPEEDS = (0.050, 0.056)
"""Between them the wheels take three periods [m/s]."""
SPACING_S = 0.1
CHANGE = 0.004
"""Change of a wheel's rate within a period that a new speed makes, and noise does not [rad/s]."""
START_S, ANSWER_S = 60.0, 1.0
P99 = "/cmd_vel to /drive_command, 99th percentile [ms]"
TARGETS = {P99: ("<=", 25.0)}


class CommandClock:
    """Sends velocities to a running stack and times the answers. A context manager."""

    def __init__(self, domain: int) -> None:
        self.domain = domain
        self.answers = 0
        """Wheel commands received."""
        self._rate = 0.0
        self._wanted = 0.0
        """Sign of the change that is waited for, 0 for none."""
        self._answered_at: float | None = None

    def __enter__(self) -> "CommandClock":
        os.environ.update(ros_variables(self.domain))
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=self.domain)
        self._node = ClosedNode("command_clock", context=self._context)
        row = topic("/cmd_vel")
        self._sender = self._node.create_publisher(TwistStamped, row.name.lstrip("/"), qos.profile(row, False))
        row = topic("/drive_command")
        self._reader = self._node.create_subscription(
            JointState, row.name.lstrip("/"), self._hear, qos.profile(row, False)
        )
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)
        return self

    def __exit__(self, *_error: object) -> None:
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def spin(self, seconds: float) -> None:
        """Take what comes for so long."""
        end = time.perf_counter() + seconds
        while (left := end - time.perf_counter()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def send(self, speed: float) -> None:
        """One velocity, to take effect at once."""
        message = TwistStamped()
        message.twist.linear.x = speed
        self._sender.publish(message)

    def time(self, before: float, after: float) -> float | None:
        """Seconds from sending a speed [m/s] to the wheel command that obeys it; None if none came in ANSWER_S."""
        self._answered_at, self._wanted = None, float(np.sign(after - before))
        begin = time.perf_counter()
        self.send(after)
        while self._answered_at is None and time.perf_counter() - begin < ANSWER_S:
            self._executor.spin_once(timeout_sec=0.1)
        return None if self._answered_at is None else self._answered_at - begin

    def _hear(self, message: Any) -> None:
        now, rate = time.perf_counter(), max(message.velocity)
        self.answers += 1
        if self._wanted and (rate - self._rate) * self._wanted > CHANGE:
            self._answered_at, self._wanted = now, 0.0
        self._rate = rate


def bench_commands(domain: int, commands: int) -> dict[str, float]:
    """Median, 99th percentile and worst of so many commands, with the load of the machine before."""
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as folder:
        wishes = [SCENARIO, "--realtime", "--set", "steps=[]", "--set", "terrain.size_x=60.0"]
        wishes += ["--set", "duration_limit_s=3000"]
        with ProbedStack(wishes, domain, Path(folder) / "run") as stack, CommandClock(domain) as clock:
            times = _time_all(clock, stack, commands)
    milliseconds = 1e3 * np.array(times)
    return {
        "/cmd_vel to /drive_command, median [ms]": float(np.median(milliseconds)),
        P99: float(np.percentile(milliseconds, 99.0)),
        "/cmd_vel to /drive_command, longest [ms]": float(milliseconds.max()),
        "load of the machine before (2 cores are meant)": load,
    }


def _time_all(clock: CommandClock, stack: ProbedStack, commands: int) -> list[float]:
    end = time.monotonic() + START_S
    while clock.answers < 50:
        clock.spin(0.1)
        if not stack.runs or time.monotonic() > end:
            raise CommandError("the bench of commands: the stack does not run in real time")
    for _ in range(20):  # up to the first speed
        clock.send(SPEEDS[0])
        clock.spin(0.1)
    generator, found, missed = np.random.default_rng(1), [], 0
    for place in range(commands):
        before, after = SPEEDS[place % 2], SPEEDS[(place + 1) % 2]
        clock.spin(SPACING_S + float(generator.uniform(0.0, CONTROL_PERIOD_S)))
        answer = clock.time(before, after)
        if answer is None:
            missed += 1
        else:
            found.append(answer)
    if missed > commands // 100:
        raise CommandError(
            f"the bench of commands: {missed} of {commands} commands were not obeyed within {ANSWER_S} s"
        )
    return found
