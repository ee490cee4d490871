"""Scenarios: the schema of `config/scenarios/NAME.yaml`, and `load_scenario`, which loads all of a run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field, field_validator

from sojourn_config import machine_reader
from sojourn_config.bundle import Bundle, BundleReader
from sojourn_config.errors import ConfigError, single
from sojourn_config.extends import read_document
from sojourn_config.load import validate
from sojourn_config.overrides import override_document, route_overrides, split_beliefs, split_override
from sojourn_config.paths import resolve
from sojourn_config.scenario_checks import scenario_problems
from sojourn_config.steps import FARTHEST, LONGEST, StepConfig
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.timing import CONTROL_PERIOD_S
from sojourn_machine.tools import ObjectParams
from sojourn_physics.environment.sun import SunParams, sun_direction
from sojourn_physics.plant.params import FaultParams, SimulationParams
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.params import TerrainParams

if TYPE_CHECKING:
    from sojourn_physics.terrain.raster import Raster

HEADS = ("body", "soil", "rock_soil", "arm", "tool", *machine_reader.HEADS)
"""First word of an override that is for another file than the scenario's."""
TRUTH_ALONE = ("battery", "bus")
"""Of these, what a run does to the machine behind the back of its computer, which goes by the files."""


class StartConfig(Params):
    """Where the rover stands at the start; its height and tilt follow from the ground."""

    x: float = Field(default=0.0, ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(default=0.0, ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    yaw: float = Field(default=0.0, ge=-2 * math.pi, le=2 * math.pi, description="heading in map [rad]")


class AcceptanceConfig(Params):
    """How near counts as met, by the truth of the plant."""

    drive_m: float = Field(default=0.3, gt=0.0, le=100.0, description="distance from a drive goal [m]")
    arm_m: float = Field(default=0.005, gt=0.0, le=1.0, description="distance of the tip from its target [m]")


class ScenarioConfig(Params):
    """One scenario."""

    description: str = Field(min_length=1, description="what happens, in one sentence")
    seed: int = Field(ge=0, lt=2**63, description="seed of everything random [-]")
    machine: str = Field(min_length=1, description="name in config/machines")
    tool: str | None = Field(
        default=None, min_length=1, description="name in config/tools, in place of the machine's own tool"
    )
    body: str = Field(min_length=1, description="name in config/bodies")
    terrain: TerrainParams = Field(description="the ground")
    soil: str = Field(min_length=1, description="name in config/soils")
    rock_soil: str = Field(default="rigid_rock", min_length=1, description="name in config/soils")
    start: StartConfig = Field(default_factory=StartConfig, description="where the rover stands")
    sun: SunParams = Field(default_factory=SunParams, description="where the Sun stands at the start")
    battery_soc: float = Field(default=1.0, ge=0.0, le=1.0, description="state of charge at the start [1]")
    duration_limit_s: float = Field(gt=0.0, le=LONGEST, description="simulated time at which a run ends [s]")
    simulation: SimulationParams = Field(default_factory=SimulationParams, description="steps of the plant")
    accept: AcceptanceConfig = Field(default_factory=AcceptanceConfig, description="how near counts as met")
    blind_drive: bool = Field(
        default=False, description="the drive uses no camera: it avoids no obstacle and matches no ground"
    )
    faults: tuple[FaultParams, ...] = Field(default=(), description="motors that fail during the run")
    objects: tuple[ObjectParams, ...] = Field(default=(), description="what lies on the ground and may be picked")
    steps: tuple[StepConfig, ...] = Field(default=(), description="what the operator sends, in order")

    @field_validator("simulation")
    @classmethod
    def _on_the_grid_of_stamps(cls, simulation: SimulationParams) -> SimulationParams:
        if simulation.control_period != CONTROL_PERIOD_S:
            allowed = f"{CONTROL_PERIOD_S:g}: the stamps of all messages lie on its grid"
            raise InvalidValueError("control_period", simulation.control_period, allowed)
        return simulation


@dataclass(frozen=True, slots=True, eq=False)
class LoadedScenario(Bundle):
    """A scenario with everything that it names, validated together. See Bundle for what comes from the machine.

    Args:
        name: name of the scenario, or its file without suffix.
        config: the scenario itself.
        overrides: the KEY=VALUE texts that went over the files.
        raster: what was read from the file of the terrain, if it has one.
        digests: SHA-256 of the data files that were read (elevation model, soil raster), by name.
        belief: what the machine's own computer goes by, where that is not the truth.
    """

    name: str
    config: ScenarioConfig
    overrides: tuple[str, ...]
    raster: "Raster | None" = None
    digests: dict[str, str] = field(default_factory=dict)
    belief: Bundle | None = None

    def as_believed(self) -> "LoadedScenario":
        """The scenario as the roles that would fly know it."""
        return self if self.belief is None else replace(self, **self.belief.fields(), belief=None)

    @property
    def terrain(self) -> TerrainParams:
        """Parameters of the ground."""
        return self.config.terrain

    @property
    def simulation(self) -> SimulationParams:
        """Steps of the plant."""
        return self.config.simulation

    @property
    def soil_names(self) -> tuple[str, str]:
        """Names of the default soil and of the soil of rocks."""
        return self.soil.name, self.rock_soil.name

    def sun_direction(self, time: float) -> FloatArray:
        """Unit vector to the Sun in map, shape (3,), `time` [s] after the start of the run."""
        return sun_direction(self.config.sun, self.body.solar_day, time)

    def height_field(self) -> HeightField:
        """Make the ground, from the scenario's seed.

        Raises:
            ConfigError: the ground cannot be made with these parameters.
        """
        # here and not above: it loads scipy, which most nodes do not need, and each of them starts so much sooner
        from sojourn_physics.terrain.generate import generate

        try:
            return generate(self.terrain, *self.soil_names, self.config.seed, self.raster)
        except MachineError as error:
            raise single(next(iter(self.files)), "terrain", self.terrain.kind, str(error)) from error


def load_scenario(name: str, overrides: Sequence[str] = ()) -> LoadedScenario:
    """Load a scenario and everything that it names.

    Args:
        name: name in `config/scenarios`, or the path of a file.
        overrides: `KEY=VALUE` texts. A first word of HEADS means the file that scenario or machine name:
            `soil.k_c=1400`, `machine.drives[0].gear.ratio=500`; all others to the scenario: `battery_soc=0.5`.
            What begins with `belief.` is what the machine's own computer takes for true, and nothing else:
            `belief.battery.capacity_ah=20`; heads of TRUTH_ALONE are what it does not know of.

    Raises:
        ConfigError: with every problem of every file in it.
    """
    path = resolve("scenarios", name, ("command line", "scenario"))
    told, beliefs = split_beliefs(overrides, HEADS)
    own, routed = route_overrides(told, HEADS)
    document = override_document(read_document(path, "scenarios"), own)
    config = validate(document, ScenarioConfig)
    reader = BundleReader(document, path, routed)
    soils = config.soil, config.rock_soil, config.terrain.extra_soils
    bundle = reader.read(config.machine, config.body, *soils, config.tool)
    problems = [*reader.problems, *scenario_problems(config, bundle, document)]
    belief = None
    if not problems and (beliefs or any(routed[head] for head in TRUTH_ALONE)):
        known = [text for text in told if split_override(text)[0][0] not in TRUTH_ALONE]
        reader = BundleReader(document, path, route_overrides([*known, *beliefs], HEADS)[1])
        belief = reader.read(config.machine, config.body, *soils, config.tool)
        problems += reader.problems
    raster, digests = None, {}
    if config.terrain.file is not None:
        from sojourn_config.raster_file import RasterReader  # both load scipy, and this one GDAL
        from sojourn_config.recorded_raster import recorded_raster

        raster = recorded_raster()
        rasters = RasterReader(document, path.parent, config.terrain, config.terrain.file)
        try:
            raster, digests = raster or rasters.read(), rasters.digests
        except ConfigError as error:
            problems += error.problems
    if problems or bundle is None:
        raise ConfigError(problems)
    if config.blind_drive:
        bundle, belief = _blind(bundle), belief and _blind(belief)
    return LoadedScenario(
        **bundle.fields(),
        belief=belief,
        name=Path(name).stem,
        config=config,
        overrides=tuple(overrides),
        raster=raster,
        digests=digests,
    )


def _blind(bundle: Bundle) -> Bundle:
    """The same, its drive without the camera."""
    if bundle.driving is None:
        return bundle
    blind = bundle.drive.model_copy(update={"obstacles": None, "terrain_match": None})
    return replace(bundle, driving=blind)
