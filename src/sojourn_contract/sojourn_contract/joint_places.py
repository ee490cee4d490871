"""Where joints of ours stand in the messages of somebody else, who may order and name them as he likes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.values import JointState


class JointPlaces:
    """Places of some joints in the JointStates of one topic; looked up again only when the names change.

    Args:
        topic: for the reason of a refusal. joints: names, in the order in which they are wanted.
    """

    def __init__(self, topic: str, joints: Sequence[str]) -> None:
        self._topic = topic
        self._joints = tuple(joints)
        self._names: tuple[str, ...] | None = None
        self._places: NDArray[np.intp] = np.zeros(0, dtype=np.intp)

    def places(self, message: JointState) -> NDArray[np.intp]:
        """Index of each joint in the arrays of `message`, shape (joints,).

        Raises:
            RefusedMessageError: a joint is not named.
        """
        if self._names != message.names:
            names = message.names
            index = {name: place for place, name in enumerate(names)}
            for joint in self._joints:
                if joint not in index:
                    raise RefusedMessageError(self._topic, "name", ", ".join(names), f"{joint} among them")
            self._names = names
            self._places = np.array([index[joint] for joint in self._joints], dtype=np.intp)
        return self._places
