"""What is made while the run goes on: its results, who makes them, what fails, copies of the process, and images."""

import io
import os
import pickle
import signal
import threading

import pytest

from sojourn_contract import unfinished
from sojourn_contract.codecs import encode
from sojourn_contract.corruption import bits_of, with_bit_flipped
from sojourn_contract.run_table import row_named
from sojourn_contract.state_tree import TreeWriter, read_tree
from sojourn_contract.unfinished import MOST, begun, finish_all, shared
from sojourn_contract.unfinished_image import UnfinishedImage, finished
from sojourn_contract.values import Image
from sojourn_operator.link.length import bits

HERE, LONG = threading.current_thread, 60.0


def test_another_thread_makes_it_and_whoever_asks_waits() -> None:
    may_end = threading.Event()

    def make() -> threading.Thread:
        assert may_end.wait(LONG)
        return HERE()

    thing = begun(make)
    named = thing.then(lambda thread: thread.name)
    assert not thing.is_finished and not named.is_finished
    threading.Timer(0.05, may_end.set).start()
    assert thing.finished() is not HERE()
    assert named.is_finished and named.finished() == thing.finished().name
    assert finished(thing) is thing.finished() and finished(7) == 7


def test_one_thing_is_made_after_another() -> None:
    order = list[int]()
    things = [begun(lambda k=k: order.append(k)) for k in range(3 * MOST)]  # type: ignore[misc]
    finish_all()
    assert order == list(range(3 * MOST)) and all(thing.is_finished for thing in things)


def test_so_many_are_unfinished_at_most() -> None:
    may_end = threading.Event()
    for _ in range(MOST):
        begun(lambda: may_end.wait(LONG))
    one_more = threading.Thread(target=lambda: begun(may_end.is_set))
    one_more.start()
    one_more.join(0.1)
    assert one_more.is_alive()
    may_end.set()
    one_more.join(LONG)
    assert not one_more.is_alive()
    finish_all()


def test_what_making_it_has_raised_is_raised_where_it_is_asked_for() -> None:
    def fails() -> None:
        raise ValueError("no light")

    thing = begun(fails)
    for _ in range(2):
        with pytest.raises(ValueError, match="no light"):
            thing.finished()
    assert thing.is_finished and begun(lambda: 3).finished() == 3


def test_parts_that_share_nothing_come_in_their_order() -> None:
    assert shared([lambda k=k: k for k in range(5)]) == list(range(5))  # type: ignore[misc]
    assert shared([HERE]) == [HERE()]
    assert shared([HERE, HERE, HERE]) == [HERE()] * 3  # nobody waits who could help


def test_who_waits_makes_a_part() -> None:
    """It could not end else: each of the two waits for the other."""
    both = threading.Barrier(2, timeout=LONG)

    def part() -> threading.Thread:
        both.wait()
        return HERE()

    threads = begun(lambda: shared([part, part])).finished()
    assert threads[1] is HERE() and threads[0] is not HERE()


@pytest.mark.parametrize("place", [0, 1])
def test_a_part_that_fails_is_told_when_all_have_ended(place: int) -> None:
    """One that went on would change its arrays under whoever makes the next ones."""
    begins, ended = threading.Event(), threading.Event()

    def fails() -> None:
        assert begins.wait(LONG)
        raise ValueError("no light")

    def takes_long() -> None:
        begins.set()
        threading.Event().wait(0.1)
        ended.set()

    parts = [fails, takes_long] if place == 0 else [takes_long, fails]
    with pytest.raises(ValueError, match="no light"):
        begun(lambda: shared(parts)).finished()
    assert ended.is_set()


def test_who_is_interrupted_leaves_his_part_to_others() -> None:
    """What had been interrupted was the image's, and the operator's Ctrl-C was not heard."""
    interrupted = threading.Event()

    def first() -> None:
        assert interrupted.wait(LONG)

    def second() -> threading.Thread:
        if not interrupted.is_set():
            interrupted.set()
            raise KeyboardInterrupt
        return HERE()

    def make() -> threading.Thread:
        return shared([first, second])[1]  # type: ignore[return-value,list-item]

    thing = begun(make)
    with pytest.raises(KeyboardInterrupt):
        finish_all()
    assert thing.finished() is not None and not unfinished._offered


def test_a_copy_of_the_process_makes_things_of_its_own() -> None:
    """It has no other thread than the one that has copied itself, and no lock that another held."""
    before = begun(HERE)
    pid = os.fork()
    if pid == 0:
        signal.alarm(int(LONG))
        os._exit(0 if before.is_finished and begun(lambda: 5).finished() == 5 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
    assert begun(lambda: 6).finished() == 6 and not unfinished._offered


def test_no_copy_is_made_while_the_other_thread_has_the_lock(monkeypatch: pytest.MonkeyPatch) -> None:
    """The copy would wait for a thread that it has not."""
    notify = threading.Condition.notify_all

    def slowly(condition: threading.Condition) -> None:
        threading.Event().wait(0.05)  # with the lock
        notify(condition)

    monkeypatch.setattr(unfinished._changed, "notify_all", lambda: slowly(unfinished._changed))
    begun(HERE)
    pid = os.fork()
    if pid == 0:
        signal.alarm(int(LONG))
        os._exit(0 if begun(lambda: 5).finished() == 5 else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0


def unfinished_image(pixels: bytes, after: threading.Event) -> UnfinishedImage:
    def made() -> bytes:
        assert after.wait(LONG)
        return pixels

    return UnfinishedImage(20_000_000, "eye_optical", 2, 3, "mono8", 3, begun(made))  # type: ignore[arg-type]


def test_an_image_waits_for_its_pixels_alone() -> None:
    may_end = threading.Event()
    image = unfinished_image(b"abcdef", may_end)
    assert (image.stamp, image.height, image.width, image.step, image.is_finished) == (20_000_000, 2, 3, 3, False)
    later = image._replace(stamp=40_000_000)
    assert isinstance(later, UnfinishedImage) and not later.is_finished
    may_end.set()
    assert image.data == b"abcdef" and image.is_finished
    assert later.finished() == Image(40_000_000, "eye_optical", 2, 3, "mono8", 3, b"abcdef")


def test_an_unfinished_image_is_what_a_finished_one_is() -> None:
    may_end = threading.Event()
    may_end.set()
    image = unfinished_image(b"abcdef", may_end)
    same = Image(20_000_000, "eye_optical", 2, 3, "mono8", 3, b"abcdef")
    row = row_named("/navcam/left/image")
    assert row is not None and encode(row, image) == encode(row, same)
    assert image == same and same == image and hash(image) == hash(same)
    assert image != same._replace(data=b"abcdeg") and type(finished(image)) is Image
    assert tuple(image) == tuple(same) and image[-2:] == same[-2:] and pickle.loads(pickle.dumps(image)) == same
    assert image._replace(data=b"ghijkl") == same._replace(data=b"ghijkl")
    assert bits_of(image) == bits_of(same) and bits(image) == bits(same)
    assert with_bit_flipped(finished(image), bits_of(image) - 1).data == b"abcde\xe6"


def test_a_checkpoint_has_things_as_they_are_when_they_are_finished() -> None:
    may_end = threading.Event()
    threading.Timer(0.05, may_end.set).start()
    kept = {"said": unfinished_image(b"abcdef", may_end), "read": begun(lambda: (1, 2.0))}
    writer, file = TreeWriter(), io.BytesIO()
    writer.write(writer.tree(kept, "sensors"), file)
    read = read_tree(file, "sensors", lambda tree, reader: reader.value(tree, "sensors"))
    assert type(read["said"]) is Image and read == {"said": kept["said"], "read": (1, 2.0)}
