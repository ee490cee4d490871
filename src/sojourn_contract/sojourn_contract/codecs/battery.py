"""State of an energy store."""

import struct

from sojourn_contract.codecs.beginnings import Beginnings
from sojourn_contract.codecs.cdr import Reader, Writer
from sojourn_contract.values import BatteryState

_CELLS = "f4"
_FLAT = {order: struct.Struct(order + "7f4B") for order in "<>"}
"""By byte order: seven numbers, three enumerations, presence, no padding between them."""


class BatteryStateCodec:
    """sensor_msgs/BatteryState."""

    def __init__(self) -> None:
        self._beginnings: Beginnings[str] = Beginnings(Writer.text, Reader.text, 4)

    def encode(self, value: BatteryState) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.data = bytearray(self._beginnings.bytes_of(value.stamp, value.frame))
        writer.data += _FLAT["<"].pack(*value[2:13])
        for cells in (value.cell_voltage, value.cell_temperature):
            writer.number("I", len(cells))
            for cell in cells:
                writer.number("f", cell)
        writer.text(value.location, value.serial_number)
        return bytes(writer.data)

    def decode(self, data: bytes) -> BatteryState:
        """The value in these bytes."""
        stamp, frame, at = self._beginnings.read(data)
        reader = Reader(data, at)
        *numbers, present = reader.flat(_FLAT[reader.order])
        cells = [tuple(reader.sequence(_CELLS).tolist()) for _ in range(2)]
        return BatteryState._make((stamp, frame, *numbers, bool(present), *cells, reader.text(), reader.text()))
