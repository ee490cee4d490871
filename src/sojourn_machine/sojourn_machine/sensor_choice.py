"""A sensor on a machine, as its sensors.yaml says it: a kind by its name, with its own parameters.

What the sensor does and says is found by the name of its kind when it is needed: see `registry`.
"""

from collections.abc import Iterable
from typing import Any, ClassVar

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer

from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

SENSORS: "Registry[type[SensorParams]]" = Registry("sojourn.sensors", "kind of sensor")
"""Parameter sets of the kinds of sensors, by their names."""


class SensorParams(Params):
    """One sensor. Each kind has a subclass with its parameters, registered under the default of its `kind`."""

    kind: str = Field(description="kind of sensor; left out: the name of the sensor")
    speaks_on: ClassVar[tuple[Any, ...]] = ()
    """Rows of the topic table on which the first sensor speaks that has them; a further one has its name behind."""
    alone: ClassVar[bool] = False
    """Whether a machine has one of the kind at most."""

    @model_serializer(mode="wrap")
    def _without_the_kind(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As a table of the file: the kind is that of the name under which it stands there."""
        return {key: value for key, value in dump(self).items() if key != "kind"}

    @property
    def links(self) -> tuple[str, ...]:
        """Links of the URDF on which it sits: that of its parameter `link`, if the kind has one."""
        link = getattr(self, "link", None)
        return () if link is None else (str(link),)

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        """(topic, message) at a stamp [ns] of a machine without such a sensor, on the rows that every run has."""
        return ()

    def sensor(self, name: str, site: Any) -> Any:
        """The sensor of this name on a site; what both are says the package of the sensors' node."""
        raise NotImplementedError
