"""Images that are told before they are made."""

from collections.abc import Iterator
from typing import Any, cast

from sojourn_contract.unfinished import Unfinished
from sojourn_contract.values import Image


class UnfinishedImage(Image):
    """An image of which all is known but its pixels: whoever takes it to pieces waits for them."""

    __slots__ = ()

    @property
    def is_finished(self) -> bool:
        """Whether its pixels are there."""
        return self._pixels.is_finished

    @property
    def data(self) -> bytes:
        """Its pixels."""
        return self._pixels.finished()

    def finished(self) -> Image:
        """The same as an image like any other."""
        return Image(*(getattr(self, name) for name in self._fields))

    def _replace(self, /, **fields: Any) -> Image:  # type: ignore[override]
        parts = dict(zip(self._fields, super().__iter__(), strict=True)) | fields
        return Image(**parts) if "data" in fields else UnfinishedImage(**parts)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.finished())

    def __getitem__(self, place: Any) -> Any:
        return self.finished()[place]

    def __reduce__(self) -> tuple[Any, ...]:
        return Image, tuple(self)

    @property
    def _pixels(self) -> Unfinished[bytes]:
        return cast("Unfinished[bytes]", super().__getitem__(_DATA))

    def __eq__(self, other: object) -> bool:
        return bool(self.finished() == finished(other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash(self.finished())


_DATA = Image._fields.index("data")
UNFINISHED = (Unfinished, UnfinishedImage)
"""Of what `finished` makes whole."""


def finished(value: Any) -> Any:
    """A value, whole; any other is that already."""
    return value.finished() if isinstance(value, UNFINISHED) else value
