"""Scenarios: the schema of `config/scenarios/NAME.yaml`, and `load_scenario`, which loads all of a run."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

from pydantic import Field, field_validator

from sojourn_config import machine_reader
from sojourn_config.bundle import Bundle, BundleReader
from sojourn_config.errors import MISSING, ConfigError, Problem, single
from sojourn_config.extends import read_document
from sojourn_config.flight import FlightScenario
from sojourn_config.known_machine import KnownMachine
from sojourn_config.load import validate
from sojourn_config.overrides import override_document, route_overrides, split_beliefs, split_override
from sojourn_config.paths import resolve
from sojourn_config.scenario_checks import scenario_problems
from sojourn_config.scenario_ground import base_height, made_ground, read_raster
from sojourn_config.steps import FARTHEST, LONGEST, StepConfig
from sojourn_config.yaml_file import YamlDocument
from sojourn_flight.hazards.zone_params import KeepOutZone
from sojourn_flight.power_manager.activities import ActivityParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_choice import Fault
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_machine.timing import CONTROL_PERIOD_S
from sojourn_machine.tools import ObjectParams
from sojourn_physics.environment.air.wind import MovingAir, WindParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams
from sojourn_physics.link.params import LinkParams
from sojourn_physics.link.window import Sky
from sojourn_physics.plant.params import LeapParams, SimulationParams
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.orbital_params import OrbitalMapParams
from sojourn_physics.terrain.params import TerrainParams

if TYPE_CHECKING:
    from sojourn_physics.terrain.raster import Raster

Known = TypeVar("Known", bound=KnownMachine)
HEADS = ("body", "soil", "rock_soil", "arm", "tool", *machine_reader.HEADS)
"""First word of an override that is for another file than the scenario's."""
TRUTH_ALONE = machine_reader.POWER_TABLES
"""Of these, what a run does to the machine behind the back of its computer, which goes by the files."""


Speed = Annotated[float, Field(ge=-100.0, le=100.0)]
Rate = Annotated[float, Field(ge=-360.0, le=360.0)]


class StartConfig(Params):
    """Where the rover stands at the start; its height and tilt follow from the ground. A machine that floats is let go
    there, level but for the yaw.
    """

    x: float = Field(default=0.0, ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(default=0.0, ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    yaw: float = Field(default=0.0, ge=-2 * math.pi, le=2 * math.pi, description="heading in map [rad]")
    z: float = Field(default=0.0, ge=-FARTHEST, le=FARTHEST, description="of what floats: outward of map's origin [m]")
    velocity: tuple[Speed, Speed, Speed] = Field(default=(0.0, 0.0, 0.0), description="of what floats, in map [m/s]")
    rates_deg_per_s: tuple[Rate, Rate, Rate] = Field(
        default=(0.0, 0.0, 0.0), description="of what floats, against map about its own axes [degree/s]"
    )


class WaypointConfig(Params):
    """A place to which operators may want to drive."""

    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")


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
    site: SiteParams | None = Field(
        default=None, description="where on the body the origin of map is; none: gravity is the body's mean"
    )
    terrain: TerrainParams = Field(description="the ground")
    orbital_map: OrbitalMapParams = Field(
        default_factory=OrbitalMapParams, description="what operators have of the ground beforehand"
    )
    soil: str = Field(min_length=1, description="name in config/soils")
    rock_soil: str = Field(default="rigid_rock", min_length=1, description="name in config/soils")
    wind: WindParams | None = Field(default=None, description="over the ground, where the body has air; none: calm")
    start: StartConfig = Field(default_factory=StartConfig, description="where the rover stands")
    sun: SunParams = Field(default_factory=SunParams, description="the Sun at the start: its place, or the date")
    battery_soc: float = Field(default=1.0, ge=0.0, le=1.0, description="state of charge at the start [1]")
    duration_limit_s: float = Field(gt=0.0, le=LONGEST, description="simulated time at which a run ends [s]")
    simulation: SimulationParams = Field(default_factory=SimulationParams, description="steps of the plant")
    bag_part_mb: float | None = Field(
        default=None,
        ge=1.0,
        le=1e6,
        description="size of a file after which the bag goes on in the next one; none: 1000 [MB]",
    )
    leaps: LeapParams | None = Field(
        default=None,
        description="the clock leaps while nothing moves and the operator waits; none: it tells every control period",
    )
    link: LinkParams | None = Field(
        default=None, description="between the operator, on Earth then, and the machine; none: he stands beside it"
    )
    accept: AcceptanceConfig = Field(default_factory=AcceptanceConfig, description="how near counts as met")
    blind_drive: bool = Field(
        default=False, description="the drive uses no camera: it avoids no obstacle and matches no ground"
    )
    keep_out: tuple[KeepOutZone, ...] = Field(default=(), description="zones into which the drive must not go")
    waypoints: dict[str, WaypointConfig] = Field(default_factory=dict, description="places with names, for operators")
    faults: tuple[Fault, ...] = Field(default=(), description="what fails during the run, and when")
    objects: tuple[ObjectParams, ...] = Field(default=(), description="what lies on the ground and may be picked")
    steps: tuple[StepConfig, ...] = Field(default=(), description="what the operator sends, in order")
    activities: tuple[ActivityParams, ...] = Field(
        default=(),
        description="what is planned for the hours and days ahead; forecasts of power go by it",
    )

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

    def as_believed(self) -> FlightScenario:
        """The scenario as the roles that would fly know it: that of `load_flight`."""
        return _flight(self.config, self if self.belief is None else self.belief, self.height_field)

    @property
    def fault_roles(self) -> frozenset[str]:
        """Roles to which something happens by the schedule of faults."""
        return frozenset(fault.role for fault in self.config.faults if fault.role)

    @property
    def start(self) -> StartConfig:
        """Where the rover stands at the start."""
        return self.config.start

    @property
    def terrain(self) -> TerrainParams:
        """Parameters of the ground."""
        return self.config.terrain

    @property
    def simulation(self) -> SimulationParams:
        """Steps of the plant."""
        return self.config.simulation

    @property
    def leaps(self) -> LeapParams | None:
        """How the clock of the run leaps; None where it does not."""
        return self.config.leaps

    @property
    def link(self) -> LinkParams | None:
        """What stands between the operator and the machine; None: nothing."""
        return self.config.link

    @property
    def link_sky(self) -> Sky:
        """What is over the site that a link goes by. Raises InvalidValueError where there is none."""
        link = self.config.link
        if link is None:
            raise InvalidValueError("link", None, "a table: without one nothing goes by the sky")
        over = self.sun_over(self.height_field) if self.site is not None and link.windows else None
        return link.sky(self.body, self.site, self.config.sun, over)

    @property
    def soil_names(self) -> tuple[str, str]:
        """Names of the default soil and of the soil of rocks."""
        return self.soil.name, self.rock_soil.name

    def sun_over(self, terrain: Callable[[], HeightField] | None = None) -> SunOver:
        """The Sun over the site. terrain: makes the ground, where it may hide the Sun."""
        return SunOver(self.config.sun, self.body, self.site, terrain)

    @property
    def moving_air(self) -> MovingAir | None:
        """The wind, and the air that it is made of; None in a calm."""
        wind = self.config.wind
        return None if wind is None else MovingAir(wind, self.body.air_at(self.site).density)

    def height_field(self) -> HeightField:
        """Make the ground, from the scenario's seed.

        Raises:
            ConfigError: the ground cannot be made with these parameters.
        """
        return made_ground(self.config, self.soil_names, self.raster, next(iter(self.files)))


def load_scenario(name: str, overrides: Sequence[str] = ()) -> LoadedScenario:
    """Load a scenario and everything that it names: the truth, and what is believed of it.

    Args:
        name: name in `config/scenarios`, or the path of a file.
        overrides: `KEY=VALUE` texts. A first word of HEADS means the file that scenario or machine name, or
            a table in it: `soil.k_c=1400`, `machine.drives[0].gear.ratio=500`, `sources={}`; all others to the
            scenario: `battery_soc=0.5`.
            What begins with `belief.` is what the machine's own computer takes for true, and nothing else:
            `belief.battery.capacity_ah=20`; heads of TRUTH_ALONE are what it does not know of.

    Raises:
        ConfigError: with every problem of every file in it.
    """
    path = resolve("scenarios", name, ("command line", "scenario"))
    told, beliefs = split_beliefs(overrides, HEADS, machine_reader.TABLES)
    own, routed = _routed(told)
    document = override_document(read_document(path, "scenarios"), own)
    config = validate(document, ScenarioConfig)
    reader = BundleReader(document, path, routed)
    soils = config.soil, config.rock_soil, config.terrain.extra_soils
    bundle = reader.read(config.machine, config.body, *soils, config.tool, config.site)
    problems = [*reader.problems, *scenario_problems(config, bundle, document)]
    belief = None
    if not problems and (beliefs or any(routed[head] for head in TRUTH_ALONE)):
        reader = BundleReader(document, path, _routed(_known_overrides(overrides))[1])
        belief = reader.read(config.machine, config.body, *soils, config.tool, config.site)
        problems += [*reader.problems, *_belief_problems(bundle, belief, document)]
    raster: Raster | None = None
    digests: dict[str, str] = {}
    try:
        raster, digests = read_raster(config.terrain, document, path.parent)
    except ConfigError as error:
        problems += error.problems
    if problems or bundle is None:
        raise ConfigError(problems)
    if config.blind_drive:
        bundle, belief = _blind(bundle), belief and _blind(belief)
    bundle, belief = _with_losses(bundle, config), belief and _with_losses(belief, config)
    return LoadedScenario(
        **bundle.fields(),
        belief=belief,
        name=Path(name).stem,
        config=config,
        overrides=tuple(overrides),
        raster=raster,
        digests=digests,
    )


def load_flight(name: str, overrides: Sequence[str] = ()) -> FlightScenario:
    """Load what the roles that would fly know of a scenario: its own file, the machine's and the body's, and no other.

    Args:
        name, overrides: as for `load_scenario`; those that are the truth's alone are left out.

    Raises:
        ConfigError: with every problem of every file that is read.
    """
    path = resolve("scenarios", name, ("command line", "scenario"))
    own, routed = _routed(_known_overrides(overrides))
    document = override_document(read_document(path, "scenarios"), own)
    config = validate(document, ScenarioConfig)
    reader = BundleReader(document, path, routed)
    known = reader.read_known(config.machine, config.body, config.tool, config.site)
    if known is None or reader.problems:
        raise ConfigError(reader.problems)

    def ground() -> HeightField:
        raster, _ = read_raster(config.terrain, document, path.parent)
        return made_ground(config, (config.soil, config.rock_soil), raster, document.file)

    return _flight(config, _with_losses(_blind(known) if config.blind_drive else known, config), ground)


def _routed(overrides: Sequence[str]) -> tuple[list[str], dict[str, list[str]]]:
    """As `route_overrides`. Raises ConfigError: a whole file that the scenario does not name, or a word of no file."""
    words = {*ScenarioConfig.model_fields, *HEADS}
    files = set(HEADS).difference(machine_reader.TABLES, ScenarioConfig.model_fields)
    for text in overrides:
        path, value = split_override(text)
        head = str(path[0])
        if head not in words:
            tables = machine_reader.FILES.get(head, ())
            by_tables = f"a file, known by its tables: allowed is {' or '.join(tables)} in its place"
            allowed = by_tables if tables else f"unknown key: {names_text(head, words)}"
            raise single(f"--set {text}", head, MISSING, allowed)
        if len(path) == 1 and head in files:
            raise single(f"--set {text}", head, value, f"stands for a file of the machine: allowed is {head}.KEY=VALUE")
    return route_overrides(overrides, HEADS, machine_reader.TABLES)


def _known_overrides(overrides: Sequence[str]) -> list[str]:
    """Those that the machine's computer knows of, its beliefs over the truth."""
    told, beliefs = split_beliefs(overrides, HEADS, machine_reader.TABLES)
    return [text for text in told if split_override(text)[0][0] not in TRUTH_ALONE] + beliefs


def _flight(config: ScenarioConfig, known: KnownMachine, ground: Callable[[], HeightField]) -> FlightScenario:
    def start_height() -> float:
        start = config.start
        return start.z if known.driving is None else base_height(ground(), known.mobility().ability, start)

    return FlightScenario(
        **known.known_fields(),
        start=config.start,
        start_height=start_height,
        sun=config.sun,
        activities=config.activities,
        leaps=config.leaps,
        keep_out=config.keep_out,
        link=config.link,
    )


def _belief_problems(bundle: Bundle | None, belief: Bundle | None, document: YamlDocument) -> Iterator[Problem]:
    """Topics and switches go by names: the computer knows which stores and loads there are."""
    if bundle is None or belief is None:
        return
    for thing, true, known in (
        ("stores", list(bundle.power.all_stores), list(belief.power.all_stores)),
        ("loads", [load.name for load in bundle.power.loads], [load.name for load in belief.power.loads]),
    ):
        if true != known:
            allowed = f"differ from what is believed, {', '.join(known)}: allowed are the same names in the same order"
            yield document.problem((thing,), ", ".join(true), allowed)
    for name, params in bundle.sensors.sensors.items():
        believed = belief.sensors.sensors.get(name)
        if believed is not None and params.heard != believed.heard:
            allowed = "is not as it is believed: allowed is one for both, by which they wait for its messages"
            yield document.problem(("sensors", name, "timing"), "rate, latency or losses", allowed)


def _with_losses(bundle: Known, config: ScenarioConfig) -> Known:
    """The same, with the faults of a schedule by which messages are not heard as they were said: those of sensors in
    their tables. Whoever waits for the messages knows of them.
    """
    sensors = bundle.sensors
    for fault in config.faults:
        lost = fault.lost(config.seed)
        if lost is not None:
            sensors = sensors.with_fault(*lost)
    found = tuple(each for fault in config.faults if (each := fault.disturbance(config.seed)) is not None)
    if sensors is bundle.sensors and not found:
        return bundle
    return replace(bundle, sensors=sensors, disturbances=found)


def _blind(bundle: Known) -> Known:
    """The same, its drive without cameras."""
    if bundle.driving is None:
        return bundle
    blind = bundle.drive.model_copy(update={"obstacles": None, "terrain_match": None, "visual_odometry": None})
    return replace(bundle, driving=blind)
