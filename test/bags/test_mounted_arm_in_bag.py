"""What a bag carries of a machine whose arm has a URDF of its own."""

from sojourn_bags.description import COMPOSED_NAME, Run
from sojourn_config.scenario import load_scenario
from sojourn_config.urdf import parse_urdf


def test_the_joined_urdf_goes_with_the_run_where_no_file_has_it() -> None:
    arm = Run.of_scenario(load_scenario("cylindrical_course"))
    rover = Run.of_scenario(load_scenario("flat_drive", ["machine=skid"]))
    attached = {each.name: each for each in arm.attachments()}
    names = parse_urdf(attached[COMPOSED_NAME].data.decode(), COMPOSED_NAME).moving_joints
    assert names == arm.arm_joints
    assert COMPOSED_NAME not in {each.name for each in rover.attachments()}
    assert arm.resolved["drive"] is None and rover.resolved["drive"] is not None


def test_joints_that_slide_are_known() -> None:
    assert Run.of_scenario(load_scenario("cylindrical_course")).sliding_joints == {"arm_lift_joint", "arm_boom_joint"}
    assert not Run.of_scenario(load_scenario("flat_drive")).sliding_joints
