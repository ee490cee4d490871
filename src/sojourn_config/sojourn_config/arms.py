"""Arms by name: those of `urdf/`, those that rovers carry, and any file with a URDF or a Denavit-Hartenberg table."""

import dataclasses
from pathlib import Path

import numpy as np

from sojourn_config.arm_config import ArmConfig
from sojourn_config.errors import MISSING, single
from sojourn_config.load import load_params, validate
from sojourn_config.machine_checks import with_drive_data
from sojourn_config.paths import SUFFIX, available, config_folder, display, resolve_urdf, urdf_folder
from sojourn_config.rover import RoverConfig
from sojourn_config.yaml_file import read_yaml
from sojourn_flight.arm.dh import DhTable
from sojourn_flight.arm.dh_urdf import urdf_from_dh
from sojourn_flight.arm.friction import JointFriction
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.serial_arm import SerialArm, build_serial_arm, with_motors
from sojourn_machine.errors import MachineError
from sojourn_machine.names import names_text

DH_FOLDER = Path("arms") / "dh"


def arm_names() -> tuple[str, ...]:
    """Names that `load_arm` knows: URDF files of arms, and parameter sets of arms on rovers."""
    rovers = {load_params("rovers", name, RoverConfig).urdf for name in available("rovers")}
    alone = {path.stem for path in urdf_folder().glob("*.urdf") if path.name not in rovers}
    return tuple(sorted(alone | set(available("arms"))))


def load_arm(name: str, base_link: str | None = None, tip_link: str | None = None) -> SerialArm:
    """An arm.

    Args:
        name: one of `arm_names()`; a rover, for its arm; or the path of a URDF, or of a Denavit-Hartenberg table in
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
    if name in available("rovers"):
        carried = load_params("rovers", name, RoverConfig).arm
        if carried is None:
            raise single("command line", "arm", name, f"the rover {name} has no arm: " + _known(name))
        name = carried
    if name in available("arms"):
        return _arm_on_rover(name, base_link, tip_link)
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
    return validate(read_yaml(path), DhTable)


def dh_file(name: str) -> Path:
    """The table of an arm in `config/arms/dh`."""
    return config_folder() / DH_FOLDER / f"{name}{SUFFIX}"


def generated_urdf(path: Path) -> str:
    """The URDF of a table in a file, with the provenance that the file begins with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    head = [line.lstrip("#").rstrip() for line in lines[: next(i for i, line in enumerate(lines) if line[:1] != "#")]]
    made = f"  Made from {display(path)} by `python -m sojourn_config.dh_to_urdf`: change that and make it again."
    return urdf_from_dh(read_dh(path), "\n".join([made, "", *(f" {line}".rstrip() for line in head)]))


def _arm_on_rover(name: str, base_link: str | None, tip_link: str | None) -> SerialArm:
    config_of_arm = load_params("arms", name, ArmConfig)
    if config_of_arm.urdf is not None:
        asked = (f"config/arms/{name}{SUFFIX}", "urdf")
        urdf = resolve_urdf(config_of_arm.urdf, asked, config_folder() / "arms")
        return arm_of_file(urdf, base_link, tip_link)
    if base_link is not None or tip_link is not None:
        why = f"its base and tip are in config/arms/{name}{SUFFIX}; give the path of its URDF for others"
        raise single("command line", "arm", name, why)
    params: ArmParams = config_of_arm
    for rover in available("rovers"):
        config = load_params("rovers", rover, RoverConfig)
        if config.arm != name or config.arm_mount is not None:
            continue
        params = with_drive_data(params, config)
        asked = (f"config/rovers/{rover}{SUFFIX}", "urdf")
        text = resolve_urdf(config.urdf, asked, config_folder() / "rovers").read_text(encoding="utf-8")
        ignored = {frozenset(pair) for pair in params.ignored_link_pairs}
        arm = build_serial_arm(text, params.base_link, params.tip_link, params.tool_axis, ignored)
        zero = np.zeros(arm.joint_count)
        coulomb = np.array(params.coulomb_friction) if params.coulomb_friction else zero
        viscous = np.array(params.viscous_friction) if params.viscous_friction else zero
        inertia = np.array(params.reflected_inertia) if params.reflected_inertia else zero
        friction = JointFriction(viscous, coulomb, coulomb, zero, np.ones(arm.joint_count))
        return dataclasses.replace(with_motors(arm, inertia, friction), name=name)
    raise single(f"config/arms/{name}{SUFFIX}", "", MISSING, "no rover of config/rovers carries this arm")


def _known(name: str) -> str:
    return names_text(name, arm_names())
