"""How far a goal under way is, in words, by the status of who carries it out."""

import math
from collections.abc import Mapping


def number(text: str, otherwise: float = 0.0) -> float:
    """Of a field of a status, which may be somebody else's; `otherwise` for what is none."""
    try:
        return float(text)
    except ValueError:
        return otherwise


def to_go(who: str, values: Mapping[str, str]) -> str:
    """What drive or arm has before it. values: fields of its status."""
    if who == "drive":
        errors = (number(values.get(name, ""), math.nan) for name in ("lateral_error_m", "lateral_rms_m"))
        beside, rms = (round(error, 3) + 0.0 for error in errors)  # + 0.0: no minus before a zero
        aside = f"{beside:+.3f} m beside the path ({rms:.3f} m RMS)"
        energy = ""
        if "energy_forecast_wh" in values:
            used, left = (number(values.get(name, "")) for name in ("energy_used_wh", "energy_to_go_wh"))
            energy = f", {used:.2f} Wh used, {left:.2f} to go"
        doing = values.get("reason") or values.get("phase", "")
        return f"{values.get('distance_to_go', '?')} m to go, {aside}{energy} ({doing})"
    if "progress" not in values:  # of a task that has not begun yet
        return f"{values.get('task', who)} has not begun"
    return f"{100.0 * number(values['progress']):.0f} % done, {values.get('time_to_go', '?')} s to go"
