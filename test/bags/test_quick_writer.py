"""The quick writer of messages against the library's: the same bytes, whatever is written and flushed whenever."""

import gc
import io
import struct
import tracemalloc
import weakref
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from sojourn_bags.quick_writer import QuickWriter

CHANNELS = 3
TIMES = st.integers(0, 2**64 - 1)
MESSAGE = st.tuples(st.integers(0, CHANNELS - 1), TIMES, st.binary(max_size=40), TIMES, st.integers(0, 2**32 - 1))
FLUSH = None
Script = Sequence[tuple[int, int, bytes, int, int] | None]


def written(kind: type[Writer], script: Script, compression: CompressionType, chunk_size: int) -> list[bytes]:
    """The file that a writer makes of messages and flushes, as it is after each flush and at the end; a channel is
    registered before its first message.
    """
    stream, ids, found = io.BytesIO(), dict[int, int](), list[bytes]()
    writer = kind(stream, compression=compression, chunk_size=chunk_size)
    writer.start(profile="ros2", library="test")
    writer.add_attachment(0, 0, "a", "text/plain", b"attached")
    schema = writer.register_schema("type", "ros2msg", b"float64 x")
    for entry in script:
        if entry is FLUSH:
            writer.flush()
            found.append(stream.getvalue())
            continue
        channel, log_time, data, publish_time, sequence = entry
        if channel not in ids:
            ids[channel] = writer.register_channel(f"/topic_{channel}", "cdr", schema, {"number": str(channel)})
        writer.add_message(ids[channel], log_time, data, publish_time, sequence)
    writer.add_metadata("end", {"of": "file"})
    writer.finish()
    return [*found, stream.getvalue()]


@given(
    st.lists(st.one_of(MESSAGE, st.just(FLUSH)), max_size=40),
    st.sampled_from((CompressionType.NONE, CompressionType.ZSTD)),
    st.integers(1, 500),
)
def test_file_is_that_of_the_library(script: Script, compression: CompressionType, chunk_size: int) -> None:
    """Chunks, indices, statistics and checksums, of times in any order."""
    quick = written(QuickWriter, script, compression, chunk_size)
    assert quick == written(Writer, script, compression, chunk_size)


def test_a_file_may_end_with_a_chunk_that_has_just_become_full() -> None:
    """Nothing but the end comes after it."""

    def ended(kind: type[Writer]) -> bytes:
        stream = io.BytesIO()
        writer = kind(stream, compression=CompressionType.ZSTD, chunk_size=10)
        writer.start(profile="ros2", library="test")
        channel = writer.register_channel("/topic", "cdr", writer.register_schema("type", "ros2msg", b"float64 x"))
        writer.add_message(channel, 1, b"some bytes", 1)
        writer.finish()
        return stream.getvalue()

    assert ended(QuickWriter) == ended(Writer)


def test_a_writer_that_is_done_is_gone_at_once() -> None:
    """A recorder of many files kept the indices of those that it had finished: megabytes in a day."""
    writer = QuickWriter(io.BytesIO())
    writer.start("ros2", "test")
    writer.finish()
    lives = weakref.ref(writer)
    gc.disable()
    try:
        del writer
        assert lives() is None
    finally:
        gc.enable()


def many_chunks(kind: type[Writer], stream: io.BytesIO, chunks: int) -> Writer:
    """A writer of so many chunks with messages of 40 channels each."""
    writer = kind(stream, compression=CompressionType.NONE)
    writer.start("ros2", "test")
    schema = writer.register_schema("type", "ros2msg", b"float64 x")
    ids = [writer.register_channel(f"/topic_{number}", "cdr", schema, {}) for number in range(40)]
    for chunk in range(chunks):
        for channel in ids:
            writer.add_message(channel, 10**9 + chunk, b"some bytes", 10**9 + chunk)
        writer.flush()
    return writer


def test_a_file_of_many_chunks_is_that_of_the_library() -> None:
    def ended(kind: type[Writer]) -> bytes:
        stream = io.BytesIO()
        many_chunks(kind, stream, 300).finish()  # some blocks of indices
        return stream.getvalue()

    assert ended(QuickWriter) == ended(Writer)


def test_a_file_that_grows_leaves_little_in_memory() -> None:
    """A recorder's index of a file of a gigabyte took megabytes: of each chunk, where each channel's messages stand."""

    class Sink(io.BytesIO):
        def write(self, data: Any) -> int:
            return len(data)

    def held(kind: type[Writer], chunks: int) -> int:
        tracemalloc.start()
        writer = many_chunks(kind, Sink(), chunks)
        found = tracemalloc.get_traced_memory()[0]
        tracemalloc.stop()
        writer.finish()
        return found

    def grown(kind: type[Writer]) -> int:
        return held(kind, 600) - held(kind, 200)

    assert grown(QuickWriter) < 0.1 * grown(Writer)


def test_messages_are_read_back() -> None:
    """By the library's reader, which goes by the indices."""
    script = [(number % CHANNELS, 1000 - number, bytes([number]), number, number) for number in range(100)]
    *_, data = written(QuickWriter, script, CompressionType.ZSTD, 200)
    read = [message for _, _, message in make_reader(io.BytesIO(data)).iter_messages()]
    found = [(message.log_time, message.data, message.publish_time, message.sequence) for message in read]
    assert found == sorted((entry[1], entry[2], entry[3], entry[4]) for entry in script)


@pytest.mark.parametrize("entry", [(0, 2**64, b"", 0, 0), (0, -1, b"", 0, 0), (0, 0, b"", 0, 2**32)])
def test_message_that_does_not_fit_leaves_nothing_behind(entry: tuple[int, int, bytes, int, int]) -> None:
    """A time or a count of too many bits is refused, and the file goes on without it."""
    stream = io.BytesIO()
    writer = QuickWriter(stream, compression=CompressionType.NONE)
    writer.start()
    channel = writer.register_channel("/topic", "cdr", 0)
    with pytest.raises(struct.error):
        writer.add_message(channel, *entry[1:])
    writer.add_message(channel, 5, b"good", 6, 7)
    writer.finish()
    (message,) = [message for _, _, message in make_reader(io.BytesIO(stream.getvalue())).iter_messages()]
    assert (message.log_time, message.data, message.publish_time, message.sequence) == (5, b"good", 6, 7)
