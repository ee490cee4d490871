"""Grids of cells: as many as their sides say, and in each a percentage, or -1 where nothing is known."""

import numpy as np

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation

NOT_KNOWN, CLOSED = -1, 100


class GridRule:
    """The grids of one topic."""

    name = "grid"

    def judge(self, seen: Observation) -> list[Finding]:
        """Cells that are too many or too few, and those that say what a cell cannot."""
        info = seen.message.info
        cells = np.asarray(seen.message.data, dtype=np.int64)
        count = info.width * info.height
        if len(cells) != count:
            allowed = f"{count} cells: {info.width} x {info.height}"
            return [Finding("data", f"{len(cells)} cells", allowed, abs(len(cells) - count))]
        allowed = f"{NOT_KNOWN} to {CLOSED}"
        beyond = np.maximum(NOT_KNOWN - cells, cells - CLOSED)
        return [
            Finding(f"data[{place}]", int(cells[place]), allowed, float(beyond[place]))
            for place in np.flatnonzero(beyond > 0)
        ]
