"""Node of the scripted operator, the shell round `app`. It keeps a file of what became of each step."""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rclpy.context import Context

from sojourn_contract import process
from sojourn_contract.app_node import AppNode
from sojourn_operator.app import OperatorApp
from sojourn_operator.script import StepResult, results_as_data, results_from_data


class OperatorNode(AppNode):
    """Role operator. Parameter `result_file`: where to write what became of each step ("" for nowhere)."""

    app_class = OperatorApp
    app: OperatorApp

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__(context=context, overrides=overrides, namespace=namespace)
        self._result_file: str = self.declare_parameter("result_file", "").value
        self.state = replace(self.state, script=self.app.script.begin(self._earlier_results()))

    @property
    def results(self) -> Sequence[StepResult]:
        """What became of the steps so far."""
        return self.state.script.results

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """One step of the app; what is new of its results goes into the file."""
        known = len(self.results)
        super().on_period(stamp, inputs, goals)
        if len(self.results) > known:
            self._write_results()
        if self.state.script.finished and not self.app.script.has_succeeded(self.state.script):
            self.exit_status = 1

    def _earlier_results(self) -> list[StepResult]:
        """Steps that an operator of this run had finished before it died."""
        file = Path(self._result_file)
        if not self._result_file or not file.is_file():
            return []
        return results_from_data(json.loads(file.read_text(encoding="utf-8")))

    def _write_results(self) -> None:
        if self._result_file:
            file = Path(self._result_file)
            fresh = file.with_suffix(".new")
            fresh.write_text(json.dumps(results_as_data(self.results), indent=2) + "\n", encoding="utf-8")
            fresh.replace(file)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(OperatorNode))


if __name__ == "__main__":
    main()
