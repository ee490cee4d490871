"""Every rover of config/machines: its URDF is of uniform solids, it stands level on its wheels, and it drives."""

from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
import pytest

from sojourn_config.machine_reader import machine_config
from sojourn_config.paths import available, urdf_folder
from sojourn_config.scenario import load_scenario
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

ROVERS = [name for name in available("machines") if machine_config(name).stands_on]
FORCE_Z = 8
"""Column of the vertical force in the plant's report of contacts."""
G_MOON = 4902.800e9 / 1737.4e3**2


def numbers(text: str | None) -> np.ndarray:
    return np.array([float(part) for part in (text or "0 0 0").split()])


def solids(link: ElementTree.Element) -> list[tuple[coal.ShapeBase, np.ndarray, np.ndarray]]:
    """Collision primitives with centre and rotation in the link."""
    found = []
    for collision in link.findall("collision"):
        shape, origin = collision.find("geometry")[0], collision.find("origin")
        if shape.tag == "box":
            solid = coal.Box(*numbers(shape.get("size")))
        else:
            solid = coal.Cylinder(float(shape.get("radius")), float(shape.get("length")))
        found.append((solid, numbers(origin.get("xyz")), pin.rpy.rpyToMatrix(numbers(origin.get("rpy")))))
    return found


@pytest.mark.parametrize("rover", ROVERS)
def test_inertias_are_those_of_uniform_solids(rover: str) -> None:
    root = ElementTree.parse(urdf_folder() / machine_config(rover).urdf).getroot()
    for link in root.findall("link"):
        entry = link.find("inertial")
        if entry is None:
            continue
        mass, centre = float(entry.find("mass").get("value")), numbers(entry.find("origin").get("xyz"))
        tensor = {key: float(text) for key, text in entry.find("inertia").attrib.items()}
        own = np.array([[tensor["i" + "".join(sorted(a + b))] for b in "xyz"] for a in "xyz"])
        parts = solids(link)
        volume = sum(solid.computeVolume() for solid, _, _ in parts)
        middle = sum(solid.computeVolume() * place for solid, place, _ in parts) / volume
        wanted = np.zeros((3, 3))
        for solid, place, turn in parts:
            arm = place - middle
            wanted += turn @ solid.computeMomentofInertia() @ turn.T
            wanted += solid.computeVolume() * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        np.testing.assert_allclose(centre, middle, atol=1e-4, err_msg=link.get("name"))
        wanted *= mass / volume
        np.testing.assert_allclose(own, wanted, atol=2e-3 * np.trace(wanted), err_msg=link.get("name"))


@pytest.mark.parametrize("rover", ROVERS)
def test_it_stands_level_on_all_of_its_wheels_and_drives_ahead(rover: str) -> None:
    model, state = build_plant(load_scenario("flat_drive", [f"machine={rover}"]))
    x, y = state.configuration[3:5]
    assert np.degrees(2.0 * np.hypot(x, y)) < 1.0, "tilt"
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.joints[0]
    standing, output = step(model, state, command)
    loads = output.contacts[:, FORCE_Z]
    wheels = len(model.machine.stands_on)
    assert loads.sum() == pytest.approx(model.mass * G_MOON, rel=2e-3)
    assert loads[:wheels].min() > 0.5 * model.mass * G_MOON / wheels
    assert not loads[wheels:].any(), "a pad touches the ground"
    radii = [wheel.shear_radius for wheel in model.machine.rolling]
    scenario = load_scenario("flat_drive", [f"machine={rover}"])
    speed = 0.5 * scenario.drive.limits.max_speed
    command.reference[1, model.reference_rows([wheel.joint for wheel in model.machine.rolling])] = speed / np.array(
        radii
    )
    state = standing
    for _ in range(200):
        state, output = step(model, state, command)
    ahead = state.configuration[0] - standing.configuration[0]
    assert 0.6 * 4.0 * speed < ahead < 1.02 * 4.0 * speed
    assert abs(state.configuration[1] - standing.configuration[1]) < 0.02 * ahead
    assert state.energy.balance_error(standing.energy) < 0.01


@pytest.mark.parametrize(("machine", "word"), [("explorer", "wheel"), ("tracked", "track")])
def test_what_it_stands_on_has_a_word(machine: str, word: str) -> None:
    config = machine_config(machine)
    assert config.support_word == word
    both = config.model_copy(
        update={"wheels": machine_config("skid").wheels, "tracks": machine_config("tracked").tracks}
    )
    assert both.support_word == "support"
