"""Files that build on others: `extends: NAME` in any table says what it has where it does not say otherwise.

Tables are merged key by key, at every depth; anything else, a list too, takes the place of what the base has there. The
base is a file: a path, which counts from the folder of the file that names it, or a name, which is looked for in that
same folder, among the sets of its kind, and in `config/parts`. A base may have a base. Every key remembers the file and
the line where it is written.
"""

from copy import deepcopy
from pathlib import Path
from typing import NamedTuple

from sojourn_config.errors import ConfigError
from sojourn_config.paths import SUFFIX, config_folder, display, is_path, named_file
from sojourn_config.yaml_file import Data, KeyPath, YamlDocument, dotted, parse_yaml, read_yaml
from sojourn_machine.names import names_text

EXTENDS = "extends"
PARTS = "parts"


def read_document(path: Path, kind: str = PARTS) -> YamlDocument:
    """A file with all that it builds on.

    Args:
        kind: folder of `config/` whose sets may be named.

    Raises:
        ConfigError: a file cannot be read or is no YAML, see `read_yaml`; a base that is not there, or a ring of them.
    """
    return _SetReader(kind).read(path, ())


def read_value(text: str, asked_by: str) -> tuple[Data, dict[str, str]]:
    """A value of the command line, with all that tables in it build on: sets of `config/parts`, paths from the working
    folder.

    Args:
        text: number, true, false, null, text, a [list] or a {table}. asked_by: for messages.

    Returns:
        the value, and the text of every file that it is made of, by name.

    Raises:
        ConfigError: it is not YAML; or as `read_document`.
    """
    plain = parse_yaml(f"value: {text}", asked_by)
    layer = _Layer(_SetReader(PARTS), plain, Path.cwd() / "--set", ())
    value = layer.table(plain.data, ())["value"]
    return value, {name: text for name, text in layer.merged.texts.items() if name != asked_by}


class _Base(NamedTuple):
    """What a table builds on: a file, and the place of the table."""

    document: YamlDocument
    path: Path
    root: KeyPath


class _SetReader:
    def __init__(self, kind: str) -> None:
        self.folders = tuple(config_folder() / name for name in dict.fromkeys((kind, PARTS)))
        self._bases: dict[Path, YamlDocument] = {}

    def base(self, path: Path, above: tuple[Path, ...]) -> YamlDocument:
        """As `read`; six wheels that build on one file read it once."""
        if path not in self._bases:
            self._bases[path] = self.read(path, above)
        return self._bases[path]

    def read(self, path: Path, above: tuple[Path, ...]) -> YamlDocument:
        """The file, which was named by the last of the files above it."""
        plain = read_yaml(path)
        layer = _Layer(self, plain, path, above)
        layer.merged.data = layer.table(plain.data, ())
        return layer.merged


class _Layer:
    """One file while its tables are laid over those that they build on."""

    def __init__(self, reader: _SetReader, plain: YamlDocument, path: Path, above: tuple[Path, ...]) -> None:
        self.reader, self.plain, self.path, self.above = reader, plain, path, above
        self.merged = YamlDocument(plain.file, {}, texts=dict(plain.texts))

    def table(self, own: dict[str, Data], at: KeyPath) -> dict[str, Data]:
        filled = {key: self.value(value, (*at, key)) for key, value in own.items() if key != EXTENDS}
        if EXTENDS not in own:
            return filled
        path = self.base_path(own[EXTENDS], (*at, EXTENDS))
        base = _Base(self.reader.base(path, (*self.above, self.path)), path, at)
        self.merged.texts.update(base.document.texts)
        return self.over(base, base.document.data, filled, at)

    def value(self, value: Data, at: KeyPath) -> Data:
        if at in self.plain.lines:
            self.merged.lines[at] = self.plain.lines[at]
        if isinstance(value, dict):
            return self.table(value, at)
        if isinstance(value, list):
            return [self.value(item, (*at, index)) for index, item in enumerate(value)]
        return value

    def over(self, base: _Base, below: dict[str, Data], own: dict[str, Data], at: KeyPath) -> dict[str, Data]:
        """`own` over the base's table at the same place, in the base's order."""
        merged: dict[str, Data] = {}
        for key, value in below.items():
            ours = own.get(key)
            if key not in own:
                merged[key] = deepcopy(value)  # another table that builds on the same may be set apart
                self.take_places(base, (*at, key))
            elif isinstance(value, dict) and isinstance(ours, dict):
                merged[key] = self.over(base, value, ours, (*at, key))
            else:
                merged[key] = ours
        return {**merged, **{key: value for key, value in own.items() if key not in below}}

    def take_places(self, base: _Base, at: KeyPath) -> None:
        """File and line of a key of the base and of all within it."""
        there = at[len(base.root) :]
        for path, line in base.document.lines.items():
            if path[: len(there)] == there:
                self.merged.lines[(*base.root, *path)] = line
                self.merged.origins[(*base.root, *path)] = base.document.origins.get(path, base.path)

    def base_path(self, name: Data, at: KeyPath) -> Path:
        """The file that an `extends` names. Raises ConfigError."""
        if not isinstance(name, str) or not name:
            raise self.problem(at, name, "allowed is the name of a file to build on, or its path")
        folder, asked_by = self.path.parent, (self.plain.file, dotted(at))
        folders = tuple(dict.fromkeys((folder, *self.reader.folders)))
        if is_path(name):
            found = named_file(name, asked_by, folder, Path.cwd())
        else:
            found = named_file(name + SUFFIX, asked_by, *folders)
        if found is None:
            known = {path.stem for each in folders for path in each.glob(f"*{SUFFIX}") if path != self.path}
            where = (
                "there is no such file; without a path"
                if is_path(name)
                else f"not in {' or '.join(map(display, folders))}"
            )
            raise self.problem(at, name, f"{where}: {names_text(Path(name).stem, known)}")
        chain = [each.resolve() for each in (*self.above, self.path)]
        if found.resolve() in chain:
            ring = " -> ".join(display(each) for each in (*chain[chain.index(found.resolve()) :], found))
            raise self.problem(at, name, f"files that build on each other in a ring: {ring}")
        return found

    def problem(self, at: KeyPath, value: object, allowed: str) -> ConfigError:
        return ConfigError([self.plain.problem(at, value, allowed)])
