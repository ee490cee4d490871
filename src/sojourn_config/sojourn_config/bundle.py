"""Everything that a machine on the ground of a body needs, read from its files and checked together."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sojourn_config.carrying_checks import carrying_problems
from sojourn_config.errors import ConfigError
from sojourn_config.known_machine import KnownMachine
from sojourn_config.machine_checks import machine_problems, with_drive_data
from sojourn_config.machine_reader import MachineReader, MachineSets
from sojourn_config.set_reader import ReadSet, Referrer
from sojourn_config.support_checks import ground_problems
from sojourn_config.tool_config import tool_ground_problems, with_tool
from sojourn_config.yaml_file import YamlDocument
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_machine.errors import MachineError
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.soil.params import SoilParams

if TYPE_CHECKING:
    pass


@dataclass(frozen=True, slots=True, eq=False)
class Bundle(KnownMachine):
    """The parameter sets of a run: a machine as it truly is, on its ground. See KnownMachine for what it adds to.

    Args:
        soil, rock_soil: default soil of the ground, and soil of its rocks.
        extra_soils: soils of patches and of the soil raster.
        files: text of every file that was read, by name; the scenario's is first.
        documents: the files of the sets by role, with what they build on and with overrides.
    """

    soil: SoilParams
    rock_soil: SoilParams
    extra_soils: tuple[SoilParams, ...]
    files: dict[str, str]
    documents: Mapping[str, YamlDocument]

    @property
    def soils(self) -> dict[str, SoilParams]:
        """The soils of the ground by name."""
        return {soil.name: soil for soil in (*self.extra_soils, self.rock_soil, self.soil)}

    def fields(self) -> dict[str, Any]:
        """The fields by name, to build a larger bundle from."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(Bundle)}


class BundleReader(MachineReader):
    """Reads the files of a scenario one after the other and collects the problems of all of them.

    Args:
        scenario: what names the files. path: its file, None for a command line.
        overrides: `KEY=VALUE` texts by what they are for.
    """

    def __init__(self, scenario: YamlDocument, path: Path | None, overrides: dict[str, list[str]]) -> None:
        super().__init__(overrides)
        self.files |= scenario.texts
        self._here = Referrer(scenario, path or Path(scenario.file))

    def read(
        self,
        machine: str,
        body: str,
        soil: str,
        rock_soil: str,
        extra_soils: Sequence[str] = (),
        mounted: str | None = None,
        site: SiteParams | None = None,
    ) -> Bundle | None:
        """All that a scenario names, or None with the reasons in `problems`. mounted: another tool. site: of map."""
        here = self._here
        found_body = self.named("bodies", body, "body", BodyParams, here)
        found_soil = self.named("soils", soil, "soil", SoilParams, here)
        found_rock = self.named("soils", rock_soil, "rock_soil", SoilParams, here)
        found_extra = [self.named("soils", name, "terrain", SoilParams, here) for name in extra_soils]
        sets = self.machine(machine, here, mounted)
        extra = [found for found in found_extra if found is not None]
        if found_soil is None or found_rock is None or len(extra) < len(found_extra):
            return None
        known = self._joined(sets, found_body, site, [found_soil, found_rock, *extra])
        if sets is None or found_body is None or known is None:
            return None
        return Bundle(
            **known.known_fields(),
            soil=found_soil.params,
            rock_soil=found_rock.params,
            extra_soils=tuple(found.params for found in extra),
            files=self.files,
            documents={
                "scenario": here.document,
                **sets.documents,
                "body": found_body.document,
                "soil": found_soil.document,
                "rock_soil": found_rock.document,
            },
        )

    def read_known(
        self, machine: str, body: str, mounted: str | None = None, site: SiteParams | None = None
    ) -> KnownMachine | None:
        """The machine and its site without the ground, or None with the reasons in `problems`; see `read`."""
        found_body = self.named("bodies", body, "body", BodyParams, self._here)
        return self._joined(self.machine(machine, self._here, mounted), found_body, site, ())

    def _joined(
        self,
        sets: MachineSets | None,
        body: ReadSet[BodyParams] | None,
        site: SiteParams | None,
        soils: Sequence[ReadSet[SoilParams]],
    ) -> KnownMachine | None:
        """What has been read, if it fits together."""
        if sets is None or body is None:
            return None
        gravity = 0.0 if sets.joined.config.floats else self._gravity(body.params, site)
        self._check(sets, gravity, soils)
        if self.problems:
            return None
        joined = sets.joined
        return KnownMachine(
            machine=joined.config,
            urdf=joined.urdf,
            body=body.params,
            site=site,
            power=joined.power,
            power_manager=PowerManagerParams(
                power=joined.power,
                law=joined.law,
                derated=joined.config.loads_of([support.joint for support in joined.config.rolling]),
                on_thermostats=() if sets.thermal is None else tuple(sets.thermal.heaters),
            ),
            sensors=joined.sensors if sets.tool is None else with_tool(joined.sensors, sets.tool.params),
            arm=joined.arm and with_drive_data(joined.arm, joined.config),
            tool=sets.tool and sets.tool.params.tool,
            driving=sets.drive,
            thermal=sets.thermal,
        )

    def _gravity(self, body: BodyParams, site: SiteParams | None) -> float:
        """At the site [m/s2]; the body's mean one, and a problem more, where the body has none there."""
        try:
            return body.gravity_over(site).gravity
        except MachineError as error:
            self.problems.append(self._here.document.problem(("site",), body.name, str(error)))
        return body.surface_gravity

    def _check(self, sets: MachineSets, gravity: float, soils: Sequence[ReadSet[SoilParams]]) -> None:
        """What does not fit together goes into `problems`. gravity: [m/s2]."""
        tool = sets.tool and sets.tool.params
        for ground in {found.params.name: found for found in soils}.values():
            self.problems += ground_problems(sets.joined.config, ground.params, ground.document)
            self.problems += tool_ground_problems(tool, ground.params, ground.document)
        found = machine_problems(sets)
        self.problems += found or list(carrying_problems(sets.joined, gravity, sets.documents))


def read_machine(machine: str, body: str, soil: str) -> Bundle:
    """A machine on the soil of a body, without a scenario; rocks are of `rigid_rock`.

    Raises:
        ConfigError: with every problem of every file.
    """
    reader = BundleReader(YamlDocument("command line", {}), None, {})
    bundle = reader.read(machine, body, soil, "rigid_rock")
    if bundle is None:
        raise ConfigError(reader.problems)
    return bundle
