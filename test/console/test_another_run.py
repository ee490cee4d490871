"""A run that begins anew on the domain: where it is of another scenario, nothing but rest is commanded by this page."""

import shutil
from pathlib import Path

import pytest
from told_feed import ToldFeed, show

from sojourn_bags.provenance import attachments
from sojourn_bags.writer import BagWriter
from sojourn_config.scenario import load_scenario
from sojourn_console.another_run import AGAIN_S, AnotherRun
from sojourn_console.gate import GuardedServer
from sojourn_console.page import Page
from sojourn_console.panels.head import LOUD, QUIET, HeadPanel
from sojourn_console.world import World, world_named, world_of_run

SHORT_RUN = str(Path(__file__).parents[1] / "system" / "short_run.yaml")
OTHER = "another scenario runs (short_run battery_soc=0.5): what is shown is of short_run; start the console anew"


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders of a run, of the same once more, and of one with another value."""
    base = tmp_path_factory.mktemp("runs")
    for name, overrides in (("first", ()), ("same", ()), ("other", ("battery_soc=0.5",))):
        BagWriter(base / name / "bag", [], attachments(load_scenario(SHORT_RUN, overrides)))
    return base


@pytest.fixture
def latest(bags: Path, tmp_path: Path) -> Path:
    """The link to the newest run, as `runs/latest`."""
    link = tmp_path / "latest"
    link.symlink_to(bags / "first")
    return link


@pytest.fixture
def shown(latest: Path) -> World:
    return world_of_run(latest)


def point(link: Path, folder: Path) -> None:
    link.unlink()
    link.symlink_to(folder)


def note_of(page: Page) -> str:
    head = page._head[0]
    assert isinstance(head, HeadPanel)
    return str(head._note.content)


def test_a_run_of_another_scenario_is_commanded_nothing_but_rest(bags: Path, latest: Path, shown: World) -> None:
    feed, told = ToldFeed(shown.table), list[str]()

    class Client:
        client_id = 1

        def add_notification(self, title: str, words: str, **_: object) -> None:
            told.append(f"{title}: {words}")

    page = Page(GuardedServer("another", 9090), shown, feed)
    bench, client = page.bench, Client()
    try:
        bench.commanding(client, lambda: "sent")
        assert told == ["Done: sent"] and not note_of(page)
        feed.jumped = True
        point(latest, bags / "other")
        show(page)
        assert f'{LOUD};margin:0 14px 4px">{OTHER}' in note_of(page)
        told.clear()
        bench.commanding(client, lambda: "sent")
        bench.commanding(client, lambda: "stopped", needs_control=False)
        head = page._head[0]
        assert isinstance(head, HeadPanel)
        for word in ("Pause", "Cancel", "Resume"):
            head._pressed(client, word)  # type: ignore[arg-type]
        assert told[0] == f"Not done: {OTHER}" and told[1] == "Done: stopped"
        assert [OTHER in one for one in told[2:]] == [False, False, True]
        assert not feed.said
        feed.jumped = True
        point(latest, bags / "first")  # as it is where the new run is recorded elsewhere
        show(page)
        told.clear()
        bench.commanding(client, lambda: "sent")
        assert "does not say yet" in told[0] and "does not say yet" in note_of(page)
        feed.jumped = True
        point(latest, bags / "same")
        show(page)
        told.clear()
        bench.commanding(client, lambda: "sent")
        assert told == ["Done: sent"] and not note_of(page)
    finally:
        page.close()


@pytest.mark.parametrize("is_finished", [False, True])
def test_a_run_that_is_heard_is_not_that_of_a_finished_bag(
    bags: Path, latest: Path, tmp_path: Path, is_finished: bool
) -> None:
    """Started anew beside a run that is recorded elsewhere, the console went by the same bag of before again."""
    writer = BagWriter(tmp_path / "before" / "bag", [], attachments(load_scenario(SHORT_RUN)))
    if is_finished:
        writer.close()
    point(latest, tmp_path / "before")
    run = AnotherRun(world_of_run(latest))
    run.look(0.0, is_heard=False)
    assert not run.refusal
    run.look(0.1)
    assert run.refusal.startswith(f"{latest} does not say yet") is is_finished
    point(latest, bags / "same")
    run.look(AGAIN_S + 0.2)
    assert not run.refusal


def test_a_bag_that_is_not_there_yet_is_looked_for_again(bags: Path, latest: Path, shown: World) -> None:
    run = AnotherRun(shown)
    run.begins()
    run.look(100.0)  # the folder still holds the bag of the run before
    assert run.refusal.startswith(f"{latest} does not say yet whether the run that is heard is of short_run")
    latest.unlink()
    run.look(100.0 + AGAIN_S)
    assert run.refusal.startswith(f"{latest} does not say yet whether the run that is heard is of short_run")
    latest.symlink_to(bags / "other")
    run.look(100.0 + 1.5 * AGAIN_S)
    assert "does not say yet" in run.refusal  # not with every look
    run.look(100.0 + 2.0 * AGAIN_S)
    assert run.refusal == OTHER and not run.note


def test_a_bag_that_is_cut_off_in_its_description_says_nothing_yet(latest: Path, shown: World, tmp_path: Path) -> None:
    whole = (latest / "bag" / "bag_0.mcap").read_bytes()
    (tmp_path / "cut").mkdir()
    (tmp_path / "cut" / "bag_0.mcap").write_bytes(whole[: len(whole) // 3])
    run = AnotherRun(shown)
    run.begins()
    point(latest, tmp_path / "cut")
    run.look(0.0)
    assert run.refusal.startswith(f"{latest} does not say yet whether the run that is heard is of short_run")


def test_a_file_that_was_changed_is_another_run(bags: Path, latest: Path, shown: World, tmp_path: Path) -> None:
    """Its name and what was set over it are the same."""
    copy = tmp_path / "short_run.yaml"
    shutil.copy(SHORT_RUN, copy)
    copy.write_text(copy.read_text().replace("size_x: 10.0", "size_x: 12.0"))
    BagWriter(tmp_path / "changed", [], attachments(load_scenario(str(copy))))
    run = AnotherRun(shown)
    run.begins()
    point(latest, tmp_path / "changed")
    run.look(0.0)
    assert run.refusal.startswith("another scenario runs (short_run): what is shown is of this one before its files")


def test_a_console_that_was_told_its_scenario_says_of_which_it_is() -> None:
    world = world_named(SHORT_RUN)
    feed = ToldFeed(world.table)
    page = Page(GuardedServer("named", 9100), world, feed)
    try:
        feed.jumped = True
        show(page)
        assert not page.bench.another_run.refusal
        assert f'{QUIET};margin:0 14px 4px">another run has begun: what is shown is of short_run' in note_of(page)
    finally:
        page.close()
