"""What a goal would come to, in lines for an operator: from the drive's answer to a question (`/drive/status`)."""

import math
from collections.abc import Mapping

from sojourn_operator.goal_messages import QUESTION

AT_NO_TIME = f"{QUESTION}.header = a goal now: allowed is none while "
"""What the contract puts before the drive's own sentence where it refuses every goal, such as while the arm is out."""


def foresight_lines(answer: Mapping[str, str]) -> list[str]:
    """One line for each thing that is known. answer: fields of /drive/status."""
    state, reason = answer.get("asked_state", "?"), answer.get("asked_reason", "").removeprefix(AT_NO_TIME)
    lines = [f"{state}: {reason}" if reason else state]
    for key, name, form in (
        ("asked_length_m", "path", "{:.2f} m"),
        ("asked_time_s", "time", "{:.0f} s"),
        ("asked_energy_wh", "energy", "{:.2f} Wh"),
        ("asked_charge_at_end", "charge at the end", "{:.1%}"),
        ("asked_tilt_margin_deg", "least tilt margin", "{:.1f} deg"),
    ):
        if key in answer:
            lines.append(f"{name + ':':18} {number_words(answer[key], form)}")
        elif key == "asked_charge_at_end" and "asked_energy_wh" in answer:
            unknown = "not known: the drive has not heard of a battery; whether it lasts is not judged"
            lines.append(f"{name + ':':18} {unknown}")
    if "asked_tilt" in answer:  # beside its margin, the last so far
        lines[-1] += f" ({answer['asked_tilt']})"
    if "asked_seen" in answer:
        lines.append(f"{'ground seen:':18} {number_words(answer['asked_seen'], '{:.0%}')} of the path")
    power = _power(answer.get("power_limit", "1"))
    if state == "allowed" and power:
        lines.append(f"{'power:':18} {power}")
    return lines


def _power(told: str) -> str:
    """What the drive is given, where that is less than all."""
    limit = _number(told)
    if limit is not None and limit >= 1.0:
        return ""
    given = f"the drive is given {number_words(told, '{:.0%}')} of it now"
    if limit is None:
        return given
    return f"{given}: it goes slower" if limit > 0.0 else f"{given}: it would stand"


def number_words(text: str, form: str) -> str:
    """A finite number of a status in its form; what is none as it came."""
    number = _number(text)
    return text if number is None else form.format(number)


def _number(text: str) -> float | None:
    """The finite number of a text, None where there is none."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
