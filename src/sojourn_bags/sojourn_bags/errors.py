"""Errors of the bags: each names the file or topic, what is wrong, and what to do."""

from pathlib import Path


class BagsError(Exception):
    """Base of every error raised by sojourn_bags."""


class UnwritableBagError(BagsError):
    """The folder of a bag, or a file in it, cannot be written.

    Args:
        folder: the bag's folder.
        reason: what the operating system says, or what stands in the way.
    """

    def __init__(self, folder: Path, reason: str) -> None:
        super().__init__(f"the bag {folder} cannot be written: {reason}")
        self.folder = folder


class BagExistsError(BagsError):
    """There is a bag in the folder already. Bags are never written over."""

    def __init__(self, folder: Path) -> None:
        super().__init__(f"there is a bag in {folder} already, and bags are never written over: name another folder")
        self.folder = folder


class UnreadableBagError(BagsError):
    """A file or folder that is no bag.

    Args:
        path: what was to be read.
        reason: why it cannot be.
    """

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path} cannot be read as a bag: {reason}")
        self.path, self.reason = path, reason


class UnreadableMessageError(BagsError):
    """Bytes in a bag that are no message of their topic's type."""

    def __init__(self, type_name: str, size: int, reason: str) -> None:
        super().__init__(f"{size} bytes are no {type_name}: {reason}")


class NothingToRecoverError(BagsError):
    """A bag that ends before its first message."""

    def __init__(self, path: Path) -> None:
        super().__init__(f"{path} holds no whole message: there is nothing to recover")
        self.path = path


class UnknownTopicInBagError(BagsError):
    """A topic or field that the bag does not hold.

    Args:
        name: what was asked for.
        known: what there is.
    """

    def __init__(self, name: str, known: list[str]) -> None:
        super().__init__(f"{name} is not in the bag: there are {', '.join(known) or 'no messages'}")
        self.name = name


class UnknownFieldError(BagsError):
    """A topic or field that cannot be drawn.

    Args:
        name: what was asked for. why: what is wrong with it. nearest: names that there are and that look like it.
    """

    def __init__(self, name: str, why: str, nearest: list[str]) -> None:
        hint = f": nearest are {', '.join(nearest)}" if nearest else ""
        super().__init__(f"{name} {why}{hint}")
        self.name, self.nearest = name, nearest


class IncompleteConfigError(BagsError):
    """The configuration lacks something that a summary or report needs."""


class OtherContractError(BagsError):
    """A bag that was recorded under another contract than ours.

    Args:
        path: the bag. reason: what is not ours.
    """

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path} is a bag of another contract: {reason}")
        self.path = path


class ReplayError(BagsError):
    """A bag that cannot be replayed through a role, or a candidate that cannot be judged by it."""


class UnansweredError(ReplayError):
    """A candidate that did not answer, or has ended.

    Args:
        words: one sentence that says who did not answer what, and when.
    """


class TransformTypeError(BagsError):
    """The class of tf2_msgs/TFMessage is neither installed nor can it be made."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"tf2_msgs is not installed, and its message cannot be made here: {reason}")
