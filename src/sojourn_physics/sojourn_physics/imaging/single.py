"""Numbers in single precision, for kernels whose rows are. A number as Python writes it is double, and makes all that
it meets double, too, of which the processor takes half as many at once, and divides and takes roots a third as fast.
"""

from typing import Any, cast

import numpy as np

from sojourn_machine.kernels import vector_kernel


def constant(number: float) -> float:
    """A number of a module, for its kernels; to who checks types it is one like any other."""
    return cast(float, np.float32(number))


@vector_kernel
def narrowed(number: float) -> Any:
    """A number of a kernel."""
    return np.float32(number)


ZERO, HALF, ONE, TWO, THREE, FOUR = map(constant, (0.0, 0.5, 1.0, 2.0, 3.0, 4.0))
NEVER = constant(np.inf)
"""Where nothing is met."""
