"""What a person sees of a run: nothing that a message says commands the terminal."""

import io

from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from sojourn_bringup.health import Health, Progress
from sojourn_bringup.screen import PlainScreen, health_table
from sojourn_config.shown import REPLACED, shown

CLEARS = "\x1b[2Jall is well\x07\x9b1A"


def test_a_state_that_clears_the_screen_is_shown_as_text() -> None:
    output = io.StringIO()
    console = Console(file=output, highlight=False, soft_wrap=True, width=200)
    node = Health("drive", state=CLEARS, detail=CLEARS)
    progress = Progress()
    progress.step = CLEARS
    screen = PlainScreen(console)
    screen.show([node], progress)
    screen.say(CLEARS)
    console.print(health_table([node]))
    text = output.getvalue()
    assert "all is well" in text and REPLACED in text
    assert not {each for each in text if not each.isprintable()} - {"\n"}


@given(st.text())
def test_only_what_can_be_shown_stays(text: str) -> None:
    found = shown(text)
    assert len(found) == len(text) and all(each.isprintable() or each == "\n" for each in found)
    assert all(now == before for now, before in zip(found, text, strict=True) if before.isprintable())
