"""The rules of the contract that are no row of the table, in words: for the page from which a team writes its node."""

from sojourn_contract.conformance.geometry import UNIT_TOLERANCE
from sojourn_contract.conformance.joints import ANGLE_MARGIN, RATE_FACTOR
from sojourn_contract.conformance.rates import LEAST_MESSAGES, RATE_TOLERANCE, WINDOW_S
from sojourn_contract.events import MAX_AHEAD_S
from sojourn_contract.goal_topics import REFUSAL_TOLD_NS
from sojourn_contract.heartbeat import READY, RUNNING, WAITING_TO_MATCH
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_contract.topic_types import JOINT_SETS
from sojourn_contract.topics import OPERATOR_LAG, RECORDER_LAG
from sojourn_machine.status_keys import GOAL_STATES

_PERIOD = f"{CONTROL_PERIOD_S:g} s"

SECTIONS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "Taking part",
        (
            "A node plays one role. It publishes every topic of its role and subscribes to every topic of its role, "
            "also those that it ignores: the others wait until they are heard.",
            "Topic names are relative in the node, so that a namespace works; in heartbeats they are absolute and "
            "without the namespace. The types are those of ROS 2 Jazzy's common_interfaces; nothing else is needed.",
            "The node gets the ROS parameters scenario (text), lockstep (true or false) and participants (the roles of "
            "the run). It answers nobody who is not among the participants.",
            "SIGINT ends it within five seconds.",
        ),
    ),
    (
        "Before the run",
        (
            "Some times a second it publishes a heartbeat on diagnostics with stamp zero: state is "
            f"{WAITING_TO_MATCH!r} until each of its outputs has as many subscriptions as participants that listen, "
            f"then {READY!r}. Those who listen to a topic stand behind its arrow; to recorded ones also the recorder.",
            "The plant begins when every participant is ready.",
        ),
    ),
    (
        "Lock-step",
        (
            f"The plant owns /clock. A control period is {_PERIOD}; the first one is stamped {_PERIOD}. Stamps are "
            "whole multiples of the period.",
            "A row of rate r is due at each stamp that is a multiple of 1/r. A role acts at each stamp t at which one "
            "of its periodic inputs is due, once all inputs due at t are in.",
            "It then publishes every output that is due at t, stamped t, once, and nothing stamped otherwise. The "
            "plant goes on to the next period when every command stamped t is in.",
            f"Exceptions: the consumer at t waits for the operator's tick of {OPERATOR_LAG} periods before, and the "
            f"plant for the recorder's tick of {RECORDER_LAG} periods before.",
            "A node that does not answer within lockstep_timeout_s (10 s of wall time) stops the run with its name.",
            "An answer depends on the stamped inputs alone: no wall clock, no timer, no seed but the scenario's.",
        ),
    ),
    (
        "Real time",
        (
            "The plant is paced by the wall clock. A node acts on its latest inputs when its fastest input comes, and "
            "copies the stamp of that one.",
            "An input older than its age at most counts as lost. The plant then stops the wheels or holds the arm.",
            f"Rates are judged over windows of {WINDOW_S:g} s or {LEAST_MESSAGES} periods, whichever is longer: within "
            f"{100 * RATE_TOLERANCE:.0f} %. No gap may be longer than the age at most.",
        ),
    ),
    (
        "Heartbeats",
        (
            "On diagnostics, one DiagnosticStatus whose name is the role and whose values are texts.",
            f"At each whole second of simulation time, stamped with it: state = {RUNNING!r}, and for each topic of the "
            "role 'published /topic' = messages sent on it so far, this heartbeat included. The recorder proves from "
            "them that nothing is lost.",
            "Messages that it refused are 'refused /topic' = how many, with the last reason in 'last refusal'.",
        ),
    ),
    (
        "Goals",
        (
            "A goal takes effect at its stamp or when it comes, whichever is later; stamp zero means now. One older "
            f"than its age at most, or more than {MAX_AHEAD_S:.0f} s ahead, is refused.",
            "In lock-step the operator's tick says how many goals have been sent on each topic so far "
            "(frame_id '/goal_pose=1;/cmd_vel=3', 'end' ends the run): a node waits until it has that many.",
            f"/drive/status and /arm/status tell state ({', '.join(GOAL_STATES)}), goal_stamp (of the last goal, in "
            "nanoseconds) and reason (words, may be empty). A goal that is refused while another is under way is told "
            f"for {REFUSAL_TOLD_NS * 1e-9:g} s; then the state is again that of the other one, which goes on.",
        ),
    ),
    (
        "Values",
        (
            "SI and radians; degree Celsius and Ah where the ROS type says so. Every number is finite. Numbers marked "
            "'may be NaN' are NaN where they are not measured. Distances marked 'may be infinite' follow REP 117: "
            "+infinity where nothing is met within the range, -infinity where something is too near to be measured.",
            "Orientations are unit quaternions x y z w, to "
            + f"{UNIT_TOLERANCE:g}. In a goal all zeros leave it free.",
            "Covariances are row-major and symmetric, with no negative variance. An IMU covariance that begins with -1 "
            "is not known.",
            f"A joint's angle stays within the URDF's stops (and {ANGLE_MARGIN:g} rad), its rate within "
            f"{RATE_FACTOR:g} times the URDF's limit.",
            "A field that is the rate of another agrees with its change from message to message, within what the table "
            "says.",
        ),
    ),
    (
        "Joints",
        (
            "A JointState names its joints, in any order, each once. position, velocity and effort have one number for "
            "each name; those marked 'may be empty' may have none.",
            *(f"{name}: {words}." for name, words in JOINT_SETS.items()),
            "A joint that is held by position needs a position, one that is held by rate a velocity. A joint that a "
            "command leaves out stops.",
            "/power/switches: the values' keys are the loads; each is 'on', 'off' or a fraction from 0 to 1.",
        ),
    ),
)
"""Sections of rules: title, and one rule a text."""
