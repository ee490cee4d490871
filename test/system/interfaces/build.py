"""Builds the packages of this folder for Python, as colcon would: python build.py FOLDER gives it lib/ and python/.

Generators and headers are those of the ROS wheels; it takes a C++ compiler and the headers of Python.
"""

import json
import os
import subprocess
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path

HERE = Path(__file__).parent
PREFIX = Path(sys.prefix)
PACKAGES = ("nav2_msgs", "control_msgs")
KINDS = ("msg", "srv", "action")
FLAGS = ("-O0", "-fPIC", "-shared", "-w")


def main(target: Path) -> None:
    os.environ["AMENT_PREFIX_PATH"] = str(PREFIX)
    (target / "lib").mkdir(parents=True)
    for package in PACKAGES:
        Package(package, target).build()


class Package:
    """One package, all of whose interfaces are built."""

    def __init__(self, name: str, target: Path) -> None:
        self.name, self.lib = name, target / "lib"
        self.code = target / "python" / name
        self.more = target / "introspection" / name
        """Its files have the names of others of `code`."""
        self.files = sorted(path.relative_to(HERE / name) for kind in KINDS for path in (HERE / name / kind).glob("*"))
        self.roots = [target / "python", target / "introspection"]

    def build(self) -> None:
        self._generate()
        for header in (PREFIX / "include/action_msgs/action_msgs/msg").glob("rosidl_*visibility_control.h"):
            text = header.read_text("utf-8").replace("action_msgs", self.name)
            (self.code / "msg").mkdir(exist_ok=True)
            (self.code / "msg" / header.name).write_text(text.replace("ACTION_MSGS", self.name.upper()), "utf-8")
        (self.code / "__init__.py").touch()
        detail = list(self.code.glob("*/detail/*.c"))
        self._library("rosidl_generator_c", detail)
        self._library("rosidl_typesupport_fastrtps_c", self.code.glob("*/detail/*_c.cpp"))
        self._library("rosidl_typesupport_introspection_c", self.more.rglob("*.c"))
        self._library("rosidl_typesupport_c", self.code.glob("*/*__type_support.cpp"))
        self._library("rosidl_generator_py", self.code.glob("*/*_s.c"))
        entry = "rosidl_typesupport_c"
        self._compile([self.code / f"_{self.name}_s.ep.{entry}.c"], self.code / f"{self.name}_s__{entry}.so")

    def _generate(self) -> None:
        """Write sources, with the generators of rosidl."""
        from rosidl_adapter import convert_to_idl
        from rosidl_generator_c import generate_c
        from rosidl_generator_py import generate_py
        from rosidl_generator_type_description import generate_type_hash
        from rosidl_typesupport_c import generate_c as generate_typesupport
        from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
        from rosidl_typesupport_introspection_c import generate_c as generate_introspection

        idl = self.code.parent / "idl" / self.name
        for file in self.files:
            convert_to_idl(HERE / self.name, self.name, file, idl)
        names = [file.with_suffix(".idl") for file in self.files]
        share = [path for path in (PREFIX / "share").iterdir() if path.is_dir()]
        common = {
            "package_name": self.name,
            "idl_tuples": [f"{idl}:{name}" for name in names],
            "include_paths": [f"{path.name}:{path}" for path in share],
            "ros_interface_dependencies": [
                f"{path.name}:{file}" for path in share for kind in KINDS for file in (path / kind).glob("*.idl")
            ],
            "target_dependencies": [],
            "type_description_tuples": [f"{name}:{self.code / name.with_suffix('.json')}" for name in names],
        }

        def words(generator: str, output: Path) -> str:
            output.mkdir(parents=True, exist_ok=True)
            given = {"template_dir": str(PREFIX / "share" / generator / "resource"), "output_dir": str(output)}
            file = idl.parent / f"{self.name}_{generator}.json"
            file.write_text(json.dumps(common | given), "utf-8")
            return str(file)

        generate_type_hash(words("rosidl_generator_type_description", self.code))
        generate_c(words("rosidl_generator_c", self.code))
        generate_py(words("rosidl_generator_py", self.code), ["rosidl_typesupport_c"])
        supports = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]
        generate_typesupport(words("rosidl_typesupport_c", self.code), supports)
        generate_typesupport_fastrtps_c(words("rosidl_typesupport_fastrtps_c", self.code))
        generate_introspection(words("rosidl_typesupport_introspection_c", self.more))

    def _library(self, name: str, sources: Iterable[Path]) -> None:
        self._compile(list(sources), self.lib / f"lib{self.name}__{name}.so")

    def _compile(self, sources: list[Path], output: Path) -> None:
        """Compile and link against all that is there already, here and among the wheels."""
        import numpy

        folders = [*self.roots, *(path for path in (PREFIX / "include").iterdir() if path.is_dir()), PREFIX / "include"]
        includes = [f"-I{path}" for path in (*folders, sysconfig.get_paths()["include"], numpy.get_include())]
        wheels = [
            path
            for name in ("*__rosidl_*_c", "*__rosidl_generator_py", "rosidl_*_c", "rcutils", "rmw", "fastcdr")
            for path in (PREFIX / "lib").glob(f"lib{name}.so")
        ]
        libraries = [f"-l:{path.name}" for path in (*self.lib.glob("*.so"), *wheels)]
        command = ["g++" if sources[0].suffix == ".cpp" else "gcc", *FLAGS, *includes, *map(str, sources)]
        command += ["-o", str(output), f"-L{self.lib}", f"-L{PREFIX / 'lib'}", *libraries]
        subprocess.run(command, check=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
