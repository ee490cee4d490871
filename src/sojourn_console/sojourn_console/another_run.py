"""Whether a run that is heard, or that has begun anew on the domain, is of the world that is shown.

A page is made for one machine on one ground. What is commanded by its picture to a run of another scenario goes where
nobody has looked: only what brings a machine to rest may be said to it.
"""

import json
from collections.abc import Mapping

from sojourn_bags.definitions import CONFIGURATION_NAME
from sojourn_bags.parts import is_finished
from sojourn_console.errors import NoWorldError
from sojourn_console.world import RunFiles, World, recorded_run

AGAIN_S = 2.0
"""Wall time from one look at the run's folder to the next: its bag may not be there yet."""


class AnotherRun:
    """Of one page.

    Args:
        world: that is shown.

    A run that is heard is not the one by whose bag the world was made, if that bag is finished.

    Attributes:
        refusal: why nothing is commanded but rest, in words; empty where anything may be.
        note: what is to be known of the run besides, in words.
    """

    def __init__(self, world: World) -> None:
        self._shown, self._name = world.run, world.scenario.name
        self._is_heard, self._is_asked, self._due = False, False, 0.0
        self.refusal = self.note = ""

    def begins(self) -> None:
        """Another run has begun: which it is has to be found out."""
        self._ask()
        if self._shown is None:
            self.note = f"another run has begun: what is shown is of {self._name}, with which the console was started"

    def _ask(self) -> None:
        self.refusal = self.note = ""
        self._is_asked, self._due = self._shown is not None, 0.0
        if self._shown is not None:
            self.refusal = (
                f"{self._shown.folder} does not say yet whether the run that is heard is of {self._name}, which is "
                "shown; if it is recorded elsewhere, start the console anew with its scenario or its --run-dir"
            )

    def look(self, now: float, is_heard: bool = True) -> None:
        """See at a wall time [s] whether the folder of the run says which it is. is_heard: a run at all."""
        shown = self._shown
        if is_heard and not self._is_heard:
            self._is_heard = True
            if shown is not None and is_finished(shown.folder):
                self._ask()
        if not self._is_asked or shown is None or now < self._due:
            return
        self._due = now + AGAIN_S
        try:
            found = recorded_run(shown.folder)
            before, after = described(shown), described(found)
        except NoWorldError:  # not yet
            return
        if before == after and found.is_file_of(shown):  # the new run is recorded elsewhere, if at all
            return
        self._is_asked, self.refusal = False, ""
        if before != after:
            name = name_of(after)
            of = name_of(before) if name != name_of(before) else "this one before its files were changed"
            self.refusal = f"another scenario runs ({name}): what is shown is of {of}; start the console anew"


def described(run: RunFiles) -> dict[str, bytes]:
    """What is attached to a bag of how its run was configured: every parameter set as it was used, and the files that
    were read. Raises NoWorldError where that is not all there.
    """
    try:
        names = json.loads(run.attachments[CONFIGURATION_NAME])["files"]
        return {name: run.attachments[name] for name in (CONFIGURATION_NAME, *names)}
    except (KeyError, TypeError, ValueError) as error:
        raise NoWorldError(f"{run.file} does not hold the configuration of its run ({error})") from error


def name_of(attached: Mapping[str, bytes]) -> str:
    """Name of a run's scenario, with what was set over its file."""
    document = json.loads(attached[CONFIGURATION_NAME])
    return " ".join((str(document.get("name", "?")), *map(str, document.get("overrides", ()))))
