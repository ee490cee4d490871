"""Messages lost, late and corrupted, nodes restarted and killed: the same without middleware and in many processes."""

from pathlib import Path

from programs import LAYOUTS, PATIENT
from test_same_everywhere import records
from verdicts import require_same

FAULTS = """[
  {kind: message_lost, topic: /imu/data, probability: 0.3, at: 1},
  {kind: message_late, topic: /drive_command, delay: 0.05, at: 2, lasts: 4},
  {kind: message_corrupted, topic: /joint_states, probability: 0.05, at: 1},
  {kind: message_repeated, topic: /goal_pose, at: 0},
  {kind: node_slow, node: power, delay: 0.1, at: 1},
  {kind: node_killed, node: arm, at: 3, lasts: 1},
  {name: lens, kind: sensor, sensor: hazcam, dust: 0.3, at: 1.5},
  {kind: node_restarted, node: sensors, at: 3},
  {kind: node_restarted, node: power, at: 4},
  {kind: node_restarted, node: drive, at: 6}]"""
STEPS = "steps=[{drive_to: {x: 1.0, y: 0.0}, timeout_s: 20.0}]"
LATE = "sensors.sun.timing={latency: 0.1}"
"""What was on its way when the sensors were restarted, others wait for."""
DISTURBED = ("flat_drive", *PATIENT, "--set", f"faults={FAULTS}", "--set", STEPS, "--set", LATE)


def test_disturbances_are_the_same_over_topics(tmp_path: Path) -> None:
    bags = records(tmp_path, {name: ((*DISTURBED, *options), {}) for name, options in LAYOUTS.items()}, 1)
    require_same(bags["direct"], bags["processes"])
    refused = [status for status in bags["direct"].topics["/diagnostics"].data if b"refused" in status]
    assert refused  # corrupted and repeated messages are told
    beats = b"".join(bags["direct"].topics["/diagnostics"].data)
    assert all(f"the {who} restarted".encode() in beats for who in ("sensors were", "power manager was", "arm was"))
    states = b"".join(bags["direct"].topics["/drive/status"].data)
    assert b"goal lost: the drive was restarted" in states
