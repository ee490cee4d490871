"""Grids of cells."""

from sojourn_contract.codecs.cdr import Reader, Writer
from sojourn_contract.values import OccupancyGrid


class OccupancyGridCodec:
    """nav_msgs/OccupancyGrid."""

    def encode(self, value: OccupancyGrid) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.stamp(value.map_load_time)
        writer.number("f", value.resolution)
        writer.number("I", value.width)
        writer.number("I", value.height)
        writer.doubles(value.position)
        writer.doubles(value.orientation)
        writer.octets(value.data)
        return bytes(writer.data)

    def decode(self, data: bytes) -> OccupancyGrid:
        """The value in these bytes."""
        reader = Reader(data)
        beginning = reader.header()
        loaded, resolution = reader.stamp(), reader.number("f")
        width, height = int(reader.number("I")), int(reader.number("I"))
        position, orientation = reader.numbers("f8", 3), reader.numbers("f8", 4)
        return OccupancyGrid(*beginning, resolution, width, height, position, reader.octets(), orientation, loaded)
