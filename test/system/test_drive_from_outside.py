"""A kind of drive from a package that is not ours, registered by an entry point: it turns wheels in a run of the whole
stack, whose bag, contract, replay, data sheet and checkpoints know it; nothing of this repository is edited.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml
from outside import Stranger, known_by
from programs import LAYOUTS, PATIENT, PATIENT_BENCH
from verdicts import require_same

from domains import domain_to_keep

ROOT = Path(__file__).resolve().parents[2]
LAW = ROOT / "test" / "physics" / "plant" / "sprung_drive.py"
SPRUNG = {"kind": "sprung_drive", "load": "drive", "stiffness": 200.0, "damping": 8.0, "max_torque": 18.0}

SHORT = ("--set", "steps=[{drive_to: {x: 0.3, y: 0.1}, timeout_s: 60.0}]")


@pytest.fixture(scope="module")
def stranger(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stranger]:
    """The skid rover with his drives on its front wheels, and a direct run of it."""
    base = tmp_path_factory.mktemp("stranger")
    (base / "springs").mkdir()
    (base / "springs" / "__init__.py").write_text("", encoding="utf-8")
    shutil.copy(LAW, base / "springs")
    known_by(base, "springs", "[sojourn.actuators]\nsprung_drive = springs.sprung_drive:SprungDriveParams\n")
    shutil.copytree(ROOT / "config" / "machines" / "skid", base / "sprung")
    (base / "sprung" / "sensors.yaml").unlink()  # they follow from the machine
    machine = yaml.safe_load((base / "sprung" / "machine.yaml").read_text("utf-8"))
    (geared,) = machine["drives"]
    front, rear = geared["joints"][:2], geared["joints"][2:]
    machine["drives"] = [{**SPRUNG, "joints": front}, {**geared, "joints": rear}]
    (base / "sprung" / "machine.yaml").write_text(yaml.safe_dump(machine), encoding="utf-8")
    scenario = yaml.safe_load((ROOT / "config" / "scenarios" / "flat_drive.yaml").read_text("utf-8"))
    one = Stranger(base, base / "springing.yaml")
    text = yaml.safe_dump({**scenario, "machine": str(base / "sprung")})
    one.scenario.write_text(text, encoding="utf-8")
    try:
        assert one.call("start", one.scenario, *PATIENT, "--direct", "--run-dir", base / "run").wait() == 0, (
            one.programs[-1].text
        )
        yield one
    finally:
        one.end()


def test_it_drives_to_its_goal_on_them(stranger: Stranger) -> None:
    said, bag = stranger.programs[0].text, stranger.bag("run")
    assert said.count("reached") == 1 and "not reached" not in said, said
    states = bag["/truth/joint_states"].joints()
    wheel = states.names.index("wheel_front_left_joint")
    assert np.abs(states.velocity[:, wheel]).max() > 0.1
    assert 0.1 < np.abs(states.effort[:, wheel]).max() < 18.1


def test_every_field_is_the_same_in_every_layout(stranger: Stranger) -> None:
    for layout, options in LAYOUTS.items():
        given = (*PATIENT, *SHORT, "--domain", domain_to_keep(), *options, "--run-dir", stranger.base / layout)
        run = stranger.call("start", stranger.scenario, *given)
        assert run.wait() == 0, run.text
    require_same(stranger.bag("direct"), stranger.bag("processes"))
    states = stranger.bag("processes")["/truth/joint_states"].joints()
    assert np.abs(states.effort[:, states.names.index("wheel_front_left_joint")]).max() > 0.1


def test_contract_replay_and_data_sheet_know_them(stranger: Stranger) -> None:
    run, domain, page = stranger.base / "run", domain_to_keep(), stranger.base / "sheet.html"
    for role in ("plant", "sensors", "power"):
        replay = stranger.call("replay", run, "--node", role, "--exact", *PATIENT_BENCH, "--domain", domain)
        assert replay.wait() == 0 and "identical" in replay.text, replay.text
    check = stranger.call("contract_tool", "check", "--bag", run)
    sheet = stranger.call("datasheet", stranger.base / "sprung", "--soil", "lunar_nominal", "--out", page)
    for program in (check, sheet):
        assert program.wait() == 0, program.text
    assert "keeps the contract: no violation" in check.text
    told = page.read_text("utf-8")
    assert "Largest torque, wheel front left" in told and "Stall torque, wheel rear left" in told
    assert "Stall torque, wheel front left" not in told


def test_a_checkpoint_holds_their_state(stranger: Stranger) -> None:
    roles = ("plant", "sensors", "drive", "power", "operator")
    wound = "min(abs(twist) for twist, _ in app.machine.outside) > 1e-4"
    assert stranger.goes_on(roles, "plant", wound) == "it goes on as it was\n"


def test_a_mistake_in_their_file_is_told_with_its_place(stranger: Stranger) -> None:
    tried = stranger.call("start", stranger.scenario, "--set", "machine.drives[0].max_torque=500", "--resolved")
    assert tried.wait() != 0 and "max_torque" in tried.text and "at most 20 N m" in tried.text, tried.text
    unknown = stranger.call("start", stranger.scenario, "--set", "machine.drives[0].kind=sprung_drives", "--resolved")
    assert unknown.wait() != 0 and "sprung_drive" in unknown.text, unknown.text
