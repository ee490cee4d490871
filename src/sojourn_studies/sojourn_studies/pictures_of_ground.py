"""Pictures of the manuals: a wheel on three soils, and the ground of the demonstration."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LightSource, ListedColormap
from matplotlib.figure import Figure
from scipy.optimize import brentq

from sojourn_config.load import load_params
from sojourn_config.scenario import LoadedScenario
from sojourn_machine.supports import WheelParams
from sojourn_operator.steps.drive_route import DriveRouteStep
from sojourn_physics.contact.rigid_rim import RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, rim_forces
from sojourn_physics.soil.params import SoilParams, kernel_row
from sojourn_studies.picture_style import BLUE, GREEN, GREY, ORANGE


def wheel(scenario: LoadedScenario) -> Figure:
    """Drawbar pull, torque and sinkage of one wheel against slip, at the load that it carries on the Moon."""
    shape = scenario.machine.wheels[0]
    load = 180.0 * scenario.gravity / 6.0
    slips = np.linspace(-0.2, 0.9, 56)
    figure, axes = plt.subplots(1, 3, figsize=(11.0, 3.5), layout="constrained")
    for name, color in (("lunar_nominal", BLUE), ("jsc_1a", ORANGE), ("dlr_mars", GREEN)):
        soil = kernel_row(load_params("soils", name, SoilParams))
        curves = np.array([at_load(soil, shape, load, slip) for slip in slips]).T
        for axis, values in zip(axes, (curves[0] / load, curves[1], 1000.0 * curves[2]), strict=True):
            axis.plot(slips, values, color=color, linewidth=2.0, label=name)
    titles = ("Drawbar pull over load", "Torque at the wheel", "Sinkage of the rim")
    for axis, title, unit in zip(axes, titles, ("[-]", "[N m]", "[mm]"), strict=True):
        axis.set(title=title, xlabel="slip ratio [-]", ylabel=unit, xlim=(slips[0], slips[-1]))
        axis.axvline(0.0, color=GREY, linewidth=0.8)
    axes[0].axhline(0.0, color=GREY, linewidth=0.8)
    axes[2].set_ylim(bottom=0.0)
    axes[0].legend(title="soil", frameon=False, loc="lower right")
    sizes = [1000.0 * size for size in (shape.radius, shape.width, shape.grouser_height)]
    figure.suptitle(
        "Explorer wheel (radius {:.0f} mm, width {:.0f} mm, grousers {:.0f} mm) ".format(*sizes)
        + f"under {load:.1f} N, a sixth of the rover on the Moon",
        fontsize=10.5,
    )
    return figure


def at_load(soil: np.ndarray, shape: WheelParams, load: float, slip: float) -> tuple[float, float, float]:
    """Drawbar pull [N], torque [N m] and sinkage [m] in steady rolling at a load [N] and slip."""

    def forces(sinkage: float) -> tuple[float, ...]:
        contact = RimContact(sinkage, slip, 0.0, 1.0)
        return rim_forces(shape.radius, shape.shear_radius, shape.width, contact, soil, QUADRATURE)

    sinkage = brentq(lambda z: forces(z)[2] - load, 1e-5, 0.09)
    pull, _, _, torque, *_ = forces(sinkage)
    return pull, torque, sinkage


def terrain(scenario: LoadedScenario) -> Figure:
    """The ground of a scenario, shaded, with its rocks and the route of its operator."""
    ground = scenario.height_field()
    x_min, x_max, y_min, y_max = ground.bounds
    figure, axis = plt.subplots(figsize=(8.0, 5.0), layout="constrained")
    light = LightSource(azdeg=315.0, altdeg=30.0)
    shade = light.hillshade(ground.heights, vert_exag=2.5, dx=ground.resolution, dy=-ground.resolution)
    extent = (x_min, x_max, y_min, y_max)
    axis.imshow(shade, extent=extent, origin="lower", cmap="gray", vmin=0.1, vmax=0.9)
    heights = axis.imshow(ground.heights, extent=extent, origin="lower", cmap="cividis", alpha=0.35)
    rocks = np.ma.masked_where(ground.soil_index == 0, np.ones_like(ground.soil_index))
    axis.imshow(rocks, extent=extent, origin="lower", cmap=ListedColormap(["#5a3a1c"]), interpolation="nearest")
    route = next(step.action for step in scenario.config.steps if isinstance(step.action, DriveRouteStep))
    points = [(scenario.config.start.x, scenario.config.start.y), *route.corners]
    axis.plot(
        *np.array(points).T,
        "o-",
        color="#c1002d",
        markersize=4.5,
        linewidth=1.6,
        label="route of the operator",
    )
    axis.legend(loc="upper right", framealpha=0.9)
    axis.grid(False)
    axis.set(xlabel="x, east [m]", ylabel="y, north [m]", xlim=(-9.0, 19.0), ylim=(-9.0, 9.0))
    axis.set_title(f"Ground of {scenario.name}, seed {scenario.config.seed}: roughness, craters, rocks (brown)")
    figure.colorbar(heights, label="height [m]", shrink=0.8)
    return figure
