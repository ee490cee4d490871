"""Section of a machine that floats: how its base gave way, and that its momentum was kept."""

import numpy as np

from sojourn_bags.afloat import base_motion, momenta
from sojourn_bags.page.chart import chart, wheel_curves
from sojourn_bags.page.html import PageSection, figure, paragraph
from sojourn_bags.page.story import Story


def base(story: Story) -> PageSection:
    """Motion of base and centre of mass, and momentum."""
    machine = story.machine
    if machine is None:
        return PageSection("base", "Base", paragraph("How the base moved is not known: the bag has no truth."))
    motion = base_motion(story.bag, machine)
    times = motion.times - story.origin
    loads, found = momenta(story.bag)
    moved = 1e3 * np.linalg.norm(motion.base, axis=1)
    drifted = 1e3 * np.linalg.norm(motion.centre, axis=1)
    curves = wheel_curves(times, np.column_stack([moved, drifted]), ["base_link", "centre of mass"])
    parts = [
        paragraph(motion.words()),
        figure("Way of base and centre of mass since the start", chart(story.axis, curves, "moved [mm]")),
        figure(
            "Turn of the base since the start",
            chart(story.axis, wheel_curves(times, np.degrees(motion.turn)[:, None], ["base_link"]), "turned [degree]"),
        ),
    ]
    for title, columns, unit in (
        ("Momentum of all links in map", found[:, :3], "momentum [N s]"),
        ("Angular momentum about the centre of mass", found[:, 3:], "angular momentum [N m s]"),
    ):
        parts.append(
            figure(title, chart(story.axis, wheel_curves(loads - story.origin, columns, ["x", "y", "z"]), unit))
        )
    return PageSection("base", "Base", "".join(parts))
