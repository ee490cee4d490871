"""Loading one parameter set: every problem is told with file, key, value, range and the valid names."""

from pathlib import Path
from typing import Annotated, Literal, Self

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import Field, model_validator

from sojourn_config.errors import ConfigError, Problem
from sojourn_config.extends import read_document
from sojourn_config.load import load_params, validate
from sojourn_config.overrides import override_document, route_overrides, split_override
from sojourn_config.paths import config_folder, resolve_urdf, urdf_folder
from sojourn_config.scenario import load_scenario
from sojourn_config.yaml_file import YamlDocument, parse_yaml
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.names import nearest
from sojourn_machine.params import Params
from sojourn_physics.soil.params import SoilParams

Speed = Annotated[float, Field(gt=0.0, le=2.0)]


class Inner(Params):
    angle: float = Field(0.1, ge=-1.0, lt=1.0, description="an angle [rad]")
    pair: tuple[float, float] = Field((0.0, 1.0), description="two lengths [m]")


class Sample(Params):
    name: str = Field(min_length=1, description="its name")
    radius: float = Field(gt=0.0, le=5.0, description="radius of the wheel [m]")
    count: int = Field(3, ge=1, le=9, description="how many [-]")
    on: bool = Field(True, description="switched on")
    kind: Literal["soft", "hard"] = Field("soft", description="kind of ground")
    inner: Inner = Field(default_factory=Inner, description="a table")
    speeds: tuple[Speed, ...] = Field((), max_length=3, description="speeds [m/s]")
    named: dict[str, Inner] = Field(default_factory=dict, description="tables by name")
    several: tuple[Inner, ...] = Field((), description="tables in order")
    perhaps: Inner | None = Field(None, description="a table or nothing")
    either: float | Literal["auto"] = Field("auto", description="a mass [kg] or auto")
    low: float = Field(0.0, ge=0.0, description="lower [m]")
    high: float = Field(1.0, ge=0.0, description="upper [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.high <= self.low:
            raise InvalidValueError("high", self.high, f"more than low = {self.low:g} m")
        if self.name == "nobody":
            raise ValueError("name and count do not fit")
        return self


GOOD = "name: a\nradius: 0.125\n"


def problems(text: str) -> list[Problem]:
    with pytest.raises(ConfigError) as caught:
        validate(parse_yaml(text, "config/sample/x.yaml"), Sample)
    return list(caught.value.problems)


def test_good_file_with_defaults() -> None:
    found = validate(parse_yaml(GOOD + "speeds: [1, 0.5]\nnamed: {a: {angle: 0}}\neither: 3\n", "x"), Sample)
    assert found.radius == 0.125
    assert found.speeds == (1.0, 0.5)
    assert found.named["a"].angle == 0.0
    assert found.either == 3.0


@pytest.mark.parametrize(
    ("line", "key", "value", "words"),
    [
        ("radius_mm: 125", "radius_mm", "125", ["unknown key", "radius", "did you mean radius?"]),
        ("raduis: 0.1", "raduis", "0.1", ["unknown key", "did you mean radius?", "inner", "speeds"]),
        ("inner: {angel: 0.1}", "inner.angel", "0.1", ["did you mean angle?", "pair"]),
        ("named: {left: {angl: 1}}", "named.left.angl", "1", ["did you mean angle?"]),
        ("several: [{}, {angl: 1}]", "several[1].angl", "1", ["did you mean angle?"]),
        ("perhaps: {angl: 1}", "perhaps.angl", "1", ["did you mean angle?"]),
        ("inner: {angle: 5 deg}", "inner.angle", "'5 deg'", ["number", "[rad]", "at least -1", "no unit"]),
        ("inner: {angle: '0.1'}", "inner.angle", "'0.1'", ["number", "no quotes"]),
        ("inner: {angle: 5}", "inner.angle", "5", ["at least -1", "below 1", "[rad]"]),
        ("inner: {pair: [1]}", "inner.pair[1]", "", ["missing", "number", "[m]"]),
        ("inner: {pair: [1, 2, 3]}", "inner.pair", "[1, 2, 3]", ["list of 2"]),
        ("inner: 3", "inner", "3", ["table", "angle", "pair"]),
        ("count: 2.5", "count", "2.5", ["whole number", "at least 1", "at most 9"]),
        ("count: true", "count", "true", ["whole number"]),
        ("count: 10", "count", "10", ["at most 9"]),
        ("on: yes", "on", "'yes'", ["true or false"]),
        ("on: 1", "on", "1", ["true or false"]),
        ("kind: sfot", "kind", "'sfot'", ["soft", "hard", "did you mean soft?"]),
        ("kind: 3", "kind", "3", ["one of soft, hard"]),
        ("speeds: [1, -1]", "speeds[1]", "-1", ["above 0", "at most 2", "[m/s]"]),
        ("speeds: [1, 1, 1, 1]", "speeds", "[1, 1, 1, 1]", ["at most 3 values"]),
        ("speeds: 1", "speeds", "1", ["a list"]),
        ("inner: {angle: .nan}", "inner.angle", "nan", ["a number", "[rad]"]),
        ("high: .inf", "high", "inf", ["a number", "[m]"]),
        ("high: 1" + "0" * 400, "high", "inf", ["a number"]),
        ("inner: {angle: null}", "inner.angle", "null", ["a number"]),
        ("low: 2", "high", "1.0", ["more than low = 2 m"]),
    ],
)
def test_one_mistake_is_named(line: str, key: str, value: str, words: list[str]) -> None:
    found = problems(GOOD + line + "\n")
    assert [(problem.key, problem.value) for problem in found] == [(key, value)]
    assert found[0].file == "config/sample/x.yaml"
    assert found[0].line in (3, None)
    for word in words:
        assert word in str(found[0])


def test_missing_key_says_what_belongs_there() -> None:
    (found,) = problems("name: a\n")
    assert str(found) == (
        "config/sample/x.yaml: radius: the key is missing: "
        "allowed is a number above 0, at most 5 (radius of the wheel [m])"
    )


def test_out_of_range_reads_as_a_sentence() -> None:
    (found,) = problems("name: a\nradius: 125\n")
    assert str(found) == (
        "config/sample/x.yaml:2: radius = 125: allowed is a number above 0, at most 5 (radius of the wheel [m])"
    )


def test_message_of_a_whole_model_names_the_file() -> None:
    (found,) = problems("name: nobody\nradius: 1\n")
    assert str(found) == "config/sample/x.yaml: name and count do not fit"


def test_every_problem_is_told_at_once() -> None:
    wrong = "name: ''\nradius: -1\ncounts: 2\nnames: b\nkind: mud\n"
    found = problems(wrong + "inner: {angle: 7, pair: [a, 1]}\n")
    assert {problem.key for problem in found} == {
        "name", "radius", "counts", "names", "kind", "inner.angle", "inner.pair[0]",
    }  # fmt: skip
    unknown = [str(problem) for problem in found if "unknown key" in problem.allowed]
    assert "allowed is one of" in unknown[0]
    assert "allowed is one of" not in unknown[1], "the valid keys are listed once"
    assert "did you mean name?" in unknown[1]


def test_wrong_member_of_a_union_names_the_key_once() -> None:
    found = problems(GOOD + "either: automatic\n")
    assert {problem.key for problem in found} == {"either"}


@given(st.floats(allow_nan=True, allow_infinity=True))
@settings(max_examples=150)
def test_range_is_what_the_schema_says(value: float) -> None:
    document = parse_yaml(f"name: a\nradius: {value!r}\n".replace("inf", ".inf").replace("nan", ".nan"), "x")
    if 0.0 < value <= 5.0:
        assert validate(document, Sample).radius == value
    else:
        with pytest.raises(ConfigError) as caught:
            validate(document, Sample)
        assert [problem.key for problem in caught.value.problems] == ["radius"]


@given(st.sampled_from(sorted(Sample.model_fields)), st.integers(0, 30), st.characters(categories=("Ll",)))
@settings(max_examples=100)
def test_one_typing_error_in_a_key_is_found_again(name: str, at: int, letter: str) -> None:
    typed = name[: at % len(name)] + letter + name[at % len(name) :]
    if typed in Sample.model_fields or len(name) < 4:
        return
    assert nearest(typed, Sample.model_fields) is not None
    with pytest.raises(ConfigError) as caught:
        validate(parse_yaml(GOOD + f"{typed}: 1\n", "x"), Sample)
    assert any(problem.key == typed and "unknown key" in problem.allowed for problem in caught.value.problems)


# --- files and names ---


def test_real_file_and_unknown_name(tmp_path: Path) -> None:
    assert load_params("soils", "lunar_nominal", SoilParams).k_phi == 820e3
    with pytest.raises(ConfigError) as caught:
        load_params("soils", "lunar_nominel", SoilParams, asked_by=("config/scenarios/a.yaml", "soil"))
    text = str(caught.value)
    assert text.startswith("config/scenarios/a.yaml: soil = 'lunar_nominel'")
    assert "did you mean lunar_nominal?" in text
    assert "jsc_1a" in text
    with pytest.raises(ConfigError, match="did you mean soils"):
        load_params("soil", "lunar_nominal", SoilParams)


def test_a_path_stands_for_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.yaml").write_text(GOOD, encoding="utf-8")
    assert load_params("soils", str(tmp_path / "mine.yaml"), Sample).name == "a"
    assert load_params("soils", "mine.yaml", Sample, folder=tmp_path).name == "a"
    monkeypatch.chdir(tmp_path)
    assert load_params("soils", "./mine.yaml", Sample).name == "a"
    with pytest.raises(ConfigError, match="no such file"):
        load_params("soils", "./other.yaml", Sample)


def test_environment_names_another_config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "config" / "soils").mkdir(parents=True)
    (tmp_path / "config" / "soils" / "sand.yaml").write_text(GOOD, encoding="utf-8")
    monkeypatch.setenv("SOJOURN_CONFIG_DIR", str(tmp_path / "config"))
    assert load_params("soils", "sand", Sample).name == "a"
    with pytest.raises(ConfigError, match=r"config/soils.*one of sand"):
        load_params("soils", "lunar_nominal", Sample)
    (tmp_path / "config" / "soils" / "sand.yaml").write_text("name: a\nradius: 9\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"^config/soils/sand.yaml:2: radius = 9: "):
        load_params("soils", "sand", Sample)
    monkeypatch.setenv("SOJOURN_CONFIG_DIR", str(tmp_path / "absent"))
    with pytest.raises(ConfigError, match="SOJOURN_CONFIG_DIR"):
        load_params("soils", "sand", Sample)


# --- overrides ---


def test_overrides_set_values_and_leave_the_rest() -> None:
    document = parse_yaml("a: 1\nb: {c: [1, {d: 2}]}\n", "x")
    found = override_document(document, ["a=2.5", "b.c[1].d=text", "b.c[0]=[1, 2]", "e.f=true"])
    assert found.data == {"a": 2.5, "b": {"c": [[1, 2], {"d": "text"}]}, "e": {"f": True}}
    assert document.data == {"a": 1, "b": {"c": [1, {"d": 2}]}}


def test_a_table_that_is_set_builds_on_a_part_and_nothing_of_the_old_one_is_left() -> None:
    """Its kind was told to be missing in the file of the part that it replaces."""
    plain = read_document(config_folder() / "machines" / "explorer_isotope" / "power.yaml")
    found = override_document(plain, ["sources.generator={extends: krusty, leak: 0.5}"])
    generator = found.data["sources"]["generator"]  # type: ignore[index, call-overload]
    assert generator["kind"] == "fission_reactor" and generator["leak"] == 0.5 and "extends" not in generator
    assert not [key for key in generator if key in plain.data["sources"]["generator"] and key != "kind"]  # type: ignore[index, call-overload]
    assert found.place(("sources", "generator", "kind"))[0].startswith("--set sources.generator={extends: krusty")
    assert "config/parts/krusty.yaml" in found.texts and not [name for name in found.texts if name.startswith("--set")]
    with pytest.raises(ConfigError, match="did you mean krusty"):
        override_document(plain, ["sources.generator={extends: krust}"])


@pytest.mark.parametrize("text", ["a", "=3", "a..b=1", "a[x]=1", "a.c=1", "b.c[7]=1", "b.c.d=1", "b[0]=1", "a=[1", ""])
def test_overrides_that_cannot_be(text: str) -> None:
    document = parse_yaml("a: 1\nb: {c: [1, {d: 2}]}\n", "x")
    with pytest.raises(ConfigError, match="--set"):
        override_document(document, [text])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("power.sources.generator=3", "power: a file, known by its tables: allowed is battery or stores or sources"),
        ("batery_soc=3", "did you mean battery_soc"),
        ("sourcse={}", "did you mean sources"),
    ],
)
def test_a_first_word_of_no_file_is_told_with_those_of_all(text: str, words: str) -> None:
    """Only the scenario's own keys were told, and none of the machine's files."""
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", [text])


def test_problem_of_an_override_names_the_override() -> None:
    with pytest.raises(ConfigError) as caught:
        load_params("soils", "lunar_nominal", SoilParams, overrides=["k_phy=1", "cohesion=-5 Pa"])
    text = str(caught.value)
    assert "--set k_phy=1" in text
    assert "did you mean k_phi?" in text
    assert "--set cohesion=-5 Pa" in text
    assert "[Pa]" in text


def test_overrides_go_to_the_file_they_are_for() -> None:
    texts = ["soil.k_c=1", "soil=jsc_1a", "seed=3", "terrain.kind=flat"]
    stay, routed = route_overrides(texts, ["soil", "body"])
    assert stay == ["soil=jsc_1a", "seed=3", "terrain.kind=flat"]
    assert routed == {"soil": ["k_c=1"], "body": []}


@given(st.lists(st.text("abcdef_", min_size=1, max_size=6), min_size=1, max_size=4), st.integers(-99, 99))
@settings(max_examples=80)
def test_an_override_arrives_where_its_key_says(path: list[str], value: int) -> None:
    text = f"{'.'.join(path)}={value}"
    assert split_override(text) == (tuple(path), str(value))
    here: object = override_document(YamlDocument("x", {}), [text]).data
    for part in path:
        assert isinstance(here, dict)
        here = here[part]
    assert here == value


def test_a_path_counts_from_the_folder_of_its_file_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stale file of the same name in the working folder was read in silence: cohesion 1 in place of 700."""
    here, there = tmp_path / "working", tmp_path / "file"
    for folder in (here, there):
        folder.mkdir()
    (there / "mine.yaml").write_text(GOOD, encoding="utf-8")
    monkeypatch.chdir(here)
    assert load_params("soils", "mine.yaml", Sample, folder=there).name == "a"
    assert load_params("soils", "./mine.yaml", Sample, folder=there).name == "a"
    with pytest.raises(ConfigError, match="no such file"):
        load_params("soils", "mine.yaml", Sample)
    (here / "mine.yaml").write_text(GOOD.replace("name: a", "name: stale"), encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_params("soils", "mine.yaml", Sample, folder=there)
    text = str(caught.value)
    assert str(here / "mine.yaml") in text and str(there / "mine.yaml") in text and "./mine.yaml" in text
    assert load_params("soils", "./mine.yaml", Sample, folder=there).name == "a"
    monkeypatch.chdir(there)
    assert load_params("soils", "mine.yaml", Sample, folder=there).name == "a", "one file by two ways is one file"


def test_the_urdf_beside_its_file_and_that_of_the_same_name_are_two(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = ("my_rover.yaml", "urdf")
    monkeypatch.chdir(tmp_path)
    assert resolve_urdf("explorer.urdf", asked, tmp_path / "nowhere") == urdf_folder() / "explorer.urdf"
    (tmp_path / "explorer.urdf").write_text("<robot/>", encoding="utf-8")
    with pytest.raises(ConfigError, match="allowed is one file, and there are"):
        resolve_urdf("explorer.urdf", asked, tmp_path)
    assert resolve_urdf("./explorer.urdf", asked, tmp_path) == tmp_path / "explorer.urdf"


def test_a_path_of_the_command_line_counts_from_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    soil = (config_folder() / "soils" / "jsc_1a.yaml").read_text(encoding="utf-8")
    (tmp_path / "jsc_1a.yaml").write_text(soil, encoding="utf-8")
    assert "jsc_1a" in load_scenario("flat_drive", ["soil=./jsc_1a.yaml"]).soils
