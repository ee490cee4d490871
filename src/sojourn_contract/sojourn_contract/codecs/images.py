"""Images, and what the camera that made them is."""

from sojourn_contract.codecs.cdr import Reader, Writer
from sojourn_contract.values import CameraInfo, Image, RegionOfInterest


class ImageCodec:
    """sensor_msgs/Image."""

    def encode(self, value: Image) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.number("I", value.height)
        writer.number("I", value.width)
        writer.text(value.encoding)
        writer.number("B", value.is_bigendian)
        writer.number("I", value.step)
        writer.octets(value.data)
        return bytes(writer.data)

    def decode(self, data: bytes) -> Image:
        """The value in these bytes."""
        reader = Reader(data)
        stamp, frame = reader.header()
        height, width = int(reader.number("I")), int(reader.number("I"))
        encoding, is_bigendian = reader.text(), int(reader.number("B"))
        return Image(stamp, frame, height, width, encoding, int(reader.number("I")), reader.octets(), is_bigendian)


class CameraInfoCodec:
    """sensor_msgs/CameraInfo."""

    def encode(self, value: CameraInfo) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.number("I", value.height)
        writer.number("I", value.width)
        writer.text(value.distortion_model)
        writer.sequence(value.distortion)
        for matrix in (value.intrinsic, value.rectification, value.projection):
            writer.doubles(matrix)
        for number in (value.binning_x, value.binning_y, *value.roi[:4]):
            writer.number("I", number)
        writer.number("B", value.roi.do_rectify)
        return bytes(writer.data)

    def decode(self, data: bytes) -> CameraInfo:
        """The value in these bytes."""
        reader = Reader(data)
        beginning = reader.header()
        height, width, model = int(reader.number("I")), int(reader.number("I")), reader.text()
        distortion = reader.sequence()
        k, r, p = (reader.numbers("f8", count) for count in (9, 9, 12))
        binning_x, binning_y = int(reader.number("I")), int(reader.number("I"))
        x, y, roi_height, roi_width = (int(reader.number("I")) for _ in range(4))
        roi = RegionOfInterest(x, y, roi_height, roi_width, bool(reader.number("B")))
        return CameraInfo(*beginning, height, width, model, distortion, k, r, p, binning_x, binning_y, roi)
