"""Calls the contact law that a row names, whichever package it is from.

A row holds the address of its law's compiled code. Compiled callers so need not know which laws there are: a new one
neither changes them nor has them compiled again. An address is less than 2^53, so that a column of a row holds it
exactly. It lasts as long as the process: rows are made anew in each, and are in no state and no file.

A law has the one signature that `contact_law` gives, and is called as numba calls its own functions.
"""

from typing import Any

from numba.core import cgutils
from numba.extending import intrinsic

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import kernel, types
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import WheelColumn

ROW = types.Array(types.float64, 1, "C")
ARGUMENTS = (ROW, ROW, ROW, types.float64, ROW, ROW)
"""Of every law: wheel, soil, motion, dt, state, out."""


def row_entry(law: Any) -> float:
    """What stands for a law, compiled by `kernels.kernel`, in the column `LAW` of a row. It lasts while the law does.

    Raises:
        InvalidValueError: a function that is not such a kernel.
    """
    if not hasattr(law, "get_compile_result"):
        raise InvalidValueError("contact law", law, "a function compiled by sojourn_machine.kernels.kernel")
    law.compile(types.void(*ARGUMENTS))
    compiled = law.overloads[ARGUMENTS]
    return float(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))


@intrinsic
def _call_at(
    typing_context: Any, address: Any, wheel: Any, soil: Any, motion: Any, dt: Any, state: Any, out: Any
) -> tuple[Any, Any]:
    """Call the code at an address, by numba's own calling convention, which hands errors on."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        convention = context.call_conv
        kind = convention.get_function_type(types.none, ARGUMENTS)
        code = builder.inttoptr(values[0], kind.as_pointer())
        status, _ = convention.call_function(builder, code, types.none, ARGUMENTS, values[1:])
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return context.get_dummy_value()

    return types.void(types.int64, *ARGUMENTS), generate


@kernel
def apply_law(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law that the wheel's row names; arguments as in `contact_law`.

    Raises:
        ValueError: a row without a law.
    """
    address = int(wheel[WheelColumn.LAW])
    if address == 0:
        raise ValueError("a row without a contact law")
    _call_at(address, wheel, soil, motion, dt, state, out)
