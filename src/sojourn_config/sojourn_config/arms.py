"""Arms by name: those of `urdf/`, those that machines carry, and any file with a URDF or a Denavit-Hartenberg table."""

import dataclasses
from pathlib import Path

import numpy as np

from sojourn_config.arm_config import ArmConfig
from sojourn_config.errors import MISSING, single
from sojourn_config.extends import read_document
from sojourn_config.load import load_params, validate
from sojourn_config.machine_checks import with_drive_data
from sojourn_config.machine_reader import joined_machine, machine_config
from sojourn_config.paths import SUFFIX, available, config_folder, display, resolve_urdf, urdf_folder
from sojourn_flight.arm.dh import DhTable
from sojourn_flight.arm.dh_urdf import urdf_from_dh
from sojourn_flight.arm.friction import JointFriction
from sojourn_flight.arm.serial_arm import SerialArm, build_serial_arm, with_motors
from sojourn_machine.errors import MachineError
from sojourn_machine.names import names_text

DH_FOLDER = Path("arms") / "dh"


def arm_names() -> tuple[str, ...]:
    """Names that `load_arm` knows: URDF files of arms, and parameter sets of arms on machines."""
    machines = {machine_config(name).urdf for name in available("machines")}
    alone = {path.stem for path in urdf_folder().glob("*.urdf") if path.name not in machines}
    return tuple(sorted(alone | set(available("arms"))))


def load_arm(name: str, base_link: str | None = None, tip_link: str | None = None) -> SerialArm:
    """An arm.

    Args:
        name: one of `arm_names()`; a machine, for its arm; or the path of a URDF, or of a Denavit-Hartenberg table in
            YAML.
        base_link, tip_link: of a URDF: where the arm begins and ends, in place of what the file suggests.

    Raises:
        ConfigError: no such arm or file, or its content is wrong; the message lists the names.
    """
    path = Path(name).expanduser()
    if path.suffix in (SUFFIX, ".yml", ".urdf", ".xml") or "/" in name:
        if not path.is_file():
            raise single("command line", "arm", name, "there is no such file; without a path, " + _known(path.stem))
        return arm_of_file(path, base_link, tip_link)
    if name in available("machines"):
        carried = machine_config(name).arm
        if carried is None:
            raise single("command line", "arm", name, f"the machine {name} has no arm: " + _known(name))
        name = carried
    if name in available("arms"):
        return _of_config(name, base_link, tip_link)
    if name not in arm_names():
        raise single("command line", "arm", name, _known(name) + " (or the path of a URDF or a table in YAML)")
    return arm_of_file(urdf_folder() / f"{name}.urdf", base_link, tip_link)


def arm_of_file(path: Path, base_link: str | None = None, tip_link: str | None = None) -> SerialArm:
    """The arm in a URDF or a Denavit-Hartenberg table.

    Raises:
        ConfigError: it cannot be read, or holds no arm.
    """
    if path.suffix in (SUFFIX, ".yml"):
        text = urdf_from_dh(read_dh(path), display(path))
    else:
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise single(display(path), "", MISSING, f"cannot be read: {error}") from error
    try:
        return build_serial_arm(text, base_link, tip_link)
    except MachineError as error:
        raise single(display(path), "", MISSING, str(error)) from error


def read_dh(path: Path) -> DhTable:
    """A Denavit-Hartenberg table.

    Raises:
        ConfigError: the file cannot be read, or is no such table.
    """
    return validate(read_document(path, "arms"), DhTable)


def dh_file(name: str) -> Path:
    """The table of an arm in `config/arms/dh`."""
    return config_folder() / DH_FOLDER / f"{name}{SUFFIX}"


def generated_urdf(path: Path) -> str:
    """The URDF of a table in a file, with the provenance that the file begins with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    head = [line.lstrip("#").rstrip() for line in lines[: next(i for i, line in enumerate(lines) if line[:1] != "#")]]
    made = f"  Made from {display(path)} by `python -m sojourn_config.dh_to_urdf`: change that and make it again."
    return urdf_from_dh(read_dh(path), "\n".join([made, "", *(f" {line}".rstrip() for line in head)]))


def _on_a_rover(name: str) -> SerialArm | None:
    """The arm as it is on the first machine that drives with it, with its motors; None where no such machine has it."""
    for machine in available("machines"):
        config = machine_config(machine)
        if config.arm != name or not config.stands_on:
            continue
        joined = joined_machine(machine)
        if joined.arm is None:
            continue
        params = with_drive_data(joined.arm, joined.config)
        ignored = {frozenset(pair) for pair in params.ignored_link_pairs}
        arm = build_serial_arm(joined.urdf.text, params.base_link, params.tip_link, params.tool_axis, ignored)
        zero = np.zeros(arm.joint_count)
        coulomb = np.array(params.coulomb_friction) if params.coulomb_friction else zero
        viscous = np.array(params.viscous_friction) if params.viscous_friction else zero
        inertia = np.array(params.reflected_inertia) if params.reflected_inertia else zero
        friction = JointFriction(viscous, coulomb, coulomb, zero, np.ones(arm.joint_count))
        return dataclasses.replace(with_motors(arm, inertia, friction), name=name)
    return None


def _of_config(name: str, base_link: str | None, tip_link: str | None) -> SerialArm:
    """An arm of `config/arms`: as it is on a rover, or alone."""
    on_rover = _on_a_rover(name)
    if on_rover is not None:
        if base_link is not None or tip_link is not None:
            why = f"its base and tip are in config/arms/{name}{SUFFIX}; give the path of its URDF for others"
            raise single("command line", "arm", name, why)
        return on_rover
    config = load_params("arms", name, ArmConfig)
    asked = (f"config/arms/{name}{SUFFIX}", "urdf")
    if config.urdf is None:
        raise single(*asked, MISSING, "the key is missing, and no machine has this arm in its own URDF")
    return arm_of_file(resolve_urdf(config.urdf, asked, config_folder() / "arms"), base_link, tip_link)


def _known(name: str) -> str:
    return names_text(name, arm_names())
