"""The domains that tests take for themselves: see test/domains.py."""

import itertools

import pytest

import domains
from sojourn_bringup.instance import RoleTokens


@pytest.mark.parametrize("namespace", ["", "/second"])
def test_a_domain_on_which_a_run_still_ends_is_not_given_out(namespace: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has let go of its ports, and not yet of its roles."""
    with domains.own_domain() as number:
        pass
    monkeypatch.setattr(domains, "_next", itertools.count(number - 1))
    with RoleTokens(number, namespace, ("plant",)), domains.own_domain() as other:
        assert other != number
