"""A run that is saved in the middle of a dig: soil half moved, a task half done, the arm in touch with the ground."""

from pathlib import Path

from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import encode
from sojourn_flight.arm.tasks.activity import name_of
from sojourn_stack.apps import make_apps
from sojourn_stack.checkpoint import load, save
from sojourn_stack.stack import Stack, StackState

SCENARIO = Path(__file__).parents[1] / "system" / "dig_run.yaml"
ROLES = ("plant", "sensors", "drive", "arm", "power", "operator")


def made() -> Stack:
    return Stack(make_apps(load_scenario(str(SCENARIO)), ROLES), ROLES)


def told_after(stack: Stack, state: StackState, periods: int) -> list[tuple[str, bytes]]:
    told = []
    for _ in range(periods):
        state, said = stack.step(state)
        told += [(row.name, encode(row, message)) for row, message in said]
    return told


def test_the_rest_of_the_dig_is_that_of_the_unbroken_run(tmp_path: Path) -> None:
    stack = made()
    state, _ = stack.begin()
    digging = 0
    while digging < 300:  # six seconds into it the scoop is in the soil
        state, _ = stack.step(state)
        digging += name_of(state.roles["arm"].app.tasks.activity) == "dig"
        assert not state.finished, "it has never dug"
    assert state.roles["plant"].app.machine.tool.has_worked or state.roles["plant"].app.machine.ground.tiles
    file = tmp_path / "dig.checkpoint"
    save(state, file)
    unbroken = told_after(stack, state, 150)
    assert told_after(made(), load(file), 150) == unbroken
