"""What the packages say of themselves (package.xml, setup.cfg) against what their code does."""

import ast
import configparser
import json
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from sojourn_contract.topics import TOPICS

ROOT = Path(__file__).parents[2]
PACKAGES = sorted(path.parent.name for path in ROOT.glob("src/*/package.xml"))
NODES = {
    "sojourn_plant": "plant",
    "sojourn_sensors": "sensors",
    "sojourn_drive": "drive",
    "sojourn_arm": "arm",
    "sojourn_power": "power",
    "sojourn_bags": "recorder",
    "sojourn_operator": "operator",
}

# Import name -> rosdep key. None: rosdep has no key, so that only requirements.lock can name it.
DEPENDENCY_OF_MODULE = {
    "PIL": "python3-pil",
    "annotated_types": None,
    "builtin_interfaces": "builtin_interfaces",
    "coal": None,
    "coverage": "python3-coverage",
    "cv2": "python3-opencv",
    "dask": "python3-dask",
    "diagnostic_msgs": "diagnostic_msgs",
    "distributed": None,
    "geometry_msgs": "geometry_msgs",
    "lz4": "python3-lz4",
    "matplotlib": "python3-matplotlib",
    "mcap": None,
    "nav_msgs": "nav_msgs",
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "pinocchio": "pinocchio",
    "psutil": "python3-psutil",
    "pyarrow": None,
    "pydantic": "python3-pydantic",
    "pydantic_core": "python3-pydantic",
    "rasterio": None,
    "rcl_interfaces": "rcl_interfaces",
    "rclpy": "rclpy",
    "rich": None,
    "rosbags": None,
    "rosgraph_msgs": "rosgraph_msgs",
    "ruckig": None,
    "scipy": "python3-scipy",
    "sensor_msgs": "sensor_msgs",
    "setproctitle": "python3-setproctitle",
    "std_msgs": "std_msgs",
    "trajectory_msgs": "trajectory_msgs",
    "trimesh": None,
    "viser": None,
    "websockets": "python3-websockets",
    "yaml": "python3-yaml",
    "zstandard": None,
} | {package: package for package in PACKAGES}

# tf2_msgs is published where it can be imported and done without elsewhere: it is no dependency.
OPTIONAL_MODULES = {"tf2_msgs"}


def manifest(package: str) -> ElementTree.Element:
    return ElementTree.parse(ROOT / "src" / package / "package.xml").getroot()


def setup_options(package: str) -> configparser.ConfigParser:
    options = configparser.ConfigParser(interpolation=None)
    options.read(ROOT / "src" / package / "setup.cfg", encoding="utf-8")
    return options


def imported_modules(package: str) -> set[str]:
    """Top-level names that the package's code imports, anywhere in a file."""
    modules = set()
    for path in (ROOT / "src" / package / package).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), filename=str(path))):
            if isinstance(node, ast.Import):
                modules |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
                modules.add(node.module.split(".")[0])
    return modules - set(sys.stdlib_module_names) - OPTIONAL_MODULES - {package}


def test_every_package_is_found() -> None:
    assert len(PACKAGES) == 17
    assert sorted(path.name for path in ROOT.glob("src/sojourn_*")) == PACKAGES
    assert set(NODES) < set(PACKAGES)


@pytest.mark.parametrize("package", PACKAGES)
def test_manifest_is_complete(package: str) -> None:
    root = manifest(package)
    assert root.tag == "package" and root.get("format") == "3"
    assert root.findtext("name") == package
    assert root.findtext("license") == "Apache-2.0"
    assert root.findtext("maintainer")
    assert root.find("maintainer").get("email", "").endswith("@sojourn.example")
    assert root.findtext("export/build_type") == "ament_python"
    assert [depend.text for depend in root.iter("test_depend")] == ["python3-pytest"]


@pytest.mark.parametrize("package", PACKAGES)
def test_manifest_and_setup_agree(package: str) -> None:
    root, options = manifest(package), setup_options(package)
    for key in ("name", "version", "description", "license"):
        assert options["metadata"][key] == root.findtext(key), key


def test_one_version() -> None:
    assert len({manifest(package).findtext("version") for package in PACKAGES}) == 1


@pytest.mark.parametrize("package", PACKAGES)
def test_dependencies_are_the_imports(package: str) -> None:
    modules = imported_modules(package)
    unknown = modules - DEPENDENCY_OF_MODULE.keys()
    assert not unknown, f"{package} imports {sorted(unknown)}: add to DEPENDENCY_OF_MODULE and to pyproject.toml"
    needed = {DEPENDENCY_OF_MODULE[module] for module in modules} - {None}
    if package == "sojourn_contract":  # makes publishers and subscriptions of classes by the names in the table
        needed |= {row.type.partition("/")[0] for row in TOPICS}
    declared = {depend.text for depend in manifest(package).iter("exec_depend")}
    assert declared == needed, f"missing {sorted(needed - declared)}, superfluous {sorted(declared - needed)}"


@pytest.mark.parametrize("package", PACKAGES)
def test_entry_point_is_the_node(package: str) -> None:
    options = setup_options(package)
    scripts = options.get("options.entry_points", "console_scripts", fallback="").strip()
    if package not in NODES:
        assert scripts == ""
        return
    name, target = (part.strip() for part in scripts.split("="))
    assert name == NODES[package]
    module, function = target.split(":")
    path = ROOT / "src" / package / (module.replace(".", "/") + ".py")
    names = {node.name for node in ast.parse(path.read_text(encoding="utf-8")).body if hasattr(node, "name")}
    assert function in names, f"{path.relative_to(ROOT)} defines no {function}"
    if package != "sojourn_operator":  # whose package is the goal client's, too: python -m sojourn_operator.node
        assert (ROOT / "src" / package / package / "__main__.py").is_file(), "python -m starts the node, too"


@pytest.mark.parametrize("package", PACKAGES)
def test_files_for_ament_and_colcon(package: str) -> None:
    folder, options = ROOT / "src" / package, setup_options(package)
    assert (folder / "resource" / package).is_file()
    assert (folder / "README.md").read_text(encoding="utf-8").startswith(f"# {package}\n")
    assert (folder / "CHANGELOG.rst").is_file()
    assert options["options.data_files"]["share/ament_index/resource_index/packages"] == f"resource/{package}"
    assert options["options.data_files"][f"share/{package}"] == "package.xml"
    assert options["options.extras_require"]["test"] == "pytest", "without it, colcon test finds no test"
    assert options["develop"]["script_dir"] == options["install"]["install_scripts"] == f"$base/lib/{package}"


@pytest.mark.parametrize("package", PACKAGES)
def test_every_folder_of_code_is_installed(package: str) -> None:
    """`packages = find:` passes over a folder without __init__.py, and over files that are not Python."""
    for path in (ROOT / "src" / package / package).rglob("*"):
        if "__pycache__" in path.parts or any(part.startswith(".") for part in path.relative_to(ROOT).parts):
            continue
        if path.is_dir():
            assert (path / "__init__.py").is_file(), f"{path.relative_to(ROOT)} has no __init__.py"
        else:
            assert path.suffix == ".py", f"{path.relative_to(ROOT)} would be left out of an installation"


def test_colcon_meta_names_packages_and_tests_that_exist() -> None:
    names = json.loads((ROOT / "colcon.meta").read_text(encoding="utf-8"))["names"]
    assert names.keys() <= set(PACKAGES)
    for package, settings in names.items():
        for argument in settings["pytest-args"]:
            assert (ROOT / "src" / package / argument).resolve().exists(), f"{package}: {argument}"


def test_direct_dependencies_are_locked_with_hashes() -> None:
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["dependency-groups"]
    locks = {path: path.read_text(encoding="utf-8") for path in ROOT.glob("requirements*.lock")}
    pinned = {line.split()[0].lower() for text in locks.values() for line in text.splitlines() if "==" in line}
    for group, requirements in groups.items():
        for requirement in requirements:
            assert requirement.lower() in pinned, f"{group}: {requirement} is not in a lock file; run scripts/lock"
    for path, text in locks.items():
        entries = [entry for entry in text.split("\n") if entry and entry[0] not in "# "]
        assert entries and all(entry.endswith("\\") for entry in entries), f"{path.name}: an entry without a hash"
        assert "://" not in text and "-url" not in text, f"{path.name} names a host"


def test_layers_and_types_cover_every_package() -> None:
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    assert sorted(tools["importlinter"]["root_packages"]) == PACKAGES
    assert sorted(Path(path).name for path in tools["mypy"]["mypy_path"]) == PACKAGES
    layers = tools["importlinter"]["contracts"][0]["layers"]
    assert sorted(name for layer in layers for name in layer.split(" | ")) == PACKAGES


def test_the_contract_of_purity_covers_all_models() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    pure = next(contract for contract in contracts if "rclpy" in contract.get("forbidden_modules", ()))
    machine = ROOT / "src/sojourn_machine/sojourn_machine"
    modules = {path.stem for path in machine.glob("[a-z]*") if path.suffix == ".py" or path.is_dir()}
    expected = {"sojourn_physics", "sojourn_flight", "sojourn_analysis"} | {
        f"sojourn_machine.{name}" for name in modules
    }
    assert set(pure["source_modules"]) == expected - {"sojourn_machine.arithmetic", "sojourn_machine.kernel_cache"}


def test_no_path_of_a_machine_and_no_loose_end() -> None:
    homes = ("/" + "root/", "/" + "home/", "/" + "Users/")
    loose_ends = ("FIX" + "ME", "TO" + "DO", "XX" + "X")
    folders = ("src", "config", "urdf", "test", "scripts", ".ci")
    names = ("*.py", "*.xml", "*.cfg", "*.md", "*.rst", "*.yaml", "*.urdf", "*.sh")
    found = [
        f"{path.relative_to(ROOT)}: {word}"
        for folder in folders
        for name in names
        for path in (ROOT / folder).rglob(name)
        for word in (*homes, *loose_ends)
        if word in path.read_text(encoding="utf-8")
    ]
    assert not found
