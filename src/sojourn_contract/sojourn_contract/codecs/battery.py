"""State of an energy store."""

import struct
from typing import Any

from sojourn_contract.codecs.cdr import Reader, Writer
from sojourn_contract.values import BatteryState

_CELLS = "f4"
_FLAT = struct.Struct("<7f4B")
"""Seven numbers, three enumerations, presence: no padding between them."""


class BatteryStateCodec:
    """sensor_msgs/BatteryState."""

    def encode(self, value: BatteryState) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.align(4)
        writer.data += _FLAT.pack(*value[2:13])
        for cells in (value.cell_voltage, value.cell_temperature):
            writer.number("I", len(cells))
            for cell in cells:
                writer.number("f", cell)
        writer.text(value.location)
        writer.text(value.serial_number)
        return bytes(writer.data)

    def decode(self, data: bytes) -> BatteryState:
        """The value in these bytes."""
        reader = Reader(data)
        stamp, frame = reader.header()
        fields: list[Any] = [reader.number("f") for _ in range(7)]
        fields += [int(reader.number("B")) for _ in range(3)]
        fields.append(bool(reader.number("B")))
        fields += [tuple(reader.sequence(_CELLS).tolist()) for _ in range(2)]
        return BatteryState._make((stamp, frame, *fields, reader.text(), reader.text()))
