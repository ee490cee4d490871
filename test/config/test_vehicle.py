"""The vehicle of the analysis: what a machine's files tell, with what its analysis.yaml says beside them."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_config.bundle import Bundle, read_machine
from sojourn_config.errors import ConfigError
from sojourn_config.paths import config_folder
from sojourn_config.vehicle import vehicle_of_machine


@pytest.fixture(scope="module")
def plant() -> Bundle:
    return read_machine("lrv", "moon", "lunar_nominal")


@pytest.fixture(scope="module")
def analysis(plant: Bundle) -> VehicleParams:
    return vehicle_of_machine("lrv", plant)


def test_drivetrain_is_that_of_the_plant(plant: Bundle, analysis: VehicleParams) -> None:
    drive = plant.machine.drives[0]
    assert set(drive.joints) == {wheel.joint for wheel in plant.machine.wheels}
    assert drive.motor == analysis.motor
    assert drive.gear == analysis.gear
    assert sum(load.power_w for load in plant.power.loads if load.kind != "commanded") == analysis.house_power
    capacity = plant.power.battery.capacity_ah * plant.power.battery.cells_parallel
    assert capacity * analysis.bus_voltage == pytest.approx(analysis.battery_energy_wh)


def test_axles_wheels_and_springs_are_those_of_the_plant(plant: Bundle, analysis: VehicleParams) -> None:
    (suspension,) = plant.machine.suspensions
    for axle, x in zip(analysis.axles, (1.143, -1.143), strict=True):  # half the published wheelbase
        assert (axle.x, axle.track) == pytest.approx((x, 1.829), abs=1e-6)
        wheels = [wheel for wheel in plant.machine.wheels if wheel.name.startswith(axle.name)]
        places = [plant.urdf.position_in_link(wheel.joint, "base_link") for wheel in wheels]
        assert [place[0] for place in places] == pytest.approx([axle.x] * 2)
        assert abs(places[0][1] - places[1][1]) == pytest.approx(axle.track)
        for wheel in wheels:
            assert (wheel.radius, wheel.width) == (axle.rim_radius, axle.wheel_width)
            assert wheel.contact == axle.contact
            assert plant.urdf.joints[str(wheel.steer_joint)].upper == pytest.approx(axle.max_steer)
            inertia = plant.urdf.inertials[plant.urdf.joints[wheel.joint].child].inertia
            assert inertia[1, 1] == pytest.approx(axle.wheel_inertia)
            hung = [f"{part}_{wheel.name}_link" for part in ("upright", "knuckle", "wheel")]
            assert sum(plant.urdf.inertials[link].mass for link in hung) == pytest.approx(axle.unsprung_mass)
        assert (suspension.stiffness, suspension.damping) == pytest.approx((axle.spring_rate, axle.damping))


def test_masses_and_inertias_are_those_of_the_urdf(plant: Bundle, analysis: VehicleParams) -> None:
    model = pin.buildModelFromXML(plant.urdf_xml, pin.JointModelFreeFlyer())
    data = model.createData()
    pin.ccrba(model, data, pin.neutral(model), np.zeros(model.nv))
    wanted = [analysis.roll_inertia, analysis.pitch_inertia, analysis.yaw_inertia]
    assert np.diag(data.Ig.inertia) == pytest.approx(wanted, rel=1e-3)
    centre = pin.centerOfMass(model, data, pin.neutral(model))
    assert centre[0] == pytest.approx(0.0, abs=1e-6)
    wheel = plant.urdf.position_in_link(plant.machine.wheels[0].joint, "base_link")
    ground = wheel[2] - plant.machine.wheels[0].radius
    assert centre[2] - ground == pytest.approx(analysis.height, rel=1e-3)
    assert sum(inertia.mass for inertia in model.inertias) == pytest.approx(analysis.mass)


def test_the_file_beside_them_goes_over_what_they_tell(plant: Bundle, analysis: VehicleParams) -> None:
    assert (analysis.clearance, analysis.bus_voltage, analysis.controller_efficiency) == (0.36, 36.0, 0.95)
    assert analysis.cruise_speed == 3.0 != plant.drive.limits.max_speed
    front, rear = analysis.axles
    assert front.linkage is not None and rear.linkage is None
    assert front.full_lock == rear.full_lock == (0.872665, 0.383972)
    assert analysis.published and "Boeing" in analysis.citation


def test_a_machine_without_that_file_is_what_its_files_tell() -> None:
    vehicle = vehicle_of_machine("skid", read_machine("skid", "moon", "lunar_nominal"))
    assert (vehicle.name, vehicle.published) == ("skid", ())
    assert vehicle.mass == pytest.approx(60.0)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("  rear:", "  reer:", ["axles.reer", "front, rear", "did you mean rear?"]),
        ("clearance: 0.36", "clearance: -0.36", ["clearance = -0.36", "above 0", "[m]"]),
        ("arm: 0.2,", "arm: 20.0,", ["axles[0].linkage.arm = 20.0", "at most 5"]),
        ("cruise_speed: 3.0", "cruse_speed: 3.0", ["cruse_speed", "did you mean cruise_speed?"]),
    ],
)
def test_a_mistake_in_it_is_refused_with_its_place(
    tmp_path: Path, plant: Bundle, old: str, new: str, words: list[str]
) -> None:
    folder = tmp_path / "lrv"
    folder.mkdir()
    for file in (config_folder() / "machines" / "lrv").glob("*.yaml"):
        text = file.read_text(encoding="utf-8")
        (folder / file.name).write_text(
            text.replace(old, new, 1) if file.stem == "analysis" else text, encoding="utf-8"
        )
    with pytest.raises(ConfigError) as caught:
        vehicle_of_machine(str(folder), plant)
    assert "analysis.yaml:" in str(caught.value)
    for word in words:
        assert word in str(caught.value)
