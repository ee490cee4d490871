"""Do nothing for a while."""

from pydantic import ConfigDict, Field, RootModel

from sojourn_config.steps import LONGEST
from sojourn_contract.stamps import NANOSECONDS
from sojourn_operator.steps.step import WAITED, OperatorStep, View


class WaitStep(RootModel[float], OperatorStep):
    """Time to wait [s]."""

    model_config = ConfigDict(frozen=True)
    root: float = Field(ge=0.0, le=LONGEST, allow_inf_nan=False, description="time to wait [s]")

    def describe(self) -> str:
        """See OperatorStep."""
        return f"wait {self.root:g} s"

    def rests_until(self, view: View) -> int:
        """See OperatorStep."""
        return view.since + round(self.root * NANOSECONDS)

    def end(self, view: View) -> tuple[str, str] | None:
        """See OperatorStep."""
        return (WAITED, "") if view.is_over(self.root) else None
