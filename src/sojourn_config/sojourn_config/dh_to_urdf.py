"""Writes the URDF of each Denavit-Hartenberg table that has one in `urdf/`: python -m sojourn_config.dh_to_urdf [FILE].

With a file, its URDF is printed instead. Tables of arms whose URDF is written by hand (ssrms) are left alone.
"""

import sys
from pathlib import Path

from sojourn_config.arms import dh_file, generated_urdf
from sojourn_config.errors import ConfigError
from sojourn_config.paths import urdf_folder

GENERATED = ("cartesian", "cylindrical", "puma560", "scara")


def main() -> int:
    """Write the files; 2 if a table cannot be read."""
    try:
        if len(sys.argv) > 1:
            print(generated_urdf(Path(sys.argv[1])), end="")
            return 0
        for name in GENERATED:
            text = generated_urdf(dh_file(name))
            (urdf_folder() / f"{name}.urdf").write_text(text, encoding="utf-8")
            print(f"urdf/{name}.urdf")
    except ConfigError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
