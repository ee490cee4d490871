"""A strict reader of YAML 1.2: plain data, the line of every key, and nothing that could surprise.

Scalars follow the core schema of YAML 1.2.2 (section 10.3.2): `820e3` is a number, `on` and `12:30` are text.
Refused: a key that is there twice, aliases, tags, keys that are no text, more than one document.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import yaml
from yaml.nodes import MappingNode, ScalarNode, SequenceNode

from sojourn_config.errors import MISSING, ConfigError, Problem, shown
from sojourn_config.paths import display

Scalar = str | int | float | bool | None
Data = Scalar | list["Data"] | dict[str, "Data"]
KeyPath = tuple[str | int, ...]

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""libyaml's, where PyYAML was built with it: the same language, much faster."""
_INTEGER = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"[-+]?\.(inf|Inf|INF)")
_NAN = frozenset((".nan", ".NaN", ".NAN"))
_NULL = frozenset(("null", "Null", "NULL", "~", ""))
_TRUE = frozenset(("true", "True", "TRUE"))
_FALSE = frozenset(("false", "False", "FALSE"))
_PLAIN_TAGS = frozenset(
    f"tag:yaml.org,2002:{name}" for name in ("map", "seq", "str", "int", "float", "bool", "null", "timestamp")
)
MOST_BYTES = 1_000_000
"""Of a file."""
MOST_DEPTH = 32
"""Tables and lists inside each other."""
MOST_VALUES = 20_000
"""Keys, values, tables and lists of a file. The largest of ours has some hundred."""
_LONGEST_NUMBER = 300
"""Longer digits are read as a float, which is then infinite and refused."""


@dataclass
class YamlDocument:
    """One file.

    Args:
        file: its name for messages.
        data: its content: a table.
        lines: line of each key, by path.
        overridden: text of the override that set a key, by path.
        origins: file in which a key is written, by path, where that is another one (`extends`).
        texts: text of every file that it is made of, by name.
        derived: from what a value follows that no file says, by path, see `derived`.
    """

    file: str
    data: dict[str, Data]
    lines: dict[KeyPath, int] = field(default_factory=dict)
    overridden: dict[KeyPath, str] = field(default_factory=dict)
    origins: dict[KeyPath, Path] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    derived: dict[KeyPath, str] = field(default_factory=dict)

    def place(self, path: KeyPath) -> tuple[str, int | None]:
        """File and line of the key at `path`, or of the nearest table around it; or the override of it; or from what
        it follows.
        """
        if path and path not in self.lines:  # a table that only the command line has
            for inner, text in self.overridden.items():
                if inner[: len(path)] == path:
                    return f"--set {text} (in {self.file})", None
        for length in range(len(path), 0, -1):
            if path[:length] in self.derived:
                return self.derived[path[:length]], None
            if path[:length] in self.overridden:
                return f"--set {self.overridden[path[:length]]} (in {self.file})", None
            if path[:length] in self.lines:
                origin = self.origins.get(path[:length])
                return self.file if origin is None else display(origin), self.lines[path[:length]]
        return self.file, None

    def problem(self, path: KeyPath, value: object, allowed: str) -> Problem:
        """A problem with the key at `path`; the value MISSING shows none."""
        file, line = self.place(path)
        return Problem(file, dotted(path), "" if value is MISSING else shown(value), allowed, line)


def asking_folders(document: YamlDocument, path: KeyPath, folder: Path) -> tuple[Path, Path]:
    """Where a path counts from that stands at a key, the first choice first: the folder of the file that has the key,
    and the working folder; the other way round where the command line has set it.

    Args:
        folder: of the document's own file.
    """
    origin = document.origins.get(path)
    folder = folder if origin is None else origin.parent
    overridden = any(path[:length] in document.overridden for length in range(1, len(path) + 1))
    return (Path.cwd(), folder) if overridden else (folder, Path.cwd())


def plain_scalar(text: str) -> Scalar:
    """The value of an unquoted scalar by the core schema of YAML 1.2."""
    if text in _NULL:
        return None
    if text in _TRUE:
        return True
    if text in _FALSE:
        return False
    if len(text) <= _LONGEST_NUMBER:
        if _INTEGER.fullmatch(text):
            return int(text)
        if _OCTAL.fullmatch(text):
            return int(text[2:], 8)
        if _HEXADECIMAL.fullmatch(text):
            return int(text[2:], 16)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _INFINITE.fullmatch(text):
        return float(text.replace(".", ""))
    return float("nan") if text in _NAN else text


def read_yaml(path: Path) -> YamlDocument:
    """Read a file.

    Raises:
        ConfigError: it cannot be read, is not YAML, or holds something that is refused (see the module).
    """
    file = display(path)
    try:
        with path.open("rb") as stream:
            content = stream.read(MOST_BYTES + 1)
        if len(content) > MOST_BYTES:
            raise ConfigError([Problem(file, "", "", f"allowed are at most {MOST_BYTES} bytes")])
        text = content.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError([Problem(file, "", "", f"cannot be read: {error}")]) from error
    return parse_yaml(text, file)


def parse_yaml(text: str, file: str) -> YamlDocument:
    """As `read_yaml`, from text; `file` is the name for messages.

    Raises:
        ConfigError: as `read_yaml`.
    """
    try:
        _check_size(text, file)
        root = yaml.compose(text, Loader=_Loader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        reason = getattr(error, "problem", None) or " ".join(str(error).split())
        line = None if mark is None else int(mark.line) + 1
        raise ConfigError([Problem(file, "", "", f"not a YAML document: {reason}", line)]) from error
    if not isinstance(root, MappingNode):
        raise ConfigError([Problem(file, "", "", "allowed is a table of keys and values that is not empty")])
    document = YamlDocument(file, {}, texts={file: text})
    reader = _NodeReader(document)
    data = reader.convert(root, ())
    if reader.problems:
        raise ConfigError(reader.problems)
    if isinstance(data, dict):
        document.data = data
    return document


def _check_size(text: str, file: str) -> None:
    """Refuse what is too deep or too much before anything is made of it. Raises ConfigError, yaml.YAMLError."""
    depth = values = 0
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        values += isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent)
        if depth > MOST_DEPTH or values > MOST_VALUES:
            what = f"{MOST_DEPTH} tables and lists inside each other" if depth > MOST_DEPTH else f"{MOST_VALUES} values"
            line = None if event.start_mark is None else int(event.start_mark.line) + 1
            raise ConfigError([Problem(file, "", "", f"too large a YAML document: allowed are at most {what}", line)])


def parse_value(text: str, file: str) -> Data:
    """The value of a `KEY=VALUE` of the command line: number, true, false, null, text, or a [list].

    Raises:
        ConfigError: it is not YAML.
    """
    return parse_yaml(f"value: {text}", file).data["value"]


class _NodeReader:
    """Turns nodes into plain data and collects what is refused."""

    def __init__(self, document: YamlDocument) -> None:
        self.document = document
        self.problems: list[Problem] = []
        self.seen: set[int] = set()

    def convert(self, node: object, path: KeyPath) -> Data:
        if id(node) in self.seen:
            # the node is where the anchor stands: the key that asks for it has its own line
            line = self.document.lines.get(path)
            reason = "an alias is not used here: write the value out"
            self.problems.append(Problem(self.document.file, dotted(path), "", reason, line))
            return None
        self.seen.add(id(node))
        if isinstance(node, ScalarNode):
            return self._scalar(node, path)
        if not isinstance(node, MappingNode | SequenceNode):
            return None
        if str(node.tag) not in _PLAIN_TAGS:
            self._refuse(node, path, f"the tag {node.tag} is not used here: allowed are plain values")
        if isinstance(node, SequenceNode):
            items: list[Data] = []
            for index, item in enumerate(node.value):
                self.document.lines[(*path, index)] = item.start_mark.line + 1
                items.append(self.convert(item, (*path, index)))
            return items
        return self._table(node, path)

    def _table(self, node: MappingNode, path: KeyPath) -> dict[str, Data]:
        table: dict[str, Data] = {}
        for key_node, value_node in node.value:
            key = self._scalar(key_node, path) if isinstance(key_node, ScalarNode) else None
            if not isinstance(key, str) or key == "<<":
                self._refuse(key_node, path, "allowed as a key is text only")
                continue
            line = key_node.start_mark.line + 1
            if key in table:
                first = self.document.lines[(*path, key)]
                self._refuse(key_node, (*path, key), f"the key is there twice, first on line {first}")
                continue
            self.document.lines[(*path, key)] = line
            table[key] = self.convert(value_node, (*path, key))
        return table

    def _scalar(self, node: ScalarNode, path: KeyPath) -> Scalar:
        if str(node.tag) not in _PLAIN_TAGS:
            self._refuse(node, path, f"the tag {node.tag} is not used here: allowed are plain values")
        text = str(node.value)
        return text if node.style else plain_scalar(text)

    def _refuse(self, node: object, path: KeyPath, reason: str) -> None:
        mark = getattr(node, "start_mark", None)
        line = None if mark is None else int(mark.line) + 1
        self.problems.append(Problem(self.document.file, dotted(path), "", reason, line))


def dotted(path: KeyPath) -> str:
    """`("steps", 0, "wait_s")` as `steps[0].wait_s`."""
    text = ""
    for item in path:
        text += f"[{item}]" if isinstance(item, int) else (f".{item}" if text else item)
    return text
