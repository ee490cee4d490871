"""What somebody else brings: a package with entry points, files in a folder of his own; our programs in his shell."""

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from programs import Program

from sojourn_bags.reading import Bag, read_bag

GO_ON = """
import sys
from pathlib import Path

from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import encode
from sojourn_stack.apps import make_apps
from sojourn_stack.checkpoint import load, save
from sojourn_stack.stack import Stack

scenario, file, role, holds, *roles = sys.argv[1:]

def made():
    return Stack(make_apps(load_scenario(scenario), roles), roles)

def remembers(state):
    return eval(holds, {"app": state.roles[role].app})

def after(stack, state, periods):
    told = []
    for _ in range(periods):
        state, said = stack.step(state)
        told += [(row.name, encode(row, message)) for row, message in said]
    return told

stack = made()
state, _ = stack.begin()
while not remembers(state) and state.period < 500:
    state, _ = stack.step(state)
save(state, Path(file))
again = load(Path(file))
assert remembers(again), "what was to be remembered is not in the file"
assert after(made(), again, 30) == after(stack, state, 30), "it goes on in another way"
print("it goes on as it was")
"""


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

    def goes_on(self, roles: Sequence[str], role: str, holds: str) -> str:
        """What is said of a stack of roles that is saved as soon as an expression holds of the `app` state of one of
        them, and of another that goes on from the file: "it goes on as it was".
        """
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(self.base), os.environ.get("PYTHONPATH", "")])}
        given = [sys.executable, "-c", GO_ON, str(self.scenario), str(self.base / "one.checkpoint"), role, holds]
        run = subprocess.run([*given, *roles], env=environment, capture_output=True, text=True, check=False)
        return run.stdout + run.stderr

    def end(self) -> None:
        for program in self.programs:
            program.end()
