"""Values set on the command line: `--set battery_soc=0.5`, `--set soil.n=1`, `--set steps[0].wait_s=5`."""

import copy
import dataclasses
import re
from collections.abc import Sequence

from sojourn_config.errors import MISSING, single
from sojourn_config.yaml_file import MOST_DEPTH, Data, KeyPath, YamlDocument, parse_value

BELIEF = "belief"
"""First word of an override that changes what the machine's own computer takes for true."""
_PART = re.compile(r"([^\[\].=]+)((?:\[[0-9]{1,6}\])*)")


def split_override(text: str) -> tuple[KeyPath, str]:
    """`a.b[0].c=1` as the path (a, b, 0, c) and the text `1`.

    Raises:
        ConfigError: it is not KEY=VALUE.
    """
    key, separator, value = text.partition("=")
    path: list[str | int] = []
    for part in key.strip().split("."):
        match = _PART.fullmatch(part.strip())
        if match is None or not separator:
            allowed = "allowed is KEY=VALUE, the key with dots: start.yaw=0.5"
            raise single(f"--set {text}", "", MISSING, allowed)
        path.append(match.group(1))
        path.extend(int(index) for index in re.findall(r"[0-9]+", match.group(2)))
    if len(path) > MOST_DEPTH:
        raise single(f"--set {text[:40]}...", "", MISSING, f"allowed are at most {MOST_DEPTH} parts of a key")
    return tuple(path), value.strip()


def apply_overrides(data: dict[str, Data], overrides: Sequence[str]) -> dict[str, Data]:
    """A copy of `data` with every `KEY=VALUE` set. A key that is not there is added: the schema judges it.

    Raises:
        ConfigError: not KEY=VALUE, or a path that goes through a value that is no table or list.
    """
    result = copy.deepcopy(data)
    for text in overrides:
        path, value = split_override(text)
        _set(result, path, parse_value(value, f"--set {text}"), text)
    return result


def override_document(document: YamlDocument, overrides: Sequence[str]) -> YamlDocument:
    """The document with overrides applied, which remembers where each value is from.

    Raises:
        ConfigError: as `apply_overrides`.
    """
    if not overrides:
        return document
    changed = dict(document.overridden)
    changed.update((split_override(text)[0], text) for text in overrides)
    return dataclasses.replace(document, data=apply_overrides(document.data, overrides), overridden=changed)


def route_overrides(
    overrides: Sequence[str], heads: Sequence[str], tables: Sequence[str] = ()
) -> tuple[list[str], dict[str, list[str]]]:
    """Sort overrides by the file they are for.

    `soil.k_c=1400` with the head `soil` is `k_c=1400` for the file that `soil` names; `soil=jsc_1a` stays.

    Args:
        heads: first words that are for such files. tables: those of them that are tables in a file: what begins with
            one goes there as it is, `sources.array.clean=0.8`, and may be of a whole table, `sources={}`.

    Returns:
        those that stay, and those of each head, without it where it stands for a file.

    Raises:
        ConfigError: it is not KEY=VALUE.
    """
    stay: list[str] = []
    routed: dict[str, list[str]] = {head: [] for head in heads}
    for text in overrides:
        path, _ = split_override(text)
        head = path[0]
        if head in tables:
            routed[str(head)].append(text.strip())
        elif len(path) > 1 and isinstance(head, str) and head in routed and isinstance(path[1], str):
            routed[head].append(text.strip().partition(".")[2])
        else:
            stay.append(text)
    return stay, routed


def _set(data: dict[str, Data], path: KeyPath, value: Data, text: str) -> None:
    here: Data = data
    for depth, part in enumerate(path):
        last = depth == len(path) - 1
        if isinstance(here, dict) and isinstance(part, str):
            if last:
                here[part] = value
                return
            here = here.setdefault(part, {})
        elif isinstance(here, list) and isinstance(part, int) and part < len(here):
            if last:
                here[part] = value
                return
            here = here[part]
        elif isinstance(here, list):
            allowed = f"{part!r} is no index of a list of {len(here)}"
            raise single(f"--set {text}", "", MISSING, allowed)
        else:
            raise single(f"--set {text}", "", MISSING, f"{part!r} is asked of a value that is no table")


def split_beliefs(
    overrides: Sequence[str], heads: Sequence[str], tables: Sequence[str] = ()
) -> tuple[list[str], list[str]]:
    """Those that are true, and those that are believed alone, `belief.battery.capacity_ah=20`, without that word.

    Args:
        heads, tables: as for `route_overrides`.

    Raises:
        ConfigError: it is not KEY=VALUE, or a belief about what is in none of the files of `heads`.
    """
    true: list[str] = []
    believed: list[str] = []
    for text in overrides:
        path, _ = split_override(text)
        if path[0] != BELIEF:
            true.append(text)
        elif (len(path) > 2 and path[1] in heads) or (len(path) == 2 and path[1] in tables):
            believed.append(text.strip().partition(".")[2])
        else:
            allowed = f"allowed is {BELIEF}.FILE.KEY=VALUE with FILE one of " + ", ".join(sorted(heads))
            raise single(f"--set {text}", ".".join(map(str, path)), MISSING, allowed)
    return true, believed
