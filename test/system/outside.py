"""What somebody else brings: a package with entry points, files in a folder of his own; our programs in his shell."""

import os
from dataclasses import dataclass, field
from pathlib import Path

from programs import Program

from sojourn_bags.reading import Bag, read_bag


def known_by(base: Path, package: str, entry_points: str) -> None:
    """Make a package in a folder one that Python finds there, with its entry points."""
    known = base / f"{package}-1.0.dist-info"
    known.mkdir()
    (known / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n", encoding="utf-8")
    (known / "entry_points.txt").write_text(entry_points, encoding="utf-8")


@dataclass
class Stranger:
    """His folder, the scenario in it, and the programs that he has started."""

    base: Path
    scenario: Path
    programs: list[Program] = field(default_factory=list)

    def call(self, name: str, *arguments: object) -> Program:
        """One of our programs, in his shell."""
        outside = {"PYTHONPATH": os.pathsep.join([str(self.base), os.environ.get("PYTHONPATH", "")])}
        log = self.base / f"{len(self.programs)}.log"
        self.programs.append(Program(name, [str(argument) for argument in arguments], log, outside))
        return self.programs[-1]

    def bag(self, run: str) -> Bag:
        return read_bag(self.base / run)

    def end(self) -> None:
        for program in self.programs:
            program.end()
