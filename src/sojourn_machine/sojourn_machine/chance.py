"""Chance as a function of numbers, for what must come out alike wherever and however often it is asked: no state.

A counter-based generator: SplitMix64 (Steele, Lea and Flood 2014, figure 15) of stream, salt and number one after the
other.
"""

from zlib import crc32

_WORD = 2**64
_GOLDEN, _FIRST, _SECOND = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
"""Increment and multipliers of SplitMix64."""


def stream_of(seed: int, name: str) -> int:
    """The stream of what has a name, 64 bits."""
    return (seed << 32 ^ crc32(name.encode())) % _WORD


def chance(stream: int, salt: int, number: int) -> float:
    """Even in [0, 1): the `number`-th of a stream; `salt` tells apart what it is asked for."""
    return mixed(mixed(mixed(stream) + salt) + number) / _WORD


def mixed(word: int) -> int:
    """The output of SplitMix64 from a state of 64 bits."""
    word = (word + _GOLDEN) % _WORD
    word = (word ^ (word >> 30)) * _FIRST % _WORD
    word = (word ^ (word >> 27)) * _SECOND % _WORD
    return word ^ (word >> 31)
