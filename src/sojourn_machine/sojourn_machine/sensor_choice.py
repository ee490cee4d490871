"""A sensor on a machine, as its sensors.yaml says it: a kind by its name, with its own parameters.

What the sensor does and says is found by the name of its kind when it is needed: see `registry`.
"""

from collections.abc import Iterable
from typing import Any, ClassVar, NamedTuple, Self

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from sojourn_machine.params import Params
from sojourn_machine.registry import Registry
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_machine.sensor_timing import SensorTimingParams

SENSORS: "Registry[type[SensorParams]]" = Registry("sojourn.sensors", "kind of sensor")
"""Parameter sets of the kinds of sensors, by their names."""

ASIDE = ("timing", "faults", "on_demand")
"""Keys that every kind has beside its own; a table without them has none."""


class MachinePart(NamedTuple):
    """Parts of a machine that a sensor is on, as one key of its table names them.

    Args:
        key: of the table. kind: what they are: a `node` of the machine's heat, a `store`, a `joint` that moves, a joint
            whose `travel` has ends, a `motor` by its joint, whose heat is known, a joint that is `driven` by a
            motor of ours, a load that is a `string` of a bus with a store.
        names: of the parts; one for a key that is a name, or those of its list.
    """

    key: str
    kind: str
    names: tuple[str, ...]


class SensorParams(Params):
    """One sensor. Each kind has a subclass with its parameters, registered under the default of its `kind`."""

    kind: str = Field(description="kind of sensor; left out: the name of the sensor")
    timing: SensorTimingParams | None = Field(default=None, description="when it measures and when it is heard")
    faults: dict[str, SensorFaultParams] = Field(
        default_factory=dict, description="what is wrong with it, by any names"
    )
    on_demand: bool = Field(
        default=False,
        description="whether it measures only while somebody outside of the run listens, and is not in the bag",
    )
    speaks_on: ClassVar[tuple[Any, ...]] = ()
    """Rows of the topic table on which the first sensor speaks that has them; a further one has its name behind."""
    hears: ClassVar[tuple[Any, ...]] = ()
    """Rows of the plant's truth that only runs with such a sensor have."""
    left_out: ClassVar[tuple[str, ...]] = ()
    """Further keys that a table does not have where there is nothing under them."""
    quantities: ClassVar[tuple[str, ...] | None] = None
    """Of its readings, those whose numbers may be wrong by a fault: "" for one that has no name, nothing where there
    are no numbers; None where its sensor alone knows.
    """
    has_lens: ClassVar[bool] = False
    """Whether dust may lie on it, of a kind that says its quantities."""
    alone: ClassVar[bool] = False
    """Whether a machine has one of the kind at most."""

    @model_serializer(mode="wrap")
    def _without_the_kind(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As a table of the file: the kind is that of the name under which it stands there."""
        unsaid = (*ASIDE, *self.left_out)
        return {key: value for key, value in dump(self).items() if key != "kind" and (value or key not in unsaid)}

    @model_validator(mode="after")
    def _check_timing(self) -> Self:
        if self.timing is not None:
            for row in self.speaks_on:
                self.timing.check_row(row)
        return self

    @property
    def heard_rows(self) -> tuple[Any, ...]:
        """Those of `hears` that this one does hear, by its parameters."""
        return self.hears

    @property
    def own_rows(self) -> tuple[Any, ...]:
        """Of the rows of its kind those on which it speaks: all, unless what it says depends on its parameters."""
        return self.speaks_on

    @property
    def heard(self) -> tuple[SensorTimingParams, tuple[tuple[float, float, bool], ...]]:
        """When it is heard: its timing, and from when on [s] how many of its messages are lost [-] by its faults, and
        whether they come with a stamp that stays.
        """
        lost = tuple((fault.after, fault.loses, fault.frozen_stamp) for fault in self.faults.values() if fault.loses)
        return self.timing or SensorTimingParams(), lost

    @property
    def links(self) -> tuple[str, ...]:
        """Links of the URDF on which it sits: that of its parameter `link`, if the kind has one."""
        link = getattr(self, "link", None)
        return () if link is None else (str(link),)

    @property
    def optical_frames(self) -> tuple[tuple[str, str], ...]:
        """Frames of its images (z ahead, x right, y down; REP 103), each with the link on which it stands."""
        return ()

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        """Parts of the machine that it is on."""
        return ()

    def fault_problems(self, fault: SensorFaultParams) -> Iterable[tuple[str, str, str]]:
        """What a fault has that it cannot have, as far as its kind says that: key, value, what is allowed."""
        if self.quantities is None or not fault.is_numerical:
            return
        if fault.dust > 0.0:
            if not self.has_lens:
                yield "dust", f"{fault.dust:g}", "no dust: it has no lens"
        elif not self.quantities:
            lens = "dust, " if self.has_lens else ""
            yield "of", fault.of, f"none that changes numbers: it has none; allowed are {lens}stuck, dead, dropout"
        elif fault.of not in self.quantities:
            one = "no quantity: there is one alone" if "" in self.quantities else ""
            yield "of", fault.of, one or f"a fault of one of {', '.join(self.quantities)}"

    @property
    def needs_air(self) -> bool:
        """Whether it works in air alone."""
        return False

    @property
    def needs_magnetic_site(self) -> bool:
        """Whether, on a body with a magnetic field, it has to know where on it."""
        return False

    @property
    def soils(self) -> tuple[str, ...]:
        """Names of the soils that it knows; none where it does not ask which it is."""
        return ()

    @property
    def bytes_a_second(self) -> float:
        """Of what it says, where that is much: images."""
        return 0.0

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        """(topic, message) at a stamp [ns] of a machine without such a sensor, on the rows that every run has."""
        return ()

    def sensor(self, name: str, site: Any) -> Any:
        """The sensor of this name on a site; what both are says the package of the sensors' node."""
        raise NotImplementedError
