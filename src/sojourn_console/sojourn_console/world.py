"""What does not change while a run is looked at: its machine, its ground, its Sun, its cameras, its topics."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from mcap.records import Attachment, Message

from sojourn_bags.description import Run
from sojourn_bags.errors import BagsError
from sojourn_bags.provenance import is_in_real_time
from sojourn_bags.reading import Bag, bag_file
from sojourn_bags.run_configuration import run_configuration
from sojourn_bags.salvage import Salvage
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_config.site_map import site_map
from sojourn_console.errors import NoWorldError
from sojourn_contract.run_table import rows_of_sensor, table_of
from sojourn_contract.topic_table import TopicTable
from sojourn_flight.planning.global_route import SiteMap
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.sensors.hazcam import HazcamParams
from sojourn_physics.terrain.height_field import HeightField
from sojourn_sensors.kinds.camera import CameraSensorParams


@dataclass(frozen=True)
class CameraMount:
    """A camera of the machine.

    Args:
        name: of the sensor. link: of the URDF, x along its optical axis, z up in the image.
        view: angle from the image's bottom to its top [rad]. aspect: its width over its height.
        topic: of its image; empty for one that sends none.
    """

    name: str
    link: str
    view: float
    aspect: float
    topic: str = ""


@dataclass(frozen=True, eq=False)
class RunFiles:
    """What is attached to the bag of a run, and where that was read.

    Args:
        folder: of the run, as it was named. file: the first of its bag, as it is without links; number: of its inode.
        attachments: by name, as far as they were there.
    """

    folder: Path
    file: Path
    number: int
    attachments: dict[str, bytes]

    def is_file_of(self, other: "RunFiles") -> bool:
        """Whether both have been read from the same file."""
        return (self.file, self.number) == (other.file, other.number)


@dataclass(frozen=True, eq=False)
class World:
    """Of one run.

    Args:
        scenario: as the run loaded it. ground: at the start of the run. table: its topics. sun: where it stands.
        cameras: of the machine. attachments: files that describe the run, as its bag carries them.
        run: from which this was read while it may have been under way, None for a bag that is played or a scenario.
    """

    scenario: LoadedScenario
    ground: HeightField
    table: TopicTable
    sun: SunOver
    cameras: tuple[CameraMount, ...]
    attachments: dict[str, bytes]
    source: str = ""
    """Name or file from which the scenario can be read again; empty where it is gone."""
    run: RunFiles | None = None
    is_in_real_time: bool = False
    """Whether the run is known to be paced by the wall clock."""

    @classmethod
    def of_scenario(cls, scenario: LoadedScenario, source: str = "") -> "World":
        """Of a scenario, which was read from there."""
        table = table_of(scenario)
        attachments = {one.name: one.data for one in Run.of_scenario(scenario).attachments()}
        cameras = tuple(_cameras(scenario, table))
        return cls(scenario, scenario.height_field(), table, scenario.sun_over(), cameras, attachments, source)

    @property
    def supports(self) -> tuple[str, ...]:
        """Names of what meets the ground, as /truth/contacts has them."""
        return tuple(support.name for support in self.scenario.machine.supports)

    @cached_property
    def site(self) -> SiteMap:
        """The ground as operators know it beforehand. Raises InvalidValueError where no route can be planned on it."""
        return site_map(self.scenario, self.ground)

    def sun_direction(self, stamp: int) -> FloatArray:
        """Unit vector to the Sun in map, shape (3,), at a stamp [ns]."""
        return self.sun.direction(stamp * 1e-9)

    def sun_disc(self, stamp: int) -> float:
        """Angular radius of the Sun [rad] at a stamp [ns]."""
        return self.sun.disc(stamp * 1e-9)


def world_named(name: str, overrides: Sequence[str] = ()) -> World:
    """The world of a scenario. Raises ConfigError."""
    return World.of_scenario(load_scenario(name, overrides), name)


def world_of_bag(bag: Bag) -> World:
    """The world of a recorded run. Raises BagsError for a bag that does not say which it is."""
    with run_configuration(bag) as configuration:
        return replace(world_named(configuration.scenario, configuration.overrides), source="")


def world_of_run(run: Path) -> World:
    """The world of a run that may still be under way, from the beginning of its bag. Raises NoWorldError."""
    found = recorded_run(run)
    try:
        bag = Bag(found.file, attachments=dict(found.attachments))
        return replace(world_of_bag(bag), run=found, is_in_real_time=_says_real_time(bag))
    except (BagsError, ConfigError, OSError, json.JSONDecodeError) as error:
        raise NoWorldError(str(error)) from error


def _says_real_time(bag: Bag) -> bool:
    """A bag that was recorded elsewhere need not say so."""
    try:
        return is_in_real_time(bag)
    except BagsError:
        return False


def recorded_run(folder: Path) -> RunFiles:
    """What stands before the first message of the bag of a run, which may be under way. Raises NoWorldError."""
    try:
        file = bag_file(folder).resolve()
        number = file.stat().st_ino
        attachments = dict[str, bytes]()
        for record in Salvage(file).records:
            if isinstance(record, Message):
                break
            if isinstance(record, Attachment):
                attachments[record.name] = record.data
    except (BagsError, OSError) as error:
        raise NoWorldError(str(error)) from error
    return RunFiles(folder, file, number, attachments)


def _cameras(scenario: LoadedScenario, table: TopicTable) -> list[CameraMount]:
    found = []
    for name, params in scenario.sensors.sensors.items():
        if isinstance(params, HazcamParams):
            across, up = (math.radians(angle) for angle in (params.horizontal_view_deg, params.vertical_view_deg))
            found.append(CameraMount(name, params.link, up, math.tan(across / 2) / math.tan(up / 2)))
        elif isinstance(params, CameraSensorParams):
            lens = params.lens
            images = [row.name for row in rows_of_sensor(scenario, table, name) if row.type == "sensor_msgs/Image"]
            view = 2.0 * math.atan(0.5 * lens.rows / lens.focal_length)
            found.append(CameraMount(name, params.link, view, lens.columns / lens.rows, images[0] if images else ""))
    return found
