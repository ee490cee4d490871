"""numba's compiler, told first where the compiled kernels are kept. Every kernel takes `njit` from here.

numba takes half a second of a processor to load, so nothing that has no kernel imports this.
"""

from collections.abc import Callable
from typing import Any

import numba
from numba import njit, types  # noqa: TID251
from numba.experimental import structref

from sojourn_machine.kernel_cache import cache_folder

__all__ = ["kernel", "njit", "small_kernel", "structref", "types", "vector_kernel"]

numba.config.reload_config()  # here, or one that was there before us would at its next compilation, and lose the folder
if (_folder := cache_folder()) is not None:
    numba.config.CACHE_DIR = str(_folder)


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a kernel that makes no array and calls none that does: all that it works on is its callers'.

    numba counts the uses of an array, by an instruction that holds up the other cores, wherever it is handed on or
    sliced; of what a wheel on the ground costs that was a third. Where nothing is made, nothing need be counted. One
    that makes an array after all does not compile.
    """
    return njit(cache=True, _nrt=False)(function)


def small_kernel(function: Callable[..., Any]) -> Any:
    """As `kernel`, put into each of its callers: handing it an array or two would cost as much as it does."""
    return njit(cache=True, _nrt=False, forceinline=True)(function)


def vector_kernel(function: Callable[..., Any]) -> Any:
    """As `small_kernel`, for what is done to each number of a row.

    To divide by zero gives infinity, as in numpy: with a branch to an error the compiler cannot take several at once.
    """
    return njit(cache=True, _nrt=False, forceinline=True, error_model="numpy")(function)
