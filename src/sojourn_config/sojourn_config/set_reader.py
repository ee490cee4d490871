"""Reads parameter sets one after the other and collects the problems of all of them."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Generic, NamedTuple, TypeVar

from pydantic import BaseModel

from sojourn_config.errors import ConfigError, Problem
from sojourn_config.extends import read_document
from sojourn_config.load import validate
from sojourn_config.overrides import override_document
from sojourn_config.paths import SUFFIX, resolve, resolve_urdf
from sojourn_config.urdf import UrdfSummary, parse_urdf, read_urdf
from sojourn_config.yaml_file import YamlDocument, asking_folders, dotted
from sojourn_flight.arm.dh import DhTable
from sojourn_flight.arm.dh_urdf import urdf_from_dh

Model = TypeVar("Model", bound=BaseModel)


class Referrer(NamedTuple):
    """Who names a set: a document, and its path."""

    document: YamlDocument
    path: Path


class ReadSet(NamedTuple, Generic[Model]):
    """A parameter set with what it was read from."""

    params: Model
    document: YamlDocument
    path: Path

    @property
    def asked(self) -> Referrer:
        """This set as the one that names others."""
        return Referrer(self.document, self.path)


class SetReader:
    """Reads sets; what is wrong goes into `problems`, what was read into `files`.

    Args:
        overrides: `KEY=VALUE` texts by what they are for.
    """

    def __init__(self, overrides: dict[str, list[str]]) -> None:
        self.problems: list[Problem] = []
        self.files: dict[str, str] = {}
        self.overrides = overrides

    def place(self, kind: str, name: str, key: str, asked: Referrer) -> Path | None:
        """The file that a key names; None with the reason in `problems`."""
        folders = asking_folders(asked.document, (key,), asked.path.parent)
        try:
            return resolve(kind, name, (asked.document.place((key,))[0], key), folders)
        except ConfigError as error:
            self.problems += _with_line(error.problems, asked.document, key)
            return None

    def document(self, path: Path, kind: str, overrides: Sequence[str] = ()) -> YamlDocument | None:
        """A file with all that it builds on and the overrides over it; None with the reason in `problems`."""
        try:
            found = override_document(read_document(path, kind), overrides)
            self.files |= found.texts
            return found
        except ConfigError as error:
            self.problems += error.problems
            return None

    def validated(self, document: YamlDocument, path: Path, model: type[Model]) -> "ReadSet[Model] | None":
        """The set in a document; None with the reason in `problems`."""
        try:
            return ReadSet(validate(document, model), document, path)
        except ConfigError as error:
            self.problems += error.problems
            return None

    def load(self, kind: str, name: str, key: str, model: type[Model], asked: Referrer) -> "ReadSet[Model] | None":
        """The set that a key names; None with the reason in `problems`."""
        path = self.place(kind, name, key, asked)
        document = None if path is None else self.document(path, kind, self.overrides.get(key, ()))
        return None if path is None or document is None else self.validated(document, path, model)

    def named(self, kind: str, name: str, key: str, model: type[Model], asked: Referrer) -> "ReadSet[Model] | None":
        """A set that carries its own name, which must be that of its file."""
        found = self.load(kind, name, key, model, asked)
        if found is None:
            return None
        own_name = getattr(found.params, "name", found.path.stem)
        if own_name != found.path.stem:
            allowed = f"allowed is the name of the file, {found.path.stem}"
            self.problems.append(found.document.problem(("name",), own_name, allowed))
            return None
        return found

    def urdf(self, name: str, asked: Referrer) -> UrdfSummary | None:
        """The URDF that the key `urdf` names, or that a Denavit-Hartenberg table comes to; None with the reason."""
        folder = asked.document.origins.get(("urdf",), asked.path).parent
        try:
            path = resolve_urdf(name, (asked.document.place(("urdf",))[0], "urdf"), folder)
            if path.suffix == SUFFIX:
                return self._urdf_of_table(path)
            urdf = read_urdf(path)
        except ConfigError as error:
            self.problems += _with_line(error.problems, asked.document, "urdf")
            return None
        self.files[urdf.file] = urdf.text
        return urdf

    def _urdf_of_table(self, path: Path) -> UrdfSummary:
        """The URDF that a Denavit-Hartenberg table comes to. Raises ConfigError."""
        table = read_document(path, "arms")
        self.files |= table.texts
        return parse_urdf(urdf_from_dh(validate(table, DhTable), table.file), table.file)

    def refuse_overrides(self, head: str, reason: str) -> None:
        """Overrides for a set that there is not."""
        for text in self.overrides.get(head, ()):
            self.problems.append(Problem(f"--set {head}.{text}", "", "", reason))


def _with_line(problems: Sequence[Problem], document: YamlDocument, key: str) -> list[Problem]:
    """Add the line of the key that named a set to the problems that are about that key."""
    file, line = document.place((key,))
    return [
        dataclasses.replace(problem, line=line)
        if problem.file == file and problem.key == dotted((key,)) and problem.line is None
        else problem
        for problem in problems
    ]
