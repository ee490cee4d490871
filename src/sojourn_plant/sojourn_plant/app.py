"""The plant without ROS: the simulated machine and its ground. Commands in, the truth of the next period out."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

from sojourn_config.scenario import LoadedScenario
from sojourn_config.scenario_checks import faultable
from sojourn_contract import stamps
from sojourn_contract.app import Answer, App, Period
from sojourn_contract.barrier import is_due
from sojourn_contract.events import parse_tick
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.ground import GROUND, ground_cloud
from sojourn_contract.motors import MOTORS
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_types import Topic
from sojourn_machine.evolution import replace
from sojourn_physics.faults.acting import Acting
from sojourn_physics.plant.flight import LONG
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.rest import leap
from sojourn_physics.plant.state import PlantCommand, PlantOutput, PlantState
from sojourn_physics.plant.step import step
from sojourn_physics.terrain import earthwork
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_plant.commands import COMMANDS, Commands, HeldCommands
from sojourn_plant.faults import PlantFaults
from sojourn_plant.leaping import Leaping, LeapState
from sojourn_plant.motor_truth import MotorTruth
from sojourn_plant.pointing import TOPIC as POINTED
from sojourn_plant.pointing import Pointing, Targets
from sojourn_plant.start import build_plant
from sojourn_plant.truth import TruthMessages

TICK = "/operator/tick"
_EVENTS: tuple[tuple[Callable[[PlantState], bool], str], ...] = (
    (lambda machine: machine.rolled_over, "the rover has rolled over"),
    (lambda machine: machine.off_terrain, "the rover has left the terrain"),
    (lambda machine: machine.flight.long, f"the rover has been off the ground for {LONG:g} s"),
    (lambda machine: machine.flight.escaped, "the rover has left the ground faster than gravity can bring it back"),
)


@dataclass(frozen=True, slots=True)
class PlantAppState:
    """What the role remembers."""

    machine: PlantState
    commands: HeldCommands
    told: GroundMemory
    """The ground that has been told of."""
    faults: Acting = ()
    targets: Targets = field(default_factory=dict)
    """Where the joints are to be that an operator points."""
    leaps: LeapState = field(default_factory=LeapState)
    """Where the clock may leap."""


class PlantApp(App[PlantAppState]):
    """Role plant."""

    role = "plant"

    def __init__(self, scenario: LoadedScenario) -> None:
        self.model, self._start = build_plant(scenario)
        self._commands = Commands(self.model)
        self._pointing = Pointing(self.model, scenario.pointed_joints)
        self._faults = PlantFaults(self.model, faultable(scenario, scenario.terrain))
        self._truth = TruthMessages(self.model)
        table = table_of(scenario)
        self._tells_ground = GROUND.name in table
        self._leaping = Leaping(table) if table.longest_leap else None
        self._motors = MotorTruth(self.model) if MOTORS.name in table else None

    def warm_up(self) -> None:
        """Those of digging; the others were loaded while the machine settled."""
        if self.model.tool is not None:
            earthwork.warm_up(self.model.memory, self.model.terrain, self.model.grid)

    def initial_state(self) -> PlantAppState:
        """The machine at rest where the scenario has it start."""
        held = self._commands.holding(self._start.motor_angles)
        return PlantAppState(self._start, held, self.model.untouched_ground)

    def first_messages(self, state: PlantAppState, stamp: int) -> Iterator[tuple[str, Any]]:
        """Truth of the machine as it stands, with which a run begins, at a stamp [ns]."""
        yield from self._ground(stamp, state.told, state.machine)
        if self._motors is not None:
            yield from self._motors.messages(stamp, state.machine, self.model.currents)
        yield from self._truth.first(stamp, state.machine)

    def check(self, row: Topic, message: Any) -> None:
        """Refuse commands that the machine cannot follow."""
        if row.name in COMMANDS:
            self._commands.check(row, message)
        elif row.name == FAULTS_TOPIC:
            self._faults.check(message)
        elif row.name == POINTED:
            self._pointing.check(row, message)

    def step(self, state: PlantAppState, period: Period) -> tuple[PlantAppState, Answer]:
        """Take the commands of this period, step the machine, tell the truth of the next."""
        if _ends(period.inputs):
            return state, Answer(finished=True)
        before, stamp = state.machine, period.stamp
        faults, refusals = self._faults.after(state.faults, period.goals, before)
        commands = self._commands.take(state.commands, period.inputs)
        targets = self._pointing.asked(state.targets, period.goals) if period.goals else state.targets
        if targets:
            self._pointing.moved(targets, *commands.reference[:2])
        model, command = self._faults.on(faults, self._commands.at(commands, stamp))
        machine, output, leaps = self._moved(state, model, command, period)
        new = [text for happened, text in _EVENTS if happened(machine) and not happened(before)]
        passed = machine.tick - before.tick
        following = stamp + passed * stamps.CONTROL_PERIOD_NS
        ground = self._ground(following, state.told, machine)
        motors = [] if self._motors is None else self._motors.messages(following, machine, output.currents)
        messages = chain(ground, motors, self._truth.messages(following, machine, output))
        told = machine.ground if ground else state.told
        asked = replace(state, commands=commands, faults=faults, targets=targets)
        after = replace(asked, machine=machine, told=told, leaps=leaps)
        return after, Answer(messages, refusals, new, landing=following if passed > 1 else 0)

    def _moved(
        self, state: PlantAppState, model: PlantModel, command: PlantCommand, period: Period
    ) -> tuple[PlantState, PlantOutput, LeapState]:
        """The machine after the period, or where the clock leaps after all periods that it passes over.

        Args:
            model: with the faults that are there now.
        """
        before, leaps, leaping = state.machine, state.leaps, self._leaping
        if leaping is None:
            return *step(model, before, command), leaps
        if period.goals:  # a fault has come or gone, or a joint is pointed: rest is to be seen anew
            leaps = LeapState()
        steps = leaping.steps(model, leaps, command, period.stamp, period.inputs)
        if steps:
            machine, output = leap(model, before, leaps.rest, command, steps)
            return machine, output, leaping.after_leap(leaps, command, output)
        machine, output = step(model, before, command)
        return machine, output, leaping.after_step(model, leaps, machine, command, output)

    def _ground(self, stamp: int, told: GroundMemory, machine: PlantState) -> list[tuple[str, Any]]:
        """What is new of the ground, where a sensor looks at it and it is time."""
        if not self._tells_ground or not is_due(GROUND, stamp // stamps.CONTROL_PERIOD_NS):
            return []
        return [(GROUND.name, ground_cloud(stamp, told, machine.ground))]

    def heartbeat_values(self, state: PlantAppState, stamp: int) -> dict[str, str]:
        """Events of the machine, its faults, and lost commands."""
        seconds = state.machine.flight.periods * self.model.simulation.control_period
        flying = {"off the ground for": f"{seconds:.0f} s"} if seconds >= LONG else {}
        return {
            "faults": ", ".join(one.name for one in state.faults),
            "rolled over": str(state.machine.rolled_over).lower(),
            "off the terrain": str(state.machine.off_terrain).lower(),
            "lost commands": ", ".join(state.commands.lost(stamp)),
            **flying,
        }


def _ends(inputs: Mapping[str, Any]) -> bool:
    """Whether the operator's tick ends the run."""
    tick = inputs.get(TICK)
    return tick is not None and parse_tick(tick.frame)[1]
