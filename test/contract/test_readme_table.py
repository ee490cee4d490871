"""The manuals against the code: topic table, examples, links."""

import ast
import itertools
import re
import shutil
from pathlib import Path

import pytest
import yaml

from sojourn_contract.table import BEGIN, END, MarkersError, main, markdown_table, with_table
from sojourn_contract.topics import TOPICS, inputs_of, outputs_of

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
THE_CONTRACT = (ROOT / "src/sojourn_contract/README.md").read_text(encoding="utf-8")
THE_FILES = (ROOT / "src/sojourn_config/README.md").read_text(encoding="utf-8")
MANUALS = sorted([ROOT / "README.md", *ROOT.glob("src/*/README.md")])
LINK = re.compile(r"\[[^\]]*\]\(([^)#]+)(?:#[^)]*)?\)")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def table_rows(text: str) -> dict[str, list[str]]:
    lines = text.partition(BEGIN)[2].partition(END)[0].strip().splitlines()[2:]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return {row[0].strip("`"): row for row in rows}


def example_tables() -> dict[str, list[str]]:
    """Keys of INPUTS and OUTPUTS in the manual's flight node."""
    source = next(code for code in blocks(THE_CONTRACT, "python") if "class MyDrive" in code)
    found = {}
    for statement in ast.parse(source).body:
        if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Dict):
            target = statement.targets[0]
            assert isinstance(target, ast.Name)
            found[target.id] = [ast.literal_eval(key) for key in statement.value.keys if key is not None]
    return found


def test_the_manual_holds_the_table_of_the_code() -> None:
    hint = "renew it: python -m sojourn_contract.table --into src/sojourn_contract/README.md"
    assert with_table(THE_CONTRACT) == THE_CONTRACT, hint


def test_every_topic_has_its_row() -> None:
    rows = table_rows(THE_CONTRACT)
    assert list(rows) == [row.name for row in TOPICS]
    for row in TOPICS:
        _, kind, between, rate, *_ = rows[row.name]
        publisher, _, subscribers = between.partition(" → ")
        assert (kind, publisher) == (row.type, row.publisher)
        assert set(row.subscribers) <= set(subscribers.split(", "))
        assert (rate == "event") == row.is_event


@pytest.mark.parametrize(
    ("name", "rate", "age"),
    [("/odom", "50 Hz", "0.1 s"), ("/bus/state", "10 Hz", "0.5 s"), ("/diagnostics", "1 Hz", "3 s")],
)
def test_rates_and_ages(name: str, rate: str, age: str) -> None:
    assert table_rows(THE_CONTRACT)[name][3:5] == [rate, age]


@pytest.mark.parametrize("text", ["", BEGIN, END + BEGIN, BEGIN + BEGIN + END])
def test_a_text_without_markers_is_refused(text: str) -> None:
    with pytest.raises(MarkersError):
        with_table(text)


def test_only_what_is_between_the_markers_changes(tmp_path: Path) -> None:
    file = tmp_path / "page.md"
    file.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", encoding="utf-8")
    assert main(["--into", str(file)]) == 0
    assert file.read_text(encoding="utf-8") == f"before\n{BEGIN}\n{markdown_table()}\n{END}\nafter\n"


def test_a_file_without_markers_is_an_error_and_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "page.md"
    file.write_text("nothing here\n", encoding="utf-8")
    assert main(["--into", str(file)]) == 1
    assert "must hold" in capsys.readouterr().err
    assert file.read_text(encoding="utf-8") == "nothing here\n"


def test_the_example_node_has_the_topics_of_its_role() -> None:
    tables = example_tables()
    periodic_or_goal = {row.name.lstrip("/") for row in inputs_of("drive")}
    assert set(tables["INPUTS"]) == periodic_or_goal
    assert set(tables["OUTPUTS"]) == {row.name.lstrip("/") for row in outputs_of("drive")}
    assert set(tables["LISTENERS"]) == set(tables["OUTPUTS"])


def test_the_example_scenario_is_valid(tmp_path: Path) -> None:
    from sojourn_config.scenario import load_scenario

    (text,) = (text for text in blocks(THE_FILES, "yaml") if "\nsteps:" in text)
    file = tmp_path / "mine.yaml"
    file.write_text(text, encoding="utf-8")
    assert len(load_scenario(str(file)).config.steps) == len(yaml.safe_load(text)["steps"])


def test_the_example_of_a_machine_of_ones_own_is_valid(tmp_path: Path) -> None:
    from sojourn_config.scenario import load_scenario

    (flight,) = (text for text in blocks(THE_FILES, "yaml") if "mine/flight.yaml" in text)
    shutil.copytree(ROOT / "config" / "machines" / "skid", tmp_path / "skid")
    shutil.copytree(tmp_path / "skid", tmp_path / "mine")
    (tmp_path / "mine" / "flight.yaml").write_text(flight, encoding="utf-8")
    mine, skid = (load_scenario("flat_drive", [f"machine={tmp_path / name}"]).drive for name in ("mine", "skid"))
    assert mine.limits.max_speed == 0.15 < skid.limits.max_speed
    assert mine.model_copy(update={"limits": skid.limits}) == skid


def test_the_example_grounds_are_valid() -> None:
    from sojourn_physics.terrain.generate import generate
    from sojourn_physics.terrain.params import TerrainParams

    documents = [yaml.safe_load(text) for text in blocks(THE_FILES, "yaml")]
    placed, from_file = (
        document for document in documents if "kind" in document.get("terrain", {}) and len(document) == 1
    )
    ground = generate(TerrainParams.model_validate(placed["terrain"]), "lunar_nominal", "rigid_rock", 1)
    assert ground.soil_names == ("lunar_nominal", "rigid_rock", "mars") and len(set(ground.soil_index.ravel())) == 3
    assert TerrainParams.model_validate(from_file["terrain"]).file is not None


@pytest.mark.parametrize("manual", MANUALS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_to_files_and_examples_are_python(manual: Path) -> None:
    text = manual.read_text(encoding="utf-8")
    for target in LINK.findall(text):
        if "://" not in target:
            assert (manual.parent / target).exists(), target
    for code in blocks(text, "python"):
        compile(code, str(manual), "exec")


def test_the_example_supports_are_valid() -> None:
    from sojourn_machine.supports import FootParams, TrackParams, WheelParams

    *_, wheels, others = (yaml.safe_load(text) for text in blocks(THE_FILES, "yaml"))
    (wheel,), (track,), (foot,) = wheels["wheels"], others["tracks"], others["feet"]
    assert WheelParams.model_validate(wheel).contact.model == "brush"
    assert TrackParams.model_validate(track).name == "left"
    assert FootParams.model_validate(foot).contact.model == "foot_pad"


def test_every_contact_model_is_in_the_manual() -> None:
    from sojourn_machine.contact_choice import CONTACT_LAWS

    assert len(CONTACT_LAWS.names()) == 10
    for name in CONTACT_LAWS.names():
        assert f"| `{name}` |" in THE_FILES


def test_the_first_page_stays_short() -> None:
    assert len(README.splitlines()) <= 200


@pytest.mark.parametrize("package", sorted(path.parent.name for path in ROOT.glob("src/*/package.xml")))
def test_every_module_is_in_its_packages_manual_and_no_other(package: str) -> None:
    """Modules by file, chapters by folder, as the first column of the table of modules names them."""
    text = (ROOT / "src" / package / "README.md").read_text(encoding="utf-8")
    table = text.partition("| module |")[2] or text.partition("| chapter |")[2]
    rows = list(itertools.takewhile(lambda line: line.startswith("|"), table.splitlines()[1:]))
    listed = [name for row in rows for name in re.findall(r"`([^`]+)`", row.split("|")[1])]
    folder = ROOT / "src" / package / package
    files = {path.name for path in folder.glob("[a-z]*.py")}
    chapters = {f"{path.parent.name}/" for path in folder.glob("[a-z]*/__init__.py")}
    assert sorted(listed) == sorted(files | chapters)
