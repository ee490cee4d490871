"""The configuration that a campaign carries to its workers: they need the installed packages and none of our files.

It is what `config/` and `urdf/` hold, and every other file that the runs have read, laid out as they are here; of an
elevation model the part that is used. A worker writes it into a folder of its own, once, and reads it from there.
"""

import hashlib
import io
import tarfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import chdir, contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from sojourn_bags.run_configuration import place_below, set_variable
from sojourn_config.command_errors import UsageError
from sojourn_config.paths import ENVIRONMENT_VARIABLE, config_folder, display, is_path, urdf_folder
from sojourn_config.recorded_raster import ELEVATION_NAME, raster_bytes
from sojourn_config.scenario import LoadedScenario

_KINDS = (".yaml", ".xml", ".urdf")


@dataclass(frozen=True)
class CarriedFiles:
    """Files by their place below the folder that stands for the repository.

    Args:
        files: content by place, with slashes.
    """

    files: Mapping[str, bytes]

    @cached_property
    def digest(self) -> str:
        """Of names and contents."""
        digest = hashlib.sha256()
        for name in sorted(self.files):
            digest.update(f"{name}\0{hashlib.sha256(self.files[name]).hexdigest()}\n".encode())
        return digest.hexdigest()

    def write(self, base: Path) -> None:
        """Lay the files out below a folder."""
        for name, content in self.files.items():
            path = base / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        (base / "config").mkdir(parents=True, exist_ok=True)


def carry(loaded: Iterable[LoadedScenario]) -> CarriedFiles:
    """What runs of these scenarios need.

    Raises:
        UsageError: they stand on more than one elevation model.
    """
    files = {f"config/{name}": content for name, content in _in_folder(config_folder())}
    files |= {f"urdf/{name}": content for name, content in _in_folder(urdf_folder())}
    models: dict[str, bytes] = {}
    for one in loaded:
        files |= {place_of(name): text.encode() for name, text in one.files.items()}
        if one.raster is not None:
            models[",".join(f"{name} {digest}" for name, digest in sorted(one.digests.items()))] = raster_bytes(
                one.raster
            )
    if len(models) > 1:
        raise UsageError(
            f"a campaign carries one elevation model to its workers, here are {len(models)}: {list(models)}"
        )
    files |= {f"config/{ELEVATION_NAME}": content for content in models.values()}
    return CarriedFiles(files)


def place_of(name: str) -> str:
    """Where a file goes: relative names as they are, whole paths below a folder of their own."""
    return place_below(Path(), name).as_posix()


def named_there(name: Any) -> Any:
    """A value that names a file here, as a worker finds it; any other value as it is."""
    if not isinstance(name, str) or not is_path(name) or not Path(name).expanduser().exists():
        return name
    return f"./{place_of(display(Path(name).expanduser()))}"


@contextmanager
def in_configuration(base: Path) -> Iterator[None]:
    """Read the configuration from below a folder, for as long as the context is open."""
    with set_variable(ENVIRONMENT_VARIABLE, str(base / "config")), chdir(base):
        yield


def packed(folder: Path) -> bytes:
    """A folder's files as one value. The order of names is fixed, and nothing of owners or times is in it."""
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                entry = tarfile.TarInfo(path.relative_to(folder).as_posix())
                entry.size, entry.mode = path.stat().st_size, 0o600
                with path.open("rb") as file:
                    archive.addfile(entry, file)
    return stream.getvalue()


def unpack(content: bytes, folder: Path) -> None:
    """Write what `packed` has made into a folder, and nothing outside of it."""
    with tarfile.open(fileobj=io.BytesIO(content)) as archive:
        archive.extractall(folder, filter="data")


def _in_folder(folder: Path) -> Iterator[tuple[str, bytes]]:
    for path in sorted(folder.rglob("*")):
        if path.suffix in _KINDS and path.is_file():
            yield path.relative_to(folder).as_posix(), path.read_bytes()
