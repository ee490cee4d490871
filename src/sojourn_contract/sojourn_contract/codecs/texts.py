"""Messages of texts: headers, clock, diagnostics."""

from sojourn_contract.codecs.cdr import HEADER, Reader, Writer, stamp_bytes
from sojourn_contract.values import Clock, DiagnosticArray, DiagnosticStatus, Header


class ClockCodec:
    """rosgraph_msgs/Clock."""

    def encode(self, value: Clock) -> bytes:
        """CDR of a value."""
        return HEADER + stamp_bytes(value.stamp)

    def decode(self, data: bytes) -> Clock:
        """The value in these bytes."""
        return Clock(Reader(data).stamp())


class HeaderCodec:
    """std_msgs/Header."""

    def encode(self, value: Header) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        return bytes(writer.data)

    def decode(self, data: bytes) -> Header:
        """The value in these bytes."""
        return Header(*Reader(data).header())


class DiagnosticsCodec:
    """diagnostic_msgs/DiagnosticArray."""

    def encode(self, value: DiagnosticArray) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.number("I", len(value.status))
        for status in value.status:
            writer.number("B", status.level)
            for text in (status.name, status.message, status.hardware_id):
                writer.text(text)
            writer.number("I", len(status.values))
            for pair in status.values:
                for text in pair:
                    writer.text(text)
        return bytes(writer.data)

    def decode(self, data: bytes) -> DiagnosticArray:
        """The value in these bytes."""
        reader = Reader(data)
        stamp, frame = reader.header()
        return DiagnosticArray(stamp, tuple([_status(reader) for _ in range(reader.count(20))]), frame)


def _status(reader: Reader) -> DiagnosticStatus:
    level, name, message, hardware = int(reader.number("B")), reader.text(), reader.text(), reader.text()
    values = tuple([(reader.text(), reader.text()) for _ in range(reader.count(8))])
    return DiagnosticStatus(name, values, message, level, hardware)
