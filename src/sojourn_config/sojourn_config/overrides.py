"""Values set on the command line: `--set battery_soc=0.5`, `--set soil.n=1`, `--set steps[0].wait_s=5`."""

import copy
import dataclasses
import re
from collections.abc import Sequence

from sojourn_config.errors import MISSING, single
from sojourn_config.extends import read_value
from sojourn_config.yaml_file import MOST_DEPTH, Data, KeyPath, YamlDocument

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


def override_document(document: YamlDocument, overrides: Sequence[str]) -> YamlDocument:
    """The document with every `KEY=VALUE` set, which remembers where each value is from. A key that is not there is
    added: the schema judges it. A value may build on a part: `sources.generator={extends: krusty}`.

    Raises:
        ConfigError: not KEY=VALUE, or a path that goes through a value that is no table or list; of the value see
            `read_value`.
    """
    if not overrides:
        return document
    data, texts = copy.deepcopy(document.data), dict(document.texts)
    set_by: dict[KeyPath, str] = {}
    for text in overrides:
        path, value_text = split_override(text)
        value, files = read_value(value_text, f"--set {text}")
        _set(data, path, value, text)
        set_by[path] = text
        texts |= files
    # what stood in a table that is replaced has no place any more
    lines = {path: line for path, line in document.lines.items() if not any(path[: len(key)] == key for key in set_by)}
    return dataclasses.replace(document, data=data, lines=lines, overridden=document.overridden | set_by, texts=texts)


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
