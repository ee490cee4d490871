"""The map of a page: the track on the ground of the scenario, or the tracks alone where the ground is not known."""

import base64
from io import BytesIO

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_bags.curves import COLORS
from sojourn_bags.machine import poses_of
from sojourn_bags.page.html import PageSection, figure, paragraph
from sojourn_bags.page.story import POSE, Story
from sojourn_bags.report_map import draw_map

DOTS_PER_INCH = 130
QUALITY = 86


def section(story: Story) -> PageSection:
    """Map of the run."""
    return PageSection("map", "Map", _body(story))


def _body(story: Story) -> str:
    tracks = [name for name, messages in story.bag.topics.items() if messages.type == POSE]
    if not tracks:
        return paragraph("The bag has no odometry, true or estimated: there is no track to draw.")
    picture = Figure(figsize=(9.2, 7.0), dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(picture)
    axes = picture.add_subplot()
    note = ""
    if story.run is not None and story.machine is not None:
        draw_map(picture, axes, story.bag, story.machine, story.run.terrain())
        note = "Ground with its craters as it was made from the scenario and its seed, lit from the north-west."
    else:
        note = "The ground is not drawn: the bag lacks the scenario or the truth of the machine."
        for number, name in enumerate(tracks):
            poses = poses_of(story.bag, name)
            axes.plot(poses[:, 0], poses[:, 1], color=COLORS[number % len(COLORS)], label=name)
            axes.plot(*poses[0, :2], "o", color=COLORS[number % len(COLORS)])
        axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
        axes.set_adjustable("datalim")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    stream = BytesIO()
    picture.savefig(stream, format="jpg", bbox_inches="tight", pil_kwargs={"quality": QUALITY})
    text = base64.b64encode(stream.getvalue()).decode()
    return figure("Track", f'<img alt="map of the run" src="data:image/jpeg;base64,{text}">', note)
