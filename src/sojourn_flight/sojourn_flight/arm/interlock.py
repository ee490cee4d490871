"""When a rover may drive with its arm: the arm's side of the interlock between arm and drive.

The rover may drive while every joint of the arm is within `tolerance` of one of the driving poses and stands still.
Both are conditions of measured joints: what the arm was told does not count, only where it is.
"""

from pydantic import Field

from sojourn_machine.params import FloatArray, Params


class InterlockParams(Params):
    """Interlock between arm and drive."""

    enabled: bool = Field(
        default=True, description="the drive waits for the arm and the arm for the drive; false: they may move together"
    )
    driving_poses: tuple[str, ...] = Field(
        default=("stow",), description="named poses in which the rover may drive; none: it may drive in any"
    )
    tolerance: float = Field(
        default=0.05, gt=0.0, le=3.2, description="largest distance of a joint from such a pose [rad or m]"
    )
    still_speed: float = Field(
        default=0.03, gt=0.0, le=10.0, description="a measured joint that is slower stands still [rad/s or m/s]"
    )


def why_not_to_drive(
    interlock: InterlockParams,
    poses: dict[str, tuple[float, ...]],
    names: tuple[str, ...],
    positions: FloatArray,
    velocities: FloatArray,
    driving: bool,
) -> str:
    """Why the rover may not drive, in words; empty where it may.

    Args:
        poses: joint positions of each named pose [rad or m]. names: of the n joints.
        positions, velocities: measured (n,) [rad or m], [rad/s or m/s].
        driving: the rover drives already: an arm that shakes in its driving pose does not stop it.
    """
    if not interlock.enabled or not interlock.driving_poses:
        return ""
    measured = positions.tolist()  # plain numbers: every period of the drive asks
    off = {
        pose: [abs(position - there) for position, there in zip(measured, poses[pose], strict=True)]
        for pose in interlock.driving_poses
    }
    nearest = min(off, key=lambda pose: max(off[pose]))
    farthest = max(off[nearest])
    if farthest > interlock.tolerance:
        poses_text = "' or '".join(interlock.driving_poses)
        return (
            f"the arm is out: {names[off[nearest].index(farthest)]} is {farthest:.2f} from '{nearest}' "
            f"(tolerance {interlock.tolerance:.2f}); the rover drives with the arm at '{poses_text}'"
        )
    if driving:
        return ""
    speeds = velocities.tolist()
    fastest = max(speeds, key=abs)
    if abs(fastest) > interlock.still_speed:
        return f"the arm moves: {names[speeds.index(fastest)]} at {fastest:.2f} rad/s (m/s where it slides)"
    return ""
