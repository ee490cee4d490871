"""numba's compiler, told first where the compiled kernels are kept. Every kernel takes `njit` from here.

numba takes half a second of a processor to load, so nothing that has no kernel imports this.
"""

import numba
from numba import njit, types  # noqa: TID251
from numba.experimental import structref

from sojourn_machine.kernel_cache import cache_folder

__all__ = ["njit", "structref", "types"]

numba.config.reload_config()  # here, or one that was there before us would at its next compilation, and lose the folder
if (_folder := cache_folder()) is not None:
    numba.config.CACHE_DIR = str(_folder)
