"""Terrain matching with a machine's own camera and numbers: no shift along the view.

More points of a look lie on the near side of a node than behind it, so that a surface which is smeared over the radius
of its planes is seen too far ahead: by the cube of that radius, and the more the lower the camera is. Without noise of
the camera that shift is all there is.
"""

import numpy as np

from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.hazcam import hazard_camera_of
from sojourn_flight.hazards.stereo_camera import along_rays
from sojourn_flight.odometry.ground_surface import GroundSurface, surface_through
from sojourn_flight.odometry.key_frames import LEAST_STEEPNESS, LEAST_VARIANCE
from sojourn_flight.odometry.terrain_match import match
from sojourn_flight.odometry.terrain_match_params import TerrainMatchParams
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import hazcam
from sojourn_physics.terrain.height_field import sample_ground

STEP, LOOKS, AWAY = 0.1, 100, 3
"""From look to look [m]; how many; looks from a key frame to the one that is matched with it."""
STANDS = 0.14
"""base_link over the ground [m]."""
MICRO = ["machine=micro", "terrain.keep_clear=[]"]


def looks_of(scenario: LoadedScenario, most: float) -> list[tuple[FloatArray, float]]:
    """Points about base_link which are `most` [m] away, of a machine that goes straight ahead, and its height [m]."""
    params = scenario.sensors.named["hazcam"].model_copy(update={"disparity_noise_px": 0.0})
    camera, ground = hazcam.hazcam_on(params, scenario.urdf_xml), scenario.height_field()
    noise, found = hazcam.initial_state(camera, 1), []
    for number in range(LOOKS):
        height = sample_ground(ground.heights, ground.grid, STEP * number, 0.0)[0] + STANDS
        place = np.array((STEP * number, 0.0, height))
        noise, points = hazcam.step(camera, noise, hazcam.HazcamView(ground), place, np.eye(3))
        near = np.linalg.norm(points - camera.position, axis=1) <= most
        found.append((points[near].astype(float), height))
    return found


def shifts_of(scenario: LoadedScenario, params: TerrainMatchParams) -> FloatArray:
    """By how much each look is seen ahead of where it is [m]."""
    camera = hazard_camera_of(scenario)
    assert camera is not None
    looks = looks_of(scenario, params.range)

    def surface_at(number: int) -> GroundSurface:
        points, variances = [], []
        for behind in range(params.clouds):
            seen, height = looks[number - behind]
            errors = along_rays(camera, seen)
            off = np.abs(errors[:, 2]) + LEAST_STEEPNESS * np.linalg.norm(errors, axis=1)
            points.append(seen + np.array((-behind * STEP, 0.0, height - looks[number][1])))
            variances.append(off**2 + LEAST_VARIANCE)
        reach = params.range + float(np.hypot(*camera.position[:2]))
        return surface_through(np.concatenate(points), np.concatenate(variances), params.cell, params.radius, reach)

    found = []
    for number in range(params.clouds - 1, LOOKS - AWAY):
        seen, height = looks[number + AWAY]
        guess = np.array((AWAY * STEP, 0.0, height - looks[number][1]))
        errors = along_rays(camera, seen)
        matched = match(surface_at(number), seen, errors, guess, params.sharing, (params.tilt_sigma, 1e-3))
        found.append(matched.shift[0])
    return np.array(found)


def test_a_low_camera_sees_its_way_no_longer_than_it_is() -> None:
    scenario = load_scenario("lunar_route", MICRO)
    params = scenario.drive.terrain_match
    assert params is not None
    own = float(np.mean(shifts_of(scenario, params)))
    wide = float(np.mean(shifts_of(scenario, params.model_copy(update={"radius": 0.14, "cell": 0.08}))))
    assert abs(own) < 1.2e-3
    assert wide > 1.6e-3  # with the numbers of a camera that is half as high again
