"""A node that says that it is ready has its compiled kernels loaded: the first answer comes as soon as the others.

Loading them takes half a second. In real time all messages of that half second were too old or lost.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from node_bench import Bench

PROGRAM = """
import rclpy
from ros_messages import value_of
from numba.core.dispatcher import Dispatcher
from node_bench import JOINTS, at, battery, imu, joints, loads, odometry
from {module} import {name} as Node

rclpy.init(args=[])
node = Node(overrides={{"scenario": "flat_drive"}})
late = []
compile_for = Dispatcher.compile
Dispatcher.compile = lambda self, signature: (late.append(self.__name__), compile_for(self, signature))[1]
inputs = {inputs}
for period in range(1, 6):
    due = {{name: value_of(message) for name, message in inputs(period).items()}}
    node.on_period(at(period), due, [])
    node.publish = lambda *_message: None
print("late:", *sorted(set(late)))
node.destroy_node()
rclpy.try_shutdown()
"""
TRUTH = """lambda p: {"/truth/odom": odometry(p), "/truth/joint_states": joints(p, dict.fromkeys(JOINTS, 0.01 * p)),
    "/truth/motor_states": joints(p),
    "/truth/electrical": battery(p), "/truth/loads": loads(p, imu=12.0)}"""
MEASURED = """lambda p: {"/joint_states": joints(p, dict.fromkeys(JOINTS, 0.01 * p)), "/imu/data": imu(p)}"""
NODES = {
    "sojourn_sensors.node:SensorsNode": TRUTH,
    "sojourn_drive.node:DriveNode": MEASURED,
    "sojourn_arm.node:ArmNode": MEASURED,
    "sojourn_power.node:PowerNode": """lambda p: {"/bus/state": battery(p)}""",
}


@pytest.mark.parametrize("node", NODES)
def test_no_kernel_is_loaded_in_a_period(node: str, bench: Bench) -> None:
    """In a process of its own, on the bench's domain: here other tests have loaded them."""
    here = Path(__file__).parent
    module, _, name = node.partition(":")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (here, here.parent)))}
    program = PROGRAM.format(module=module, name=name, inputs=NODES[node])
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, timeout=1800.0, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "late:"
