"""A comparison of telemetry: `/battery_state.percentage > 0.4 and /drive/status.state == reached`."""

import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.named_fields import FieldValue, NamedField, as_number, named_field
from sojourn_contract.topic_table import TopicTable
from sojourn_operator.sequence.status_words import check_words

OPERATORS: Mapping[str, Callable[[FieldValue, FieldValue], bool]] = {
    ">=": operator.ge, "<=": operator.le, "==": operator.eq, "!=": operator.ne, ">": operator.gt, "<": operator.lt,
}  # fmt: skip
_ONE = re.compile(r"\s*(?P<field>/.+?)\s*(?P<operator>>=|<=|==|!=|>|<)\s*(?P<value>.+?)\s*")


@dataclass(frozen=True)
class Condition:
    """One comparison."""

    field: NamedField
    operator: str
    value: FieldValue

    def holds(self, values: Mapping[str, FieldValue]) -> bool:
        """Whether it does, by the latest value of each field; not while there is none, nor for a text beside a number
        that is asked to be larger or smaller.
        """
        value = values.get(self.field.name)
        if value is None:
            return False
        if isinstance(value, float) != isinstance(self.value, float):
            return self.operator == "!="
        return bool(OPERATORS[self.operator](value, self.value))

    def __str__(self) -> str:
        value = f"{self.value:g}" if isinstance(self.value, float) else self.value
        return f"{self.field.name} {self.operator} {value}"


def conditions(text: str, table: TopicTable) -> tuple[Condition, ...]:
    """Those of a text, all of which have to hold. Raises UnknownFieldNameError for what is none."""
    found = []
    for part in re.split(r"\s+and\s+", text.strip()):
        one = _ONE.fullmatch(part)
        if one is None:
            allowed = "allowed is FIELD and one of " + " ".join(OPERATORS) + " and a value"
            raise UnknownFieldNameError(part, f"is no comparison: {allowed}", ())
        value = as_number(one["value"].strip("'\""))
        if isinstance(value, str) and one["operator"] not in ("==", "!="):
            raise UnknownFieldNameError(part, f"{value!r} is a text: allowed is == or !=", ())
        field = named_field(one["field"], table)
        check_words(field, value)
        found.append(Condition(field, one["operator"], value))
    return tuple(found)
