"""Alarms in lines for a terminal."""

from sojourn_contract.stamps import seconds
from sojourn_operator.alarms.engine import Alarm, shown_value
from sojourn_operator.alarms.watch import Watch, WatchState


def alarm_lines(watch: Watch, state: WatchState) -> list[str]:
    """The alarms that are shown, a line each."""
    shown = state.alarms.shown
    return [_line(watch, alarm) for alarm in shown] or ["no alarm"]


def _line(watch: Watch, alarm: Alarm) -> str:
    words = watch.engine.limits[alarm.name].help
    text = f"{alarm.worst.word.upper():8} {alarm.key}: {alarm.word}, since {seconds(alarm.since):.2f} s"
    return f"{text}, now {shown_value(alarm.value)}" + (f" ({words})" if words else "")
