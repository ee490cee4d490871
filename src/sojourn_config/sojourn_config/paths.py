"""Where the configuration is: folder `config/` with one folder a kind, and folder `urdf/` beside it.

The folders are found by path and not through an installation index, so that an editable install and a colcon
workspace work alike. SOJOURN_CONFIG_DIR names another `config/`; `urdf/` is then looked for beside it and,
where there is none, the repository's is used.
"""

import os
from pathlib import Path

from sojourn_config.errors import MISSING, single
from sojourn_machine.names import names_text

ENVIRONMENT_VARIABLE = "SOJOURN_CONFIG_DIR"
KINDS = ("arms", "bodies", "campaigns", "machines", "nodes", "parts", "scenarios", "soils", "tools", "wheels")
"""Folders of `config/`."""
SUFFIX = ".yaml"
FIRST_FILES = {"machines": "machine"}
"""Kinds whose sets are folders of several files, with the name of the one that there must be."""


def repository_root() -> Path:
    """The folder above this file (or above the working folder) that holds `config/` and `urdf/`.

    Raises:
        ConfigError: there is no such folder.
    """
    for start in (Path(__file__).resolve(), Path.cwd()):
        for folder in (start, *start.parents):
            if (folder / "config").is_dir() and (folder / "urdf").is_dir():
                return folder
    raise single("environment", ENVIRONMENT_VARIABLE, MISSING, "no config/ was found: set it to yours")


def config_folder() -> Path:
    """The folder `config/` in use.

    Raises:
        ConfigError: SOJOURN_CONFIG_DIR is set and is no folder, or nothing was found.
    """
    override = os.environ.get(ENVIRONMENT_VARIABLE)
    if override is None:
        return repository_root() / "config"
    folder = Path(override).expanduser()
    if not folder.is_dir():
        raise single("environment", ENVIRONMENT_VARIABLE, override, "allowed is a folder that exists")
    return folder


def urdf_folder() -> Path:
    """The folder `urdf/` in use.

    Raises:
        ConfigError: as `config_folder`.
    """
    beside = config_folder().resolve().parent / "urdf"
    return beside if beside.is_dir() else repository_root() / "urdf"


def available(kind: str) -> tuple[str, ...]:
    """Names of the parameter sets of a kind, sorted."""
    folder = config_folder() / kind
    if kind in FIRST_FILES:
        return tuple(sorted(path.parent.name for path in folder.glob(f"*/{FIRST_FILES[kind]}{SUFFIX}")))
    return tuple(sorted(path.stem for path in folder.glob(f"*{SUFFIX}")))


def display(path: Path) -> str:
    """The path as a person would name it: from the folder that holds `config/` where it is under it."""
    resolved = path.resolve()
    for base in (config_folder().resolve().parent, Path.cwd().resolve()):
        if resolved.is_relative_to(base):
            return resolved.relative_to(base).as_posix()
    return str(path)


def resolve(kind: str, name: str, asked_by: tuple[str, str] | None = None, folders: tuple[Path, ...] = ()) -> Path:
    """The file of a parameter set.

    Args:
        kind: one of KINDS.
        name: a name (`jsc_1a`), or the path of a file, see `named_file`; of a machine, also that of its folder.
        asked_by: file and key that name it, for the message.
        folders: from which a path counts, the first choice first; none: the working folder.

    Raises:
        ConfigError: no such file, or more than one; the message lists the names that exist.
    """
    file, key = asked_by if asked_by is not None else ("command line", kind)
    if kind not in KINDS:
        raise single(file, key, kind, names_text(kind, KINDS))
    inner = f"/{FIRST_FILES[kind]}{SUFFIX}" if kind in FIRST_FILES else ""
    if is_path(name):
        found = named_file(name if name.endswith(SUFFIX) else name + inner, (file, key), *(folders or (Path.cwd(),)))
        if found is not None:
            return found
        known = names_text(Path(name).stem, available(kind))
        raise single(file, key, name, f"there is no such file; without a path, {known}")
    names = available(kind)
    if name not in names:
        raise single(file, key, name, f"not in config/{kind}: " + names_text(name, names))
    return config_folder() / kind / (name + (inner or SUFFIX))


def resolve_urdf(name: str, asked_by: tuple[str, str], folder: Path) -> Path:
    """The URDF file `name`: in `urdf/`, or a path from the file that names it, see `named_file`.

    Raises:
        ConfigError: no such file, or more than one; the message lists the URDF files that exist.
    """
    found = named_file(name, asked_by, folder, urdf_folder(), Path.cwd())
    if found is not None:
        return found
    files = [path.name for path in urdf_folder().glob("*.urdf")]
    raise single(asked_by[0], asked_by[1], name, "not in urdf/: " + names_text(name, files))


def named_file(name: str, asked_by: tuple[str, str], *folders: Path) -> Path | None:
    """The file that a path names; None where there is none.

    Args:
        name: an absolute path, or one from `folders`. One that begins with ./ or ../ is from the first of them alone.
        folders: that of the file that names it comes first.

    Raises:
        ConfigError: several folders have such a file: one of them would be read in silence for the other.
    """
    if name.startswith(("./", "../")):
        folders = folders[:1]
    paths = {(folder / Path(name).expanduser()).resolve(): folder / Path(name).expanduser() for folder in folders}
    found = [path for path in paths.values() if path.is_file()]
    if len(found) > 1:
        places = " and ".join(str(path.absolute()) for path in found)
        advice = f"allowed is one file, and there are {places}: write ./{name} for the first, or a whole path"
        raise single(asked_by[0], asked_by[1], name, advice)
    return found[0] if found else None


def is_path(name: str) -> bool:
    """Whether a text is a path and no name."""
    return "/" in name or os.sep in name or name.endswith((SUFFIX, ".yml"))
