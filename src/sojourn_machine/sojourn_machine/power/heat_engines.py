"""Efficiencies of heat engines in closed form.

    Carnot            1 - T_c / T_h          none does better
    Curzon-Ahlborn    1 - sqrt(T_c / T_h)    at the most power, where heat flows in and out over resistances
    Otto              1 - r^(1 - gamma)      r: compression ratio
    Brayton           see `brayton`          with losses of compressor and turbine, and a recuperator

Sources: Curzon and Ahlborn 1975, "Efficiency of a Carnot engine at maximum power output", Am. J. Phys. 43:22; Bejan
2016, "Advanced Engineering Thermodynamics", 4th ed., ch. 8 and 9 (air-standard cycles).
"""

from math import inf, isfinite, sqrt

from sojourn_machine.errors import InvalidValueError


def _require(name: str, value: float, low: float, high: float = inf) -> None:
    if not (isfinite(value) and low < value <= high):
        raise InvalidValueError(name, value, f"a finite number above {low:g}" + (f", at most {high:g}" * (high < inf)))


def _require_temperatures(hot: float, cold: float) -> None:
    _require("cold temperature [K]", cold, 0.0)
    if not (isfinite(hot) and hot >= cold):
        raise InvalidValueError("hot temperature [K]", hot, f"a finite number, at least the cold one, {cold:g} K")


def carnot(hot: float, cold: float) -> float:
    """Between two temperatures [K]. Raises InvalidValueError."""
    _require_temperatures(hot, cold)
    return 1.0 - cold / hot


def curzon_ahlborn(hot: float, cold: float) -> float:
    """Between two temperatures [K]. Raises InvalidValueError."""
    _require_temperatures(hot, cold)
    return 1.0 - sqrt(cold / hot)


def otto(compression: float, heat_ratio: float = 1.4) -> float:
    """Of the air-standard cycle; `heat_ratio`: gamma. Raises InvalidValueError."""
    _require("compression ratio", compression - 1.0, 0.0)
    _require("heat_ratio", heat_ratio - 1.0, 0.0)
    return float(1.0 - compression ** (1.0 - heat_ratio))


def brayton(
    pressure_ratio: float,
    temperature_ratio: float,
    heat_ratio: float = 1.4,
    machine_efficiency: float = 1.0,
    recuperation: float = 0.0,
) -> float:
    """Of the cycle with a compressor and a turbine of one isentropic efficiency e and a recuperator.

    With x = r^((gamma - 1)/gamma), temperatures over that before the compressor: T2 = 1 + (x - 1)/e after it, T3 before
    the turbine, T4 = T3 (1 - e (1 - 1/x)) after it; the recuperator lifts T2 by a part of T4 - T2 where that is hotter.

    Args:
        temperature_ratio: T3. recuperation: effectiveness, 0 to 1.

    Returns:
        the efficiency; negative where the compressor takes more than the turbine gives.

    Raises:
        InvalidValueError: out of range, or a turbine that is not hotter than what leaves the compressor.
    """
    _require("pressure ratio", pressure_ratio - 1.0, 0.0)
    _require("heat_ratio", heat_ratio - 1.0, 0.0)
    _require("machine_efficiency", machine_efficiency, 0.0, 1.0)
    if not 0.0 <= recuperation <= 1.0:
        raise InvalidValueError("recuperation", recuperation, "0 to 1")
    x = pressure_ratio ** ((heat_ratio - 1.0) / heat_ratio)
    compressed = 1.0 + (x - 1.0) / machine_efficiency
    if not (isfinite(temperature_ratio) and temperature_ratio > compressed):
        allowed = f"a finite number above {compressed:.4g}, what the compressor already comes to"
        raise InvalidValueError("temperature ratio", temperature_ratio, allowed)
    expanded = temperature_ratio * (1.0 - machine_efficiency * (1.0 - 1.0 / x))
    work = (temperature_ratio - expanded) - (compressed - 1.0)
    heated = temperature_ratio - compressed - recuperation * max(expanded - compressed, 0.0)
    return float(work / heated)
