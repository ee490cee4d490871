"""The strict YAML reader."""

import json
import math
import pickle
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.errors import ConfigError, Problem
from sojourn_config.overrides import split_override
from sojourn_config.paths import config_folder
from sojourn_config.yaml_file import (
    MOST_BYTES,
    MOST_DEPTH,
    MOST_VALUES,
    parse_value,
    parse_yaml,
    plain_scalar,
    read_yaml,
)
from sojourn_machine.errors import InvalidValueError, UnknownNameError

FLOATS = st.floats(allow_nan=False, allow_infinity=False)
TEXT = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S", "Zs")), max_size=20)
KEYS = TEXT.filter(lambda key: key not in ("", "<<"))
TREES = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**18), 10**18) | FLOATS | TEXT,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=12,
)


@given(st.dictionaries(KEYS, TREES, min_size=1, max_size=4))
@settings(max_examples=100, deadline=None)
def test_json_is_yaml_and_is_read_as_json_reads_it(data: dict[str, object]) -> None:
    """JSON is a subset of YAML 1.2: the standard library's own reader is the independent route."""
    text = json.dumps(data, ensure_ascii=False)
    assert parse_yaml(text, "x").data == json.loads(text)


@given(FLOATS)
@settings(max_examples=200)
def test_every_way_to_write_a_number_is_a_number(value: float) -> None:
    for text in (repr(value), f"{value:.17e}", f"{value:+.17E}"):
        found = plain_scalar(text)
        assert isinstance(found, float | int)
        assert float(found) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("820e3", 820e3),
        ("1e3", 1000.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("0x1F", 31),
        ("0o17", 15),
        ("017", 17),
        ("-0", 0),
        (".inf", math.inf),
        ("-.Inf", -math.inf),
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("", None),
        ("on", "on"),
        ("no", "no"),
        ("12:30", "12:30"),
        ("1_000", "1_000"),
        ("2004-01-25", "2004-01-25"),
        ("5 deg", "5 deg"),
        ("1e", "1e"),
        (".", "."),
        ("1.2.3", "1.2.3"),
    ],
)
def test_core_schema_of_yaml_1_2(text: str, value: object) -> None:
    found = plain_scalar(text)
    assert found == value
    assert type(found) is type(value)


def test_not_a_number_is_read_as_such() -> None:
    found = plain_scalar(".nan")
    assert isinstance(found, float)
    assert math.isnan(found)


def test_quoted_number_is_text() -> None:
    assert parse_yaml("a: '5'\nb: \"1e3\"", "x").data == {"a": "5", "b": "1e3"}


def test_lines_and_places() -> None:
    document = parse_yaml("a: 1\n\nb:\n  c:\n    - 1\n    - {d: 2}\n", "file.yaml")
    assert document.lines[("a",)] == 1
    assert document.lines[("b", "c", 1, "d")] == 6
    assert document.place(("b", "c", 0)) == ("file.yaml", 5)
    assert document.place(("b", "not there")) == ("file.yaml", 3)
    assert document.place(("not there",)) == ("file.yaml", None)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: 2\na: 3\n", ["x.yaml:3", "a", "twice", "line 1"]),
        ("a:\n  b: 1\n  b: 1\n", ["x.yaml:3", "a.b", "twice"]),
        ("- 1\n- 2\n", ["table"]),
        ("", ["empty"]),
        ("just text", ["table"]),
        ("a: &here [1]\nb: *here\n", ["x.yaml:2", "b", "alias"]),
        ("a: &here [*here]\n", ["alias"]),
        ("a: *nowhere\n", ["alias"]),
        ("a: !!python/object:os.system 1\n", ["tag"]),
        ("a: !mine 1\n", ["tag", "!mine"]),
        ("1: 2\n", ["text only"]),
        ("<<: {a: 1}\n", ["text only"]),
        ("{[1]: 2}", ["text only"]),
        ("a: [1\n", ["x.yaml:2", "YAML"]),
        ("\ta: 1\n", ["YAML"]),
        ("a: 1\n---\nb: 2\n", ["document"]),
        ("a: \x00\n", ["YAML"]),
        ("a: " + "[" * 3000, ["YAML"]),
    ],
)
def test_what_is_refused(text: str, words: list[str]) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_yaml(text, "x.yaml")
    for word in words:
        assert word in str(caught.value)


def test_every_duplicate_is_reported() -> None:
    with pytest.raises(ConfigError) as caught:
        parse_yaml("a: 1\na: 2\nb: {c: 1, c: 2}\n", "x")
    assert [problem.key for problem in caught.value.problems] == ["a", "b.c"]


def test_endless_digits_do_not_hang_or_crash() -> None:
    assert parse_yaml("a: " + "9" * 10_000, "x").data == {"a": math.inf}


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read"):
        read_yaml(tmp_path / "absent.yaml")
    broken = tmp_path / "broken.yaml"
    broken.write_bytes(b"a: \xff\xfe")
    with pytest.raises(ConfigError, match="cannot be read"):
        read_yaml(broken)


@given(st.binary(max_size=60))
@settings(max_examples=150, deadline=None)
def test_any_bytes_are_read_or_refused(content: bytes) -> None:
    try:
        data = parse_yaml(content.decode("utf-8", errors="replace"), "x").data
    except ConfigError as error:
        assert error.problems
    else:
        assert isinstance(data, dict)


def test_values_of_the_command_line() -> None:
    assert parse_value("3", "x") == 3
    assert parse_value("[1, 2.5]", "x") == [1, 2.5]
    assert parse_value("lunar_nominal", "x") == "lunar_nominal"
    with pytest.raises(ConfigError):
        parse_value("[1", "x")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a: " + "{b: " * 5000 + "1" + "}" * 5000, f"at most {MOST_DEPTH} tables and lists inside each other"),
        ("a: " + "[" * 200_000, f"at most {MOST_DEPTH} tables and lists inside each other"),
        ("\n".join(" " * depth + "a:" for depth in range(1000)), f"at most {MOST_DEPTH} tables and lists"),
        ("steps:\n" + "  - {wait_s: 1}\n" * 100_000, f"at most {MOST_VALUES} values"),
    ],
)
def test_what_is_too_deep_or_too_much_is_refused_in_one_sentence(text: str, reason: str) -> None:
    """Before anything is made of it: it used to end in a traceback, or to take half a minute."""
    with pytest.raises(ConfigError) as caught:
        parse_yaml(text, "hostile.yaml")
    assert len(caught.value.problems) == 1 and reason in str(caught.value)


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    path.write_text("# " + "x" * MOST_BYTES + "\na: 1\n")
    with pytest.raises(ConfigError, match=f"allowed are at most {MOST_BYTES} bytes"):
        read_yaml(path)


@pytest.mark.parametrize("text", ["a" + "[" * 3 + "=1", "a[" + "9" * 5000 + "]=1", ".".join("a" * 5000) + "=1"])
def test_a_key_of_the_command_line_that_is_too_long_is_refused(text: str) -> None:
    with pytest.raises(ConfigError):
        split_override(text)


def test_no_file_of_ours_is_near_the_limits() -> None:
    for path in config_folder().rglob("*.yaml"):
        document = read_yaml(path)
        assert path.stat().st_size < MOST_BYTES / 10 and len(document.lines) < MOST_VALUES / 10
        assert max((len(key) for key in document.lines), default=0) < MOST_DEPTH / 2


@pytest.mark.parametrize(
    "told",
    [
        ConfigError([Problem("a.yaml", "mass", "-1", "allowed is more than 0", 3), Problem("a.yaml", "", "", "no")]),
        InvalidValueError("mass", -1.0, "more than 0 kg"),
        UnknownNameError("soil", "sandy", ("sand",)),
    ],
)
def test_an_error_comes_whole_out_of_another_process(told: Exception) -> None:
    """It came with a line for each letter of its text, or broke the pool of processes."""
    heard = pickle.loads(pickle.dumps(told))
    assert type(heard) is type(told) and str(heard) == str(told) and vars(heard) == vars(told)
