"""Who runs a role: asked as often as anybody likes, without a wait, and without a trace at who holds it."""

import os

from sojourn_bringup.instance import RoleTokens
from sojourn_config.role_holder import held_roles, holder_of

DOMAIN, NAMESPACE = 230, "/asked_often"
OFTEN = 5000
"""More than the calls that wait at a socket, on any machine (somaxconn is 4096)."""


def test_the_roles_that_are_held_are_known_however_often_one_asks() -> None:
    with RoleTokens(DOMAIN, NAMESPACE, ("plant", "drive")):
        for _ in range(20):
            assert held_roles(DOMAIN, NAMESPACE, ("plant", "arm", "drive")) == ["plant", "drive"]
        assert held_roles(DOMAIN, "", ("plant",)) == []
        assert holder_of(DOMAIN, NAMESPACE, "plant") == os.getpid()
    assert held_roles(DOMAIN, NAMESPACE, ("plant", "arm", "drive")) == []


def test_a_holder_whose_queue_is_full_makes_nobody_wait() -> None:
    """A goal client asked twenty times a second: the eighth hung for as long as the stack ran."""
    with RoleTokens(DOMAIN, NAMESPACE, ("plant",)):
        found = [holder_of(DOMAIN, NAMESPACE, "plant") for _ in range(OFTEN)]
        assert found[0] == os.getpid() and found[-1] == 0
        assert held_roles(DOMAIN, NAMESPACE, ("plant",)) == ["plant"]
