"""Writes a made-up run of the contract tests as a bag, as our recorder would."""

from pathlib import Path

from clean_run import PERIOD, PERIODS, CleanRun
from synthetic import CHANNELS, cdr

from sojourn_bags.completeness import RECORD, account
from sojourn_bags.definitions import RUN_RECORD, ChannelSpec, qos_entry
from sojourn_bags.description import Run
from sojourn_bags.writer import Attachment, BagWriter
from sojourn_config.scenario import load_scenario
from sojourn_contract import qos
from sojourn_contract.topics import ROLES, TOPICS


def write(
    folder: Path,
    run: CleanRun,
    *,
    contract: Attachment | None = None,
    lockstep: bool = True,
    described: bool = True,
    types: dict[str, str] | None = None,
    offered: dict[str, str] | None = None,
) -> Path:
    """Write a run as our recorder would. types, offered: by topic, another type or reliability than the table's."""
    specs = []
    for row in TOPICS:
        entry = qos_entry(qos.profile(row, lockstep, row.publisher))
        entry["reliability"] = (offered or {}).get(row.name, entry["reliability"])
        specs.append(ChannelSpec(row.name, (types or {}).get(row.name, row.type), entry))
    attachments = Run.of_scenario(load_scenario("flat_drive")).attachments() if described else []
    writer = BagWriter(folder, specs, [*attachments, *([contract] if contract else [])])
    for entry in sorted(run.entries, key=lambda entry: entry.logged or 0):
        data = entry.message if isinstance(entry.message, bytes) else cdr(entry.message)
        writer.write(CHANNELS[entry.topic], entry.logged or 0, entry.stamp, data)
    recorded = writer.recorded()
    record = {"participants": ",".join(ROLES), "lockstep": str(lockstep).lower()}
    records = {RUN_RECORD: record, RECORD: account(TOPICS, recorded, recorded, PERIODS * PERIOD).as_record()}
    writer.close(records if contract else {})
    return folder
