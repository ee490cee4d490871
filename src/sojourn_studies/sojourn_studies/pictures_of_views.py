"""What the cameras of a run have seen, as pictures: the image, and beside it the depth of a stereo pair."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sojourn_bags.reading import Bag, read_bag
from sojourn_config.command_errors import UsageError

KINDS = {"mono8": "u1", "16UC1": "<u2"}
"""Numbers of a pixel by the encoding of an image."""


def view(run: Path, camera: str, time: float) -> Figure:
    """What a camera of a run has seen at a time.

    Args:
        camera: name in the machine's sensors.yaml. time: of simulation; the image taken last before it is drawn [s].

    Raises:
        UsageError: the run has no such camera, or no image by then.
    """
    bag = read_bag(run)
    image = _image(bag, camera, ("image", "left/image"), time)
    depth = _image(bag, camera, ("depth",), time) if f"/{camera}/depth" in bag else None
    figure, axes = plt.subplots(1, 1 if depth is None else 2, figsize=(10.0, 5.0), layout="constrained", squeeze=False)
    axes[0, 0].imshow(image, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    axes[0, 0].set_title(f"{camera}, {time:.0f} s")
    if depth is not None:
        metres = np.where(depth > 0, depth / 1000.0, np.nan)
        shown = axes[0, 1].imshow(metres, cmap="viridis_r", norm="log", interpolation="nearest")
        axes[0, 1].set_title("depth that the pair finds")
        ticks = [metre for metre in (0.5, 1, 2, 3, 5, 10, 20, 30) if np.nanmin(metres) <= metre <= np.nanmax(metres)]
        bar = figure.colorbar(shown, cax=axes[0, 1].inset_axes((1.02, 0.0, 0.03, 1.0)), label="depth [m]", ticks=ticks)
        bar.ax.set_yticklabels([f"{metre:g}" for metre in ticks])
        bar.ax.minorticks_off()
    for one in axes.flat:
        one.set(xticks=[], yticks=[])
        one.grid(False)
    return figure


def _image(bag: Bag, camera: str, names: tuple[str, ...], time: float) -> NDArray[Any]:
    topic = next((f"/{camera}/{name}" for name in names if f"/{camera}/{name}" in bag), None)
    if topic is None:
        has = sorted({name.split("/")[1] for name in bag.topics if name.endswith("/image")})
        raise UsageError(f"pictures: the run has no camera {camera!r}, allowed is one of {', '.join(has) or 'none'}")
    messages = bag[topic]
    before = np.flatnonzero(messages.times <= time + 1e-9)
    if not before.size:
        raise UsageError(f"pictures: no image on {topic} by {time:g} s, allowed is {messages.times[0]:g} s or later")
    found = messages.decode(int(before[-1]))
    return np.frombuffer(found.data, dtype=KINDS[found.encoding]).reshape(found.height, found.width)
