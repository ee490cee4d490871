"""Control laws compared on one motion of an arm: scripts/arm_test ARM --control."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np
from rich.markup import escape
from rich.table import Table

from sojourn_analysis.arm.control_loop import comparison_motion, run, settings_for
from sojourn_bringup.screen import wide_console
from sojourn_flight.arm.control_laws import LAWS
from sojourn_flight.arm.serial_arm import SerialArm, with_scaled_masses
from sojourn_machine.params import FloatArray

LONGEST = 150.0
"""Duration of the motion, in radians of the bandwidth; and in seconds at 1 rad/s."""
UNITS = {
    "tip_rms": "m",
    "joint_rms": "rad_or_m",
    "largest_joint_error": "rad_or_m",
    "final_tip_error": "m",
    "energy": "j",
}


def compare_laws(arm: SerialArm, gravity: FloatArray, mass_error: float) -> dict[str, Any]:
    """Every law with the right model, and with one whose links are too heavy by a share.

    Raises:
        ControlTestError: the arm has not the effort for the motion.
    """
    settings = settings_for(arm, 0.5 * (arm.lower + arm.upper))
    motion = comparison_motion(arm, gravity, LONGEST / settings.bandwidth)
    rounds = {"exact": arm, "wrong_masses": with_scaled_masses(arm, np.full(arm.joint_count, 1.0 + mass_error))}
    results: dict[str, Any] = {}
    for what, model in rounds.items():
        results[what] = {}
        for law in LAWS:
            figures = asdict(run(law, arm, model, motion, gravity, settings))
            margin = figures.pop("gain_margin")
            row = {f"{key}_{UNITS[key]}" if key in UNITS else key: value for key, value in figures.items()}
            results[what][law] = {**row, "gain_margin": margin if math.isfinite(margin) else None}
    return {
        "arm": arm.name,
        "gravity_m_s2": gravity.tolist(),
        "mass_error": mass_error,
        "loop": {
            "bandwidth_rad_s": settings.bandwidth,
            "sample_time_s": settings.sample_time,
            "delay_samples": settings.delay,
            "encoder_bits": settings.encoder_bits,
        },
        "motion": {
            "shape": "quintic",
            "duration_s": motion.duration,
            "from": motion.start.tolist(),
            "to": (motion.start + motion.way).tolist(),
        },
        "results": results,
    }


def print_comparison(figures: dict[str, Any]) -> None:
    """The same as tables."""
    console, loop = wide_console(), figures["loop"]
    console.print(
        f"{figures['arm']}: a quintic motion of {figures['motion']['duration_s']:.2f} s; bandwidth "
        f"{loop['bandwidth_rad_s']:.3g} rad/s, sampled every {1e3 * loop['sample_time_s']:.3g} ms, "
        f"{loop['delay_samples']} sample late, encoders of {loop['encoder_bits']} bits, efforts cut to their limits"
    )
    titles = {"exact": "the law knows the arm", "wrong_masses": f"links {100 * figures['mass_error']:+g} % in the law"}
    heads = ("law", "tip RMS", "joints RMS", "largest", "tip at the end", "overshoot", "energy", "cut", "gain margin")
    units = ("", "[mm]", "[mrad, mm]", "[mrad, mm]", "[mm]", "[%]", "[J]", "[% of time]", "[factor]")
    for what, title in titles.items():
        table = Table(title=title)
        for head, unit in zip(heads, units, strict=True):
            table.add_column(escape(f"{head}\n{unit}".rstrip()), justify="left" if head == "law" else "right")
        for law, row in figures["results"][what].items():
            margin = row["gain_margin"]
            lost = row["unstable"] or margin == 0.0
            table.add_row(
                law,
                *(f"{1e3 * row[key]:.3g}" for key in ("tip_rms_m", "joint_rms_rad_or_m")),
                *(f"{1e3 * row[key]:.3g}" for key in ("largest_joint_error_rad_or_m", "final_tip_error_m")),
                f"{100 * row['overshoot']:.2g}",
                f"{row['energy_j']:.4g}",
                f"{100 * row['saturated']:.2g}",
                "no feedback" if margin is None else "unstable" if lost else f"{margin:.3g}",
                style="red" if lost else None,
            )
        console.print(table)
