"""The garbage collector of a program of ours: it makes many objects at its start, and few cycles ever."""

import gc

COLLECT_AFTER = 50_000
"""Objects made and not freed after which the garbage collector looks at the youngest."""


def collect_seldom() -> None:
    """Have its rounds come seldom: while libraries and kernels are loaded nothing is freed, as a round would find."""
    gc.set_threshold(COLLECT_AFTER)


def settle_collector() -> None:
    """Take what the start has made out of the garbage collector's rounds, and have these come seldom.

    Messages hold no cycles and go at once; a search through all loaded libraries every few periods finds
    nothing.
    """
    gc.collect()
    gc.freeze()
    collect_seldom()
