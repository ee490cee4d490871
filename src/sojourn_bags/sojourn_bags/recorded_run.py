"""The run that a bag is of, and its recording: the same for the recorder's node and for a run without middleware."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sojourn_bags.definitions import ChannelSpec, qos_entry
from sojourn_bags.onset import WHOLE, Onset
from sojourn_bags.provenance import attachments, run_attachment
from sojourn_bags.recording import RECORDER, Recording
from sojourn_bags.transforms import channel as transform_channel
from sojourn_bags.writer import BagWriter
from sojourn_config.paths import display
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract import qos
from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.run_table import table_of


@dataclass(frozen=True)
class RecordedRun:
    """Who takes part in a run and how.

    Args:
        scenario: name or file. overrides: KEY=VALUE texts that go over it. participants: all roles.
        lockstep: mode of time. namespace: ROS namespace of the topics.
        loaded: the scenario where it has been read before; else it is read here.
        onset: where in the run the record begins.
    """

    scenario: str
    overrides: Sequence[str]
    participants: Sequence[str]
    lockstep: bool = True
    namespace: str = "/"
    loaded: LoadedScenario | None = None
    onset: Onset = WHOLE

    def record(self) -> dict[str, str]:
        """As the bag has it."""
        path = Path(self.scenario)
        return {
            # not the place of the checkout on this machine
            "scenario": display(path) if path.is_absolute() else self.scenario,
            "lockstep": str(self.lockstep).lower(),
            "participants": ",".join(self.participants),
            "namespace": self.namespace,
            **self.onset.record(),
        }

    def open(
        self,
        folder: Path,
        refuse: Callable[[str, str], None],
        offered: Callable[[ChannelSpec], Sequence[dict[str, Any]]] | None = None,
    ) -> Recording:
        """Begin the bag.

        Args:
            folder: the bag; made here. refuse: of Recording. offered: of BagWriter.

        Raises:
            BagsError: it cannot be written. ConfigError: the scenario is wrong.
        """
        scenario = self.loaded or load_scenario(self.scenario, self.overrides)
        table = table_of(scenario)
        rows = table.inputs_of(RECORDER)
        channels = [
            ChannelSpec(row.name, row.type, qos_entry(qos.profile(row, self.lockstep, row.publisher))) for row in rows
        ]
        described = [*attachments(scenario), run_attachment(self.record())]
        writer = BagWriter(folder, [*channels, transform_channel()], described, offered)
        if scenario.config.bag_part_mb is not None:
            writer.largest_part = round(scenario.config.bag_part_mb * 1e6)
        awaited = awaited_inputs(RECORDER, self.participants, table)
        return Recording(
            writer, rows, awaited, self.participants, self.lockstep, refuse, self.onset, table.longest_leap
        )
