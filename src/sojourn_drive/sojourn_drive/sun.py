"""Readings of the sun sensor as the drive's input, with where the ephemeris has the Sun."""

from sojourn_config.flight import FlightScenario
from sojourn_contract import stamps
from sojourn_contract.values import Vector3Stamped
from sojourn_flight.odometry.heading_fix import SunSighting
from sojourn_machine.mounting import mounting


class SunSightings:
    """Takes each reading once.

    Args:
        known: its Sun is the ephemeris of the site; of a machine without a sun sensor there are no sightings.
    """

    def __init__(self, known: FlightScenario) -> None:
        self._sun = known.sun_over()
        sensor = known.sensors.first_on("/sun_direction")
        self._sensor_to_base = None if sensor is None else mounting(known.urdf_xml, sensor.links[0])[0]

    def sighting(self, stamp: int, message: Vector3Stamped | None, last: int) -> tuple[SunSighting | None, int]:
        """The reading that belongs to this period [ns], None where there is none, or it has been taken before; and the
        stamp of the last one that was taken [ns], zero before the first.

        In real time it may be a period late: a turning machine has turned by a seventh of a degree at most.
        """
        if message is None or self._sensor_to_base is None:
            return None, last
        sent = message.stamp
        if sent <= last or not 0 <= stamp - sent <= stamps.CONTROL_PERIOD_NS:
            return None, last
        in_base = self._sensor_to_base @ message.vector
        return SunSighting(in_base, self._sun.direction(stamps.seconds(sent))), sent
