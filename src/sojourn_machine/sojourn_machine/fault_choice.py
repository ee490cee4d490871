"""A fault of a run, as a scenario says it: a kind by its name, with its own words, when it comes, how it should show.

A kind is one module with one class, a `FaultChoice`, registered by an entry point of the group `sojourn.faults`. What
it does is said by the package of the role that acts on it: see `sojourn_physics.faults` for those of the plant.
"""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, NamedTuple, Self, TypeAlias

from pydantic import Field, SerializeAsAny, ValidationError, model_validator

from sojourn_machine.chance import chance, stream_of
from sojourn_machine.choice import kinds_of
from sojourn_machine.disturbance import Disturbance
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_names import FAULTS
from sojourn_machine.machine import MachineParams
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.sensor_choice import SensorParams
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_machine.status_keys import GoalState, keys_meant, topics_meant

LATEST = 1e7
FaultProblem: TypeAlias = tuple[str, object, str]
"""Key of the fault, value, and what is allowed."""


class FaultableMachine(NamedTuple):
    """What of a machine on its ground may have a fault."""

    machine: MachineParams
    travel: Mapping[str, tuple[float, float]]
    """Least and greatest angle of each joint that moves [rad]."""
    efforts: Mapping[str, float]
    """Largest of each joint that moves, as the URDF has it; infinite where it says none [N m or N]."""
    power: PowerParams
    sensors: Mapping[str, SensorParams]
    """By their names."""
    bounds: tuple[float, float, float, float]
    """x_min, x_max, y_min, y_max of the ground in map [m]."""


class TriggerParams(Params):
    """An event that brings a fault. One key is the event, `later` a delay after it."""

    between: tuple[float, float] | None = Field(
        default=None, description="simulated times; when in between the scenario's seed decides [s]"
    )
    after_step: int | None = Field(default=None, ge=1, le=10_000, description="that step is over, 1 is the first [1]")
    distance: float | None = Field(default=None, gt=0.0, le=1e6, description="so far has been driven, in truth [m]")
    drive: GoalState | None = Field(default=None, description="the drive says that it is in this state")
    arm: GoalState | None = Field(default=None, description="the arm says that it is in this state")
    later: float = Field(default=0.0, ge=0.0, le=LATEST, description="after the event [s]")

    @model_validator(mode="after")
    def _is_one_event(self) -> Self:
        events = [name for name in type(self).model_fields if name != "later"]
        given = [name for name in events if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"{' and '.join(given) or 'no event'}: allowed is one of {', '.join(events)}")
        if self.between is not None and not 0.0 <= self.between[0] <= self.between[1] <= LATEST:
            raise ValueError(f"between {self.between}: allowed are two times from 0 to {LATEST:g} s, the first first")
        return self

    @property
    def earliest(self) -> float:
        """Simulated time before which nothing comes of it [s]."""
        return self.later + (0.0 if self.between is None else self.between[0])


class ExpectedDetection(Params):
    """What should show a fault: a text in a field of a status topic, and within which time."""

    topic: str = Field(min_length=1, description="of a status: /drive/status, /arm/status, /power/status")
    field: str = Field(min_length=1, description="key of the status")
    says: str = Field(min_length=1, description="text that stands in it while the fault is recognised, and else not")
    within: float = Field(gt=0.0, le=LATEST, description="after the fault has come [s]")

    @model_validator(mode="after")
    def _is_said_there(self) -> Self:
        """Nobody refuses a status of a role that is not ours; but what nearly is one of ours is a slip of the pen."""
        if topics := topics_meant(self.topic):
            raise ValueError(f"topic {self.topic!r} is no status of ours: did you mean {' or '.join(topics)}?")
        if keys := keys_meant(self.topic, self.field):
            raise ValueError(f"field {self.field!r} is no key of {self.topic}: did you mean {' or '.join(keys)}?")
        return self


class FaultChoice(Params):
    """One fault. Each kind has a subclass with its own words, whose default of `kind` is its name."""

    role: ClassVar[str] = ""
    """That it happens to."""
    target: ClassVar[str] = ""
    """Key of its own that says of what, for its name."""
    heals: ClassVar[bool] = True
    """Whether it can go again."""

    kind: str = Field(description="kind of fault")
    name: str = Field(default="", max_length=100, description="of the fault; left out: its kind and what it is of")
    at: float | None = Field(default=None, ge=0.0, le=LATEST, description="simulated time at which it comes [s]")
    when: TriggerParams | None = Field(default=None, description="the event that brings it, in place of a time")
    until: float | None = Field(default=None, ge=0.0, le=LATEST, description="simulated time at which it goes [s]")
    lasts: float | None = Field(default=None, gt=0.0, le=LATEST, description="time for which it is there [s]")
    expect: ExpectedDetection | None = Field(default=None, description="how it should show; left out: nothing is said")

    @model_validator(mode="after")
    def _check_times(self) -> Self:
        if self.at is not None and self.when is not None:
            raise ValueError("at and when: allowed is one of them")
        if self.until is not None and self.lasts is not None:
            raise ValueError("until and lasts: allowed is one of them")
        first = self.at if self.when is None else self.when.earliest
        if self.until is not None and first is not None and self.until <= first:
            raise ValueError(
                f"until = {self.until:g}: allowed is later than {first:g} s, when it comes at the earliest"
            )
        if not self.heals and (self.until is not None or self.lasts is not None):
            raise ValueError(f"{self.kind} does not go again: allowed is neither until nor lasts")
        return self

    @property
    def called(self) -> str:
        """Its name."""
        of = getattr(self, self.target) if self.target else ""
        return self.name or f"{self.kind} {of}".strip()

    def time(self, seed: int) -> float | None:
        """Simulated time at which it comes [s]; None where an event brings it that nobody can foresee."""
        if self.when is None:
            return self.at
        if self.when.between is None:
            return None
        first, last = self.when.between
        return first + (last - first) * chance(stream_of(seed, self.called), 0, 0) + self.when.later

    def words(self) -> dict[str, Any]:
        """What it is, without when it comes and how it should show: enough to make it anew."""
        return self.model_dump(mode="json", exclude={"at", "when", "until", "lasts", "expect", "name"})

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """What of it does not fit a machine."""
        return ()

    def left_of(self, machine: FaultableMachine) -> FaultableMachine:
        """What of a machine that it fits faults that come besides can have."""
        return machine

    @property
    def in_scenario_alone(self) -> bool:
        """Whether nobody can bring it to a running stack: whoever waits for messages has to know of it."""
        return False

    def disturbance(self, seed: int) -> Disturbance | None:
        """What it does to messages between nodes, None for all others: known from the beginning, see `lost`."""
        return None

    def lost(self, seed: int) -> tuple[str, str, SensorFaultParams] | None:
        """Name of a sensor that loses messages by it, and by which fault of which name: whoever waits for them has to
        know that from the beginning. None for all others.
        """
        return None


Fault: TypeAlias = Annotated[SerializeAsAny[FaultChoice], *kinds_of(FAULTS, "kind")]
"""A field that is a fault of any kind."""


def read_fault_words(words: Mapping[str, object]) -> FaultChoice:
    """A fault of the kind that its words name, as a message has them.

    Raises:
        InvalidValueError: words that the kind does not take, with the first of them. UnknownNameError: no such kind.
    """
    try:
        return FAULTS.get(str(words.get("kind", ""))).model_validate(dict(words))
    except ValidationError as error:
        raise first_problem(error, words) from None


def first_problem(error: ValidationError, given: Mapping[str, object]) -> InvalidValueError:
    """The first of what is refused. given: values by their keys, as they were given."""
    first = error.errors(include_url=False)[0]
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, InvalidValueError):
        return cause
    key = ".".join(str(part) for part in first["loc"]) or "words"
    return InvalidValueError(key, given.get(key, ""), _sentence(first["msg"]))


def _sentence(text: str) -> str:
    """pydantic's words as what is allowed."""
    return "no such word: the kind has none of that name" if text.startswith("Extra inputs") else text


def unknown(key: str, name: str, allowed: Iterable[str], what: str) -> Iterable[FaultProblem]:
    """The problem of a name that is none of those that are allowed. what: what it is not, in words."""
    names = tuple(allowed)
    if name not in names:
        yield key, name, f"{what}: {names_text(name, names)}"
