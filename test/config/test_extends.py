"""Files that build on others: what comes out, where each value is from, and what is refused."""

import json
import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_bringup import start
from sojourn_config.errors import ConfigError
from sojourn_config.extends import read_document
from sojourn_config.load import load_params
from sojourn_config.machine import MACHINE_KINDS
from sojourn_config.machine_reader import joined_machine, machine_config
from sojourn_config.paths import available, config_folder
from sojourn_config.scenario import load_scenario
from sojourn_config.yaml_file import KeyPath, YamlDocument, parse_yaml
from sojourn_machine.drives import MotorParams
from sojourn_physics.contact.wheel_shape import WheelShape

LEAVES = st.one_of(st.integers(-9, 9), st.booleans(), st.none(), st.lists(st.integers(0, 9), max_size=3))
KEYS = st.sampled_from("abcd")
TABLES = st.dictionaries(KEYS, st.recursive(LEAVES, lambda inner: st.dictionaries(KEYS, inner, max_size=3)), min_size=1)


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def lines_of(table: dict[str, Any], indent: str = "") -> list[str]:
    """A table in block style: a key a line."""
    found = []
    for key, value in table.items():
        if isinstance(value, dict) and value:
            found += [f"{indent}{key}:", *lines_of(value, indent + "  ")]
        else:
            found.append(f"{indent}{key}: {json.dumps(value)}")
    return found


def leaves(value: Any, at: KeyPath = ()) -> dict[KeyPath, Any]:
    if isinstance(value, dict) and value:
        return {path: leaf for key, inner in value.items() for path, leaf in leaves(inner, (*at, key)).items()}
    return {at: value}


def refused(path: Path) -> str:
    with pytest.raises(ConfigError) as caught:
        read_document(path)
    return str(caught.value)


@settings(max_examples=60, deadline=None)
@given(st.lists(TABLES, min_size=1, max_size=4))
def test_the_last_file_that_says_a_leaf_has_it_and_is_named(tables: list[dict[str, Any]]) -> None:
    """Against a merge by leaves: those of a base stand unless what is above says that key, or takes a table's place."""
    with tempfile.TemporaryDirectory() as base:
        folder = Path(base)
        for index, table in enumerate(tables):
            above = [f"extends: layer{index - 1}"] if index else []
            path = written(folder, f"layer{index}.yaml", "\n".join([*above, *lines_of(table)]) + "\n")
        found = read_document(path)
        expected: dict[KeyPath, tuple[Any, int]] = {}
        for index, table in enumerate(tables):
            for at, leaf in leaves(table).items():
                if leaf == {} and any(old[: len(at)] == at and len(old) > len(at) for old in expected):
                    continue  # an empty table over a table says nothing
                expected = {
                    old: entry
                    for old, entry in expected.items()
                    if old[: len(at)] != at and not (at[: len(old)] == old and len(old) < len(at))
                }
                expected[at] = leaf, index
        assert leaves(found.data) == {at: leaf for at, (leaf, _) in expected.items()}
        for at, (_, index) in expected.items():
            file, line = found.place(at)
            assert file.endswith(f"layer{index}.yaml"), at
            text = (folder / f"layer{index}.yaml").read_text(encoding="utf-8").splitlines()
            assert line is not None and text[line - 1].strip().startswith(f"{at[-1]}:")
        assert len(found.texts) == len(tables)


def test_any_table_may_build_on_a_file_also_in_a_list(tmp_path: Path) -> None:
    written(tmp_path, "wheel.yaml", "radius: 0.2\ncontact: {model: brush, stiffness: 1.0}\n")
    path = written(
        tmp_path,
        "own.yaml",
        "wheels:\n  - {extends: ./wheel.yaml, name: a}\n  - extends: wheel\n    contact: {stiffness: 2}\n",
    )
    document = read_document(path)
    assert document.data["wheels"] == [
        {"radius": 0.2, "contact": {"model": "brush", "stiffness": 1.0}, "name": "a"},
        {"radius": 0.2, "contact": {"model": "brush", "stiffness": 2}},
    ]
    assert document.place(("wheels", 1, "contact", "model"))[0].endswith("wheel.yaml")
    assert document.place(("wheels", 1, "contact", "stiffness"))[0].endswith("own.yaml")


def test_a_list_takes_the_place_of_a_list(tmp_path: Path) -> None:
    written(tmp_path, "base.yaml", "loads: [{name: a, power: 1}, {name: b, power: 2}]\n")
    document = read_document(written(tmp_path, "own.yaml", "extends: base\nloads: [{name: c}]\n"))
    assert document.data == {"loads": [{"name": "c"}]}
    assert ("loads", 1) not in document.lines


def test_a_ring_is_refused_with_all_of_it(tmp_path: Path) -> None:
    for name, base in (("a", "b"), ("b", "c"), ("c", "a")):
        written(tmp_path, f"{name}.yaml", f"one: 1\ninner: {{extends: {base}}}\n")
    told = refused(tmp_path / "a.yaml")
    assert "c.yaml:2: inner.extends = 'a'" in told
    assert told.index("a.yaml -> ") < told.index("b.yaml -> ") < told.rindex("c.yaml -> ")
    written(tmp_path, "self.yaml", "extends: ./self.yaml\n")
    assert "self.yaml -> " in refused(tmp_path / "self.yaml")


def test_two_bases_of_one_file_are_no_ring(tmp_path: Path) -> None:
    written(tmp_path, "cell.yaml", "volts: 4\n")
    document = read_document(written(tmp_path, "own.yaml", "one: {extends: cell}\ntwo: {extends: cell}\n"))
    assert document.data == {"one": {"volts": 4}, "two": {"volts": 4}}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("extends: bse\n", ["own.yaml:1: extends = 'bse'", "not in", "config/parts", "did you mean base?"]),
        ("a: {extends: ./bse.yaml}\n", ["own.yaml:1: a.extends", "there is no such file", "did you mean base?"]),
        ("extends: 3\n", ["extends = 3", "the name of a file"]),
        ("extends: [base]\n", ["extends = ['base']", "the name of a file"]),
    ],
)
def test_a_base_that_is_not_there_is_answered_with_the_nearest(tmp_path: Path, text: str, words: list[str]) -> None:
    written(tmp_path, "base.yaml", "a: 1\n")
    told = refused(written(tmp_path, "own.yaml", text))
    for word in words:
        assert word in told


def test_a_name_in_two_places_is_refused_and_a_path_counts_from_its_file(tmp_path: Path) -> None:
    written(tmp_path, "maxon_re25.yaml", "resistance: 1\n")
    told = refused(written(tmp_path, "own.yaml", "extends: maxon_re25\n"))
    assert str(tmp_path / "maxon_re25.yaml") in told and "config/parts/maxon_re25.yaml" in told
    inner = written(tmp_path, "deeper/own.yaml", "extends: ../maxon_re25.yaml\n")
    assert read_document(inner).data == {"resistance": 1}


def test_a_mistake_in_a_base_is_told_with_the_bases_file(tmp_path: Path) -> None:
    base = written(tmp_path, "rim.yaml", "radius: -0.4\nwidth: 0.2\n")
    own = written(tmp_path, "mine.yaml", "name: mine\ncitation: none\nextends: rim\nhight: 1\n")
    with pytest.raises(ConfigError) as caught:
        load_params("wheels", str(own), WheelShape)
    assert {(problem.file, problem.line, problem.key) for problem in caught.value.problems} == {
        (str(base), 1, "radius"),
        (str(own), 4, "hight"),
    }


# --- machines ---


def test_a_machine_of_ones_own_holds_what_differs_alone(tmp_path: Path) -> None:
    """A folder anywhere: the skid rover with other motors and half its speed; and a stand of three lines."""
    skid = config_folder() / "machines" / "skid"
    mine = tmp_path / "mine"
    written(mine, "machine.yaml", f"extends: {skid / 'machine.yaml'}\ndescription: Mine\ntool: null\n")
    written(mine, "flight.yaml", f"extends: {skid / 'flight.yaml'}\ndrive: {{limits: {{max_speed: 0.15}}}}\n")
    for file in ("power", "sensors", "measured"):
        written(mine, f"{file}.yaml", f"extends: {skid / f'{file}.yaml'}\n")
    ours, theirs = (load_scenario("flat_drive", [f"machine={name}"]) for name in (str(mine), "skid"))
    assert ours.drive.limits.max_speed == 0.15
    assert ours.drive.model_copy(update={"limits": theirs.drive.limits}) == theirs.drive
    assert (ours.machine.wheels, ours.power, ours.sensors) == (theirs.machine.wheels, theirs.power, theirs.sensors)
    assert str(mine / "flight.yaml") in ours.files and "config/parts/maxon_re40.yaml" in ours.files
    stand = written(tmp_path / "stand", "machine.yaml", "extends: stand\ndescription: Mine\narm: scara\n")
    joined, own = joined_machine(str(stand.parent)), joined_machine("scara")
    assert (joined.power, joined.sensors, joined.law) == (own.power, own.sensors, own.law)


@pytest.mark.parametrize("name", available("machines"))
def test_what_a_machine_says_differs_from_what_it_builds_on(name: str) -> None:
    """Nothing is copied: a key whose value is that of the base is left out."""
    for path in sorted((config_folder() / "machines" / name).glob("*.yaml")):
        plain = parse_yaml(path.read_text(encoding="utf-8"), path.name)
        base = plain.data.pop("extends", None)
        if not isinstance(base, str):
            continue
        below = leaves(read_base(path, base).data)
        above = leaves(read_document(path, "machines").data)
        own = [at for at in leaves(plain.data) if at and at in below]
        assert not [at for at in own if below[at] == above[at]], path


def read_base(path: Path, name: str) -> YamlDocument:
    found = [path.parent / name, path.parent / f"{name}.yaml", config_folder() / "parts" / f"{name}.yaml"]
    return read_document(next(each for each in found if each.is_file()), "machines")


def test_kinds_of_machine_are_found_by_their_names() -> None:
    assert set(MACHINE_KINDS.names()) >= {"rover", "spacecraft", "stand"}
    assert {machine_config(name).kind for name in available("machines")} == {"rover", "spacecraft", "stand"}
    for name in available("machines"):
        config = machine_config(name)
        assert type(config) is MACHINE_KINDS.get(config.kind)
        assert config.fixed_base == (config.kind == "stand")
        assert config.floats == (config.kind == "spacecraft")


def test_motors_of_one_type_are_one() -> None:
    """The explorer's wheels, its steering and its arm, which comes with its own file."""
    motors = [drive.motor for drive in joined_machine("explorer").config.drives]
    kept = {"resistance", "torque_constant", "rotor_inertia", "no_load_current"}
    assert all(isinstance(motor, MotorParams) for motor in motors) and len(motors) == 5
    assert len({tuple(sorted(motor.model_dump(include=kept).items())) for motor in motors}) == 1


# --- printed ---


def test_a_run_is_printed_as_it_comes_out(capsys: pytest.CaptureFixture[str]) -> None:
    status = start.main(["flat_drive", "--machine", "micro", "--set", "battery.capacity_ah=3.5", "--resolved"])
    printed = capsys.readouterr().out
    assert status == 0
    lines = printed.splitlines()
    for value, place in (
        ("  capacity_ah: 3.5", "--set battery.capacity_ah=3.5 (in config/machines/micro/power.yaml)"),
        ("  cells_series: 4", "config/machines/micro/power.yaml:"),
        ("  charge_current_limit: 1.45", "config/parts/nca_cell_2900.yaml:"),
        ("  coulombic_efficiency: 0.99", "config/parts/nca_cell.yaml:"),
        ("    grouser_count: 14", "config/machines/micro/wheel.yaml:"),
        ("seed: 1", "config/scenarios/flat_drive.yaml:"),
    ):
        (line,) = [line for line in dict.fromkeys(lines) if line.startswith(value + " ")]
        assert f" # {place}" in line
    # it is YAML, and reads as the files do
    for role, document in load_scenario("flat_drive", ["machine=micro", "battery.capacity_ah=3.5"]).documents.items():
        own = printed.partition(f"# {role}: ")[2].partition("\n")[2].partition("\n\n")[0]
        assert parse_yaml(own, role).data == document.data
