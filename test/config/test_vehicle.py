"""The lunar roving vehicle of the plant and that of the analysis are one: what both files tell agrees."""

import numpy as np
import pinocchio as pin
import pytest

from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_config.bundle import Bundle, read_machine
from sojourn_config.load import load_params


@pytest.fixture(scope="module")
def plant() -> Bundle:
    return read_machine("lrv", "moon", "lunar_nominal")


@pytest.fixture(scope="module")
def analysis() -> VehicleParams:
    return load_params("vehicles", "lrv", VehicleParams)


def test_drivetrain_is_the_same(plant: Bundle, analysis: VehicleParams) -> None:
    drive = plant.rover.drives[0]
    assert set(drive.joints) == {wheel.joint for wheel in plant.rover.wheels}
    assert drive.motor == analysis.motor
    assert drive.gear == analysis.gear
    assert sum(load.power_w for load in plant.bus.loads if load.kind != "commanded") == analysis.house_power
    capacity = plant.battery.capacity_ah * plant.battery.cells_parallel
    assert capacity * analysis.bus_voltage == pytest.approx(analysis.battery_energy_wh)


def test_axles_wheels_and_springs_are_the_same(plant: Bundle, analysis: VehicleParams) -> None:
    (suspension,) = plant.rover.suspensions
    for axle in analysis.axles:
        wheels = [wheel for wheel in plant.rover.wheels if wheel.name.startswith(axle.name)]
        places = [plant.urdf.position_in_link(wheel.joint, "base_link") for wheel in wheels]
        assert [place[0] for place in places] == pytest.approx([axle.x] * 2)
        assert abs(places[0][1] - places[1][1]) == pytest.approx(axle.track)
        for wheel in wheels:
            assert (wheel.radius, wheel.width) == (axle.rim_radius, axle.wheel_width)
            assert wheel.contact == axle.contact
            assert plant.urdf.joints[str(wheel.steer_joint)].upper == pytest.approx(axle.max_steer)
            inertia = plant.urdf.inertials[plant.urdf.joints[wheel.joint].child].inertia
            assert inertia[1, 1] == pytest.approx(axle.wheel_inertia, rel=1e-3)
            hung = [f"{part}_{wheel.name}_link" for part in ("upright", "knuckle", "wheel")]
            assert sum(plant.urdf.inertials[link].mass for link in hung) == pytest.approx(axle.unsprung_mass)
        assert (suspension.stiffness, suspension.damping) == (axle.spring_rate, axle.damping)


def test_masses_and_inertias_are_the_same(plant: Bundle, analysis: VehicleParams) -> None:
    model = pin.buildModelFromXML(plant.urdf_xml, pin.JointModelFreeFlyer())
    data = model.createData()
    pin.ccrba(model, data, pin.neutral(model), np.zeros(model.nv))
    wanted = [analysis.roll_inertia, analysis.pitch_inertia, analysis.yaw_inertia]
    assert np.diag(data.Ig.inertia) == pytest.approx(wanted, rel=1e-3)
    centre = pin.centerOfMass(model, data, pin.neutral(model))
    assert centre[0] == pytest.approx(0.0, abs=1e-6)
    wheel = plant.urdf.position_in_link(plant.rover.wheels[0].joint, "base_link")
    ground = wheel[2] - plant.rover.wheels[0].radius
    assert centre[2] - ground == pytest.approx(analysis.height, rel=1e-3)
    assert sum(inertia.mass for inertia in model.inertias) == pytest.approx(analysis.mass)
