"""Messages of texts: headers, clock, diagnostics."""

from itertools import chain

from sojourn_contract.codecs.beginnings import Beginnings
from sojourn_contract.codecs.cdr import HEADER, Reader, Writer, stamp_bytes
from sojourn_contract.values import Clock, DiagnosticArray, DiagnosticStatus, Header

Said = tuple[str, tuple[DiagnosticStatus, ...]]
"""Frame of the header, statuses."""


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

    def __init__(self) -> None:
        self._beginnings: Beginnings[str] = Beginnings(Writer.text, Reader.text)

    def encode(self, value: Header) -> bytes:
        """CDR of a value."""
        return self._beginnings.bytes_of(value.stamp, value.frame)

    def decode(self, data: bytes) -> Header:
        """The value in these bytes."""
        stamp, frame, _ = self._beginnings.read(data)
        return Header(stamp, frame)


class DiagnosticsCodec:
    """diagnostic_msgs/DiagnosticArray: texts throughout, and many say the same again and again."""

    def __init__(self) -> None:
        self._beginnings: Beginnings[Said] = Beginnings(_write_said, _read_said)

    def encode(self, value: DiagnosticArray) -> bytes:
        """CDR of a value."""
        return self._beginnings.bytes_of(value.stamp, (value.frame, value.status))

    def decode(self, data: bytes) -> DiagnosticArray:
        """The value in these bytes."""
        stamp, (frame, status), _ = self._beginnings.read(data)
        return DiagnosticArray(stamp, status, frame)


def _write_said(writer: Writer, said: Said) -> None:
    frame, statuses = said
    writer.text(frame)
    writer.number("I", len(statuses))
    for status in statuses:
        writer.number("B", status.level)
        writer.text(status.name, status.message, status.hardware_id)
        writer.number("I", len(status.values))
        writer.text(*chain.from_iterable(status.values))


def _read_said(reader: Reader) -> Said:
    return reader.text(), tuple([_status(reader) for _ in range(reader.count(20))])


def _status(reader: Reader) -> DiagnosticStatus:
    level, name, message, hardware = int(reader.number("B")), reader.text(), reader.text(), reader.text()
    values = tuple([(reader.text(), reader.text()) for _ in range(reader.count(8))])
    return DiagnosticStatus(name, values, message, level, hardware)
