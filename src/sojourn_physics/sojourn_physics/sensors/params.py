"""The sensors of a machine as one parameter set: encoders by groups of joints, and any number of others by names."""

from collections.abc import Mapping
from typing import Any, ClassVar, Self, TypeVar

from pydantic import (
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)  # fmt: skip
from pydantic_core import InitErrorDetails, to_json

from sojourn_machine.choice import KindsOf, within
from sojourn_machine.errors import UnknownNameError
from sojourn_machine.params import Params
from sojourn_machine.sensor_choice import ASIDE, SENSORS, SensorParams
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_machine.sensor_timing import SensorTimingParams
from sojourn_physics.sensors.angle_sensor import AngleSensor

JOINTS = "joint_groups"
"""Name and kind of the sensor that all encoders are together."""
JOINTS_ASIDE = tuple(f"joint_{key}" for key in ASIDE)
"""What every sensor has beside its own keys, of the encoders."""
REQUIRED = {"imu": "/imu/data", "bus": "/bus/state"}
"""Topics on which every machine has a sensor, by the kind that comes with us: the flight side cannot do without."""
AnyParams = TypeVar("AnyParams", bound=Params)


class JointGroupParams(Params):
    """Joints with the same angle sensor and the same measurement of effort (from motor current)."""

    joints: tuple[str, ...] = Field(min_length=1, description="names of the joints, as in the URDF")
    encoder: AngleSensor = Field(description="angle sensor of each joint")
    effort_resolution: float = Field(gt=0.0, le=1e4, description="step of the measured joint effort [N m]")
    effort_noise: float = Field(ge=0.0, le=1e4, description="standard deviation of the measured effort [N m]")


class SensorSuiteParams(Params):
    """All sensors. Each key but those below is the name of a sensor, and its table says which kind of sensor that is
    (`kind`; left out: the name) and the kind's own parameters; null is none.

    A joint that is in no group is not measured.
    """

    model_config = ConfigDict(extra="allow")
    others: ClassVar[KindsOf] = KindsOf(SENSORS, "kind")
    """What the other keys may be."""

    joint_groups: dict[str, JointGroupParams] = Field(default_factory=dict, description="group name to its joints")
    joint_timing: SensorTimingParams | None = Field(
        default=None, description="when all encoders together measure and when they are heard"
    )
    joint_faults: dict[str, SensorFaultParams] = Field(
        default_factory=dict, description="what is wrong with all encoders together, by any names"
    )
    powered_by: dict[str, str] = Field(
        default_factory=dict, description="load of the bus that feeds each sensor; one that is left out always works"
    )

    @property
    def named(self) -> dict[str, SensorParams]:
        """The sensors beside the encoders, by their names."""
        return dict(self.__pydantic_extra__ or {})

    @property
    def sensors(self) -> dict[str, SensorParams]:
        """All sensors by their names, the encoders first."""
        joints = {"groups": self.joint_groups, "timing": self.joint_timing, "faults": self.joint_faults}
        return {JOINTS: SENSORS.get(JOINTS).model_validate(joints), **self.named}

    def first(self, kind: type[AnyParams]) -> AnyParams | None:
        """The first sensor with parameters of a class, None of a machine without one."""
        return next((params for params in self.named.values() if isinstance(params, kind)), None)

    def first_on(self, topic: str) -> SensorParams | None:
        """The first sensor that speaks on a topic of every run, None of a machine without one."""
        speaking = (params for params in self.named.values() if topic in (row.name for row in params.speaks_on))
        return next(speaking, None)

    def with_sensor(self, name: str, params: SensorParams | None) -> Self:
        """The suite with a sensor of that name, unless it has one or there is none to add."""
        return self if params is None or name in self.named else self.model_copy(update={name: params})

    def with_fault(self, sensor: str, name: str, fault: SensorFaultParams) -> Self:
        """The suite with one more fault of a sensor that it has."""
        if sensor == JOINTS:
            return self.model_copy(update={"joint_faults": {**self.joint_faults, name: fault}})
        params = self.named[sensor]
        return self.model_copy(update={sensor: params.model_copy(update={"faults": {**params.faults, name: fault}})})

    @model_serializer(mode="wrap")
    def _with_kinds(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As the file: a sensor that is not named by its kind says which it is."""
        found: dict[str, Any] = {key: value for key, value in dump(self).items() if value or key not in JOINTS_ASIDE}
        for name, params in self.named.items():
            found[name] = params.model_dump(mode="json") | ({"kind": params.kind} if params.kind != name else {})
        return found

    @model_validator(mode="after")
    def _read_the_others(self) -> Self:
        """Make of each table the parameters of its kind."""
        found = self.__pydantic_extra__ if self.__pydantic_extra__ is not None else {}
        problems: list[InitErrorDetails] = []
        for name, table in list(found.items()):
            if table is None:
                del found[name]
                continue
            try:
                found[name] = read_sensor(name, table)
            except ValidationError as error:
                problems += [within(name, detail) for detail in error.errors(include_url=False)]
        spoken = {row.name for params in found.values() for row in getattr(params, "speaks_on", ())}
        absent = [] if problems else [kind for kind, topic in REQUIRED.items() if topic not in spoken]
        problems += [InitErrorDetails(type="missing", loc=(kind,), input=dict(found)) for kind in absent]
        if problems:
            raise ValidationError.from_exception_data(type(self).__name__, problems)
        return self

    @model_validator(mode="after")
    def _check(self) -> Self:
        seen: dict[str, str] = {}
        for name, group in self.joint_groups.items():
            for joint in group.joints:
                if joint in seen:
                    raise ValueError(f"joint {joint!r} is in {seen[joint]!r} and {name!r}: allowed is one group")
                seen[joint] = name
        kinds: dict[str, str] = {}
        for name, params in self.named.items():
            if not name.isidentifier() or not name.isascii():
                raise ValueError(f"sensor {name!r}: allowed are letters, digits and underscores, no digit first")
            if params.alone and params.kind in kinds:
                raise ValueError(
                    f"{kinds[params.kind]!r} and {name!r}: allowed is one sensor of the kind {params.kind!r}"
                )
            kinds[params.kind] = name
        return self


def read_sensor(name: str, table: Any) -> Any:
    """The parameters of the sensor of a name from its table, of the kind that this names, or else of that of its name.

    None and what has been read already stay as they are. Raises ValidationError, with the places within the table.
    """
    if table is None or isinstance(table, SensorParams):
        return table
    if not isinstance(table, Mapping):
        details = InitErrorDetails(type="model_type", loc=(), input=table, ctx={"class_name": "sensor"})
        raise ValidationError.from_exception_data(name, [details])
    told = table.get("kind", name)
    if not isinstance(told, str):
        unnamed = InitErrorDetails(type="string_type", loc=("kind",), input=told)
        raise ValidationError.from_exception_data(name, [unnamed])
    try:
        kind = SENSORS.get(told)
    except UnknownNameError as error:
        problem = ValueError(str(error))
        details = InitErrorDetails(type="value_error", loc=("kind",), input=told, ctx={"error": problem})
        raise ValidationError.from_exception_data(name, [details]) from None
    # text is no number and a list stands for a tuple, as in the files: strict mode takes them so from JSON alone
    return kind.model_validate_json(to_json({**table, "kind": told}), strict=True)
