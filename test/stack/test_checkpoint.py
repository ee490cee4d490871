"""The state of a run as a file: what is gone on from it, here or in another process, is the unbroken run."""

import json
import subprocess
import sys
import zipfile
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import encode
from sojourn_contract.role_state import RoleState
from sojourn_contract.state_tree import TREE, CheckpointError
from sojourn_stack.apps import make_apps
from sojourn_stack.checkpoint import load, save
from sojourn_stack.stack import Stack, StackState

ROLES = ("plant", "sensors", "drive", "power", "operator")
SCENARIO, OVERRIDES = "flat_drive", ("faults=[{joint: wheel_front_left_joint, kind: servo_locked, at: 0.5}]",)
PROGRAMS = tuple(f"sojourn_{role}" for role in ("plant", "sensors", "drive", "arm", "power"))
GO_ON = """
import sys
from pathlib import Path
sys.path.insert(0, {folder!r})
from test_checkpoint import made, said_in
from sojourn_stack.checkpoint import load
print(said_in(made(), load(Path({file!r})), 12))
"""


def made() -> Stack:
    return Stack(make_apps(load_scenario(SCENARIO, OVERRIDES), ROLES), ROLES)


def said_in(stack: Stack, state: StackState, periods: int) -> str:
    """What is said in some periods, as text."""
    told = []
    for _ in range(periods):
        state, said = stack.step(state)
        told += [f"{row.name} {encode(row, message).hex()}" for row, message in said]
    return "\n".join(told)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> dict[int, tuple[Path, str]]:
    """The file of the state after some periods, and what the unbroken run says in the twelve after it."""
    folder, stack = tmp_path_factory.mktemp("checkpoints"), made()
    state, _ = stack.begin()
    files: dict[int, tuple[Path, str]] = {}
    for periods in (3, 49, 110):
        while state.period <= periods:
            state, _ = stack.step(state)
        file = folder / f"{periods}.checkpoint"
        save(state, file)
        files[periods] = file, said_in(stack, state, 12)
    return files


@pytest.mark.parametrize("periods", [3, 49, 110])
def test_another_stack_goes_on_from_the_file(kept: dict[int, tuple[Path, str]], periods: int) -> None:
    file, told = kept[periods]
    assert said_in(made(), load(file), 12) == told and "/drive_command" in told


def test_another_process_goes_on_from_the_file(kept: dict[int, tuple[Path, str]]) -> None:
    file, told = kept[110]
    program = GO_ON.format(folder=str(Path(__file__).parent), file=str(file))
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.rstrip("\n") == told


def test_what_is_saved_is_what_the_unbroken_run_goes_on_from(tmp_path: Path) -> None:
    stack = made()
    state, _ = stack.begin()
    for _ in range(60):
        state, _ = stack.step(state)
    save(state, tmp_path / "one")
    branch = state
    unbroken = said_in(stack, state, 20)
    assert said_in(stack, load(tmp_path / "one"), 20) == unbroken
    assert said_in(stack, branch, 20) == unbroken


def changed(file: Path, where: Path, change: Any) -> Path:
    """A copy of a checkpoint whose tree is changed."""
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(where, "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, json.dumps(change(json.loads(data))) if name == TREE else data)
    return where


def test_a_state_of_another_version_is_named_with_its_role(kept: dict[int, tuple[Path, str]], tmp_path: Path) -> None:
    def lacks(tree: Any) -> Any:
        del tree["roles"]["drive"]["fields"]["app"]["fields"]["asked"]["fields"]["twist"]
        return tree

    with pytest.raises(CheckpointError, match=r"drive\.app\.asked: a Asked of another version: it differs in twist"):
        load(changed(kept[3][0], tmp_path / "old", lacks))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("subprocess:Popen", "a class of subprocess: allowed is one of ours"),
        ("sojourn_stack.checkpoint:load", "is no class of values"),
        ("sojourn_stack.stack:Stack", "is no class of values"),
        ("sojourn_stack.stack:Nothing", "there is no"),
    ],
)
def test_only_classes_of_values_of_ours_are_made(
    kept: dict[int, tuple[Path, str]], tmp_path: Path, name: str, reason: str
) -> None:
    def other(tree: Any) -> Any:
        tree["roles"]["power"]["fields"]["app"]["class"] = name
        return tree

    with pytest.raises(CheckpointError, match=reason):
        load(changed(kept[3][0], tmp_path / "foreign", other))


@pytest.mark.parametrize("package", PROGRAMS)
def test_a_class_of_a_program_is_refused_and_the_program_not_run(
    kept: dict[int, tuple[Path, str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    """It was: whoever read such a file had a node started in his process."""

    def other(tree: Any) -> Any:
        tree["roles"]["power"]["fields"]["app"]["class"] = f"{package}.__main__:Any"
        return tree

    not_run(package, monkeypatch)
    with pytest.raises(CheckpointError, match=rf"a class of {package}\.__main__: allowed is one of ours"):
        load(changed(kept[3][0], tmp_path / "program", other))


@pytest.mark.parametrize("package", PROGRAMS)
def test_a_program_that_is_imported_does_not_run(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    not_run(package, monkeypatch)
    import_module(f"{package}.__main__")


def not_run(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fail where the program of a package is run."""
    monkeypatch.setattr(f"{package}.node.main", lambda: pytest.fail(f"{package} was run"))
    monkeypatch.delitem(sys.modules, f"{package}.__main__", raising=False)


def test_files_that_are_none_are_refused(kept: dict[int, tuple[Path, str]], tmp_path: Path) -> None:
    cut_off = tmp_path / "cut_off"
    cut_off.write_bytes(kept[3][0].read_bytes()[:1000])
    text = tmp_path / "text"
    text.write_text("no checkpoint", encoding="utf-8")
    later = changed(kept[3][0], tmp_path / "later", lambda tree: tree | {"format": 99})
    for file, reason in ((cut_off, "no checkpoint"), (text, "no checkpoint"), (later, "format 99: allowed is 5")):
        with pytest.raises(CheckpointError, match=reason):
            load(file)
    with pytest.raises(OSError, match="nowhere"):
        load(tmp_path / "nowhere")


@pytest.mark.parametrize(
    ("part", "value", "reason"),
    [
        ("roles", 5, "roles: a int: allowed is a state of each"),
        ("period", -5, "period: -5: allowed is 1 to"),
        ("period", 10**30, "period: 10+: allowed is 1 to"),
        ("period", True, "period: True: allowed is 1 to"),
        ("messages", None, "messages: None: allowed is a valid dictionary"),
        ("ahead", {"tuple": [5]}, r"ahead\.0: 5: allowed is a valid tuple"),
        ("leaps", 5, "leaps: 5: allowed is an instance of Leaps"),
        ("origin", 5, "origin: 5: allowed is an instance of Origin"),
        ("roles.drive", 5, "drive: 5: allowed is an instance of RoleState"),
        ("roles.drive.fields.published", 5, r"drive\.published: 5: allowed is a valid dictionary"),
        (
            "roles.drive.fields.refused",
            {"map": [["/odom", "x"]]},
            r"drive\.refused\./odom: x: allowed is a valid integer",
        ),
        ("roles.drive.fields.now", "x", r"drive\.now: x: allowed is a valid integer"),
        ("roles.drive.fields.took", {"list": []}, r"drive\.took: \[\]: allowed is a valid tuple"),
        ("roles.drive.fields.goals.fields.waiting", 5, r"drive\.goals\.waiting: 5: allowed is a valid tuple"),
    ],
)
def test_a_tree_that_was_altered_is_refused_in_words(
    kept: dict[int, tuple[Path, str]], tmp_path: Path, part: str, value: object, reason: str
) -> None:
    """These were tracebacks: AttributeError, KeyError, struct.error; of a field of a role, once the run went on."""

    def other(tree: Any) -> Any:
        *way, last = part.split(".")
        inside = tree
        for key in way:
            inside = inside[key]
        inside[last] = value
        return tree

    with pytest.raises(CheckpointError, match=reason):
        load(changed(kept[3][0], tmp_path / "altered", other))


def with_part(original: Path, where: Path, name: str, data: bytes) -> Path:
    """A checkpoint with other bytes as one of its parts."""
    with zipfile.ZipFile(original) as old, zipfile.ZipFile(where, "w") as new:
        for part in old.namelist():
            new.writestr(part, data if part == name else old.read(part))
    return where


@pytest.mark.parametrize(
    ("header", "reason"),
    [
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (100000000000,), }", "8 bytes: an array of float64"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }", "8 bytes: an array of float64"),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (1,), }", "8 bytes: an array of object"),
        ("{'descr': '<f8', 'shape': }", "no checkpoint"),
    ],
)
def test_an_array_that_says_what_is_not_there_is_refused(
    kept: dict[int, tuple[Path, str]], tmp_path: Path, header: str, reason: str
) -> None:
    """Before memory for it is taken: MemoryError was raised by 128 bytes."""
    text = header.ljust(117).encode() + b"\n"
    data = np.lib.format.magic(1, 0) + len(text).to_bytes(2, "little") + text + bytes(8)
    with pytest.raises(CheckpointError, match=reason):
        load(with_part(kept[3][0], tmp_path / "array", "0.npy", data))


def test_a_part_that_cannot_be_unpacked_is_refused(kept: dict[int, tuple[Path, str]], tmp_path: Path) -> None:
    """Where a bit of what is packed has been flipped: zlib has words of its own, which were a traceback."""
    data = kept[3][0].read_bytes()
    with zipfile.ZipFile(kept[3][0]) as archive:
        first = archive.infolist()[0]
        begin = first.header_offset + 30 + len(first.filename)
    for bit in (1, 2):
        damaged = tmp_path / f"flipped {bit}"
        damaged.write_bytes(data[:begin] + bytes([data[begin] ^ (1 << bit)]) + data[begin + 1 :])
        with pytest.raises(CheckpointError, match="no checkpoint"):
            load(damaged)


@dataclass(frozen=True)
class Holder:
    value: Any


@pytest.mark.parametrize("value", [print, object(), np.array([None]), Holder(1.0), {1, 2}])
def test_what_cannot_be_kept_is_named(tmp_path: Path, value: Any) -> None:
    state = StackState(1, {"drive": RoleState({"inside": (1, value)})}, {})
    with pytest.raises(CheckpointError, match=r"drive\.app\['inside'\]\[1\]: .*cannot be kept"):
        save(state, tmp_path / "none")
    assert not (tmp_path / "none").exists()


numbers = st.floats(allow_nan=False) | st.integers() | st.booleans() | st.none() | st.text() | st.binary()
values = st.recursive(
    numbers, lambda inner: st.lists(inner) | st.tuples(inner, inner) | st.dictionaries(st.text() | st.integers(), inner)
)


@given(value=values, array=st.lists(st.floats(width=32)))
def test_plain_values_come_back_as_they_were(tmp_path_factory: pytest.TempPathFactory, value: Any, array: Any) -> None:
    file = tmp_path_factory.mktemp("one") / "state"
    state = StackState(7, {"drive": RoleState((value, np.array(array, dtype=np.float32)))}, {}, finished=True)
    save(state, file)
    found = load(file)
    assert replace(found, roles={}) == replace(state, roles={})
    assert found.roles["drive"].app[0] == value
    np.testing.assert_array_equal(found.roles["drive"].app[1], state.roles["drive"].app[1])
