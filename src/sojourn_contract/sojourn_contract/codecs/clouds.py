"""Clouds of points."""

from sojourn_contract.codecs.beginnings import Beginnings
from sojourn_contract.codecs.cdr import LENGTH, Reader, Writer
from sojourn_contract.values import PointCloud2, PointField

Form = tuple[str, int, int, tuple[PointField, ...], bool, int, int]
"""Frame, height, width, fields, byte order, point step, row step."""


class PointCloudCodec:
    """sensor_msgs/PointCloud2."""

    def __init__(self) -> None:
        self._beginnings: Beginnings[Form] = Beginnings(_write_form, _read_form, LENGTH.size)

    def encode(self, value: PointCloud2) -> bytes:
        """CDR of a value."""
        form = (
            value.frame, value.height, value.width, value.fields, value.is_bigendian, value.point_step, value.row_step,
        )  # fmt: skip
        beginning = self._beginnings.bytes_of(value.stamp, form)
        return beginning + LENGTH.pack(len(value.data)) + value.data + (b"\1" if value.is_dense else b"\0")

    def decode(self, data: bytes) -> PointCloud2:
        """The value in these bytes."""
        stamp, form, at = self._beginnings.read(data)
        frame, height, width, fields, is_bigendian, point_step, row_step = form
        reader = Reader(data, at)
        points, is_dense = reader.octets(), bool(reader.number("B"))
        return PointCloud2(stamp, frame, width, fields, point_step, points, height, row_step, is_bigendian, is_dense)


def _write_form(writer: Writer, form: Form) -> None:
    frame, height, width, fields, is_bigendian, point_step, row_step = form
    writer.text(frame)
    for number in (height, width, len(fields)):
        writer.number("I", number)
    for field in fields:
        writer.text(field.name)
        writer.number("I", field.offset)
        writer.number("B", field.datatype)
        writer.number("I", field.elements)
    writer.number("B", is_bigendian)
    writer.number("I", point_step)
    writer.number("I", row_step)


def _read_form(reader: Reader) -> Form:
    frame, height, width = reader.text(), int(reader.number("I")), int(reader.number("I"))
    fields = tuple([_field(reader) for _ in range(reader.count(16))])
    is_bigendian = bool(reader.number("B"))
    return frame, height, width, fields, is_bigendian, int(reader.number("I")), int(reader.number("I"))


def _field(reader: Reader) -> PointField:
    name, offset = reader.text(), int(reader.number("I"))
    return PointField(name, offset, int(reader.number("B")), int(reader.number("I")))
