"""From a YAML file to a validated parameter set, or to a ConfigError with every problem in it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from sojourn_config.errors import MISSING, ConfigError
from sojourn_config.explain import problems_of
from sojourn_config.extends import read_document
from sojourn_config.overrides import override_document
from sojourn_config.paths import resolve
from sojourn_config.yaml_file import YamlDocument
from sojourn_machine.errors import MachineError

Model = TypeVar("Model", bound=BaseModel)


def load_params(
    kind: str,
    name: str,
    model: type[Model],
    overrides: Sequence[str] = (),
    asked_by: tuple[str, str] | None = None,
    folder: Path | None = None,
) -> Model:
    """Load one parameter set.

    Args:
        kind: folder of `config/`, as `soils`.
        name: name of the file in it without `.yaml`, or the path of a file.
        model: the schema.
        overrides: `KEY=VALUE` texts that go over the file.
        asked_by: file and key that name the set, for messages.
        folder: folder of the file that names the set: a relative path counts from it first.

    Raises:
        ConfigError: there is no such set, or its content is not what the schema allows.
    """
    document = read_document(resolve(kind, name, asked_by, () if folder is None else (folder, Path.cwd())), kind)
    return validate(override_document(document, overrides), model)


def validate(document: YamlDocument, model: type[Model]) -> Model:
    """The parameter set in a document. No value is converted: text is no number and a number is no text.

    Raises:
        ConfigError: with one problem for each thing that is wrong.
    """
    try:
        # Through JSON, because pydantic's strict mode takes a list for a tuple only from there.
        return model.model_validate_json(json.dumps(document.data), strict=True)
    except ValidationError as error:
        raise ConfigError(problems_of(error, model, document)) from error
    except MachineError as error:
        raise ConfigError([document.problem((), MISSING, str(error))]) from error
