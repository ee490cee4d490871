"""A client of the two actions, as front ends of others have one: what it says is read by test_actions.py."""

import sys
import time
from collections.abc import Callable
from typing import Any

import rclpy
from control_msgs.action import FollowJointTrajectory  # type: ignore[import-not-found]
from nav2_msgs.action import NavigateToPose  # type: ignore[import-not-found]
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from trajectory_msgs.msg import JointTrajectoryPoint

LONGEST_S = 600.0
ARM = ("arm_azimuth_joint", "arm_elevation_joint", "arm_elbow_joint", "arm_wrist_joint", "arm_turret_joint")
FAR = 30.0
"""So far [m] that a stack which runs as fast as it can is on its way still when a client that had to wait looks."""
POSTURE = (1.57, 0.1, -2.7, -0.6, -1.5)


class Client:
    def __init__(self) -> None:
        rclpy.init()
        self._node = rclpy.create_node("front_end")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self._node)
        self._drive = ActionClient(self._node, NavigateToPose, "navigate_to_pose")
        self._arm = ActionClient(self._node, FollowJointTrajectory, "arm_controller/follow_joint_trajectory")

    def until(self, is_so: Callable[[], bool]) -> None:
        end = time.monotonic() + LONGEST_S
        while not is_so():
            if time.monotonic() > end:
                sys.exit("nothing came")
            self._executor.spin_once(timeout_sec=0.05)

    def go(self, client: Any, what: str, goal: Any, cancel: bool = False) -> None:
        """Send a goal, and say what becomes of it."""
        told: list[Any] = []
        self.until(client.server_is_ready)
        asked = client.send_goal_async(goal, feedback_callback=lambda message: told.append(message.feedback))
        self.until(asked.done)
        if not asked.result().accepted:
            print(f"{what}: rejected", flush=True)
            return
        print(f"{what}: accepted", flush=True)
        result = asked.result().get_result_async()
        if cancel:
            self.until(lambda: bool(told) or result.done())
            asked.result().cancel_goal_async()
        self.until(result.done)
        status, error = result.result().status, result.result().result.error_code
        print(f"{what}: status {status}, error {error}, fed back {bool(told)}", flush=True)

    def drive(self, what: str, x: float, frame: str = "map", cancel: bool = False) -> None:
        goal = NavigateToPose.Goal()
        goal.pose.header.frame_id, goal.pose.pose.position.x = frame, x
        self.go(self._drive, what, goal, cancel)

    def arm(self, what: str, posture: tuple[float, ...], seconds: int) -> None:
        """The joints in another order than that of the arm."""
        goal = FollowJointTrajectory.Goal()
        goal.trajectory.joint_names = list(reversed(ARM))
        point = JointTrajectoryPoint(positions=list(reversed(posture)))
        point.time_from_start.sec = seconds
        goal.trajectory.points = [point]
        self.go(self._arm, what, goal)


if __name__ == "__main__":
    client = Client()
    client.drive("elsewhere", 1.0, frame="moon")
    client.drive("there", 0.3)
    client.drive("taken back", FAR, cancel=True)
    client.arm("moved", POSTURE, 4)
    client.arm("too far", (9.0, *POSTURE[1:]), 4)
    client.drive("left alone", FAR)
