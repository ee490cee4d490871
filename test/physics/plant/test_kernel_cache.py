"""Compiled kernels are kept by the version of all their sources together."""

import ast
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sojourn_machine import kernel_cache


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Copies of the packages' sources that the cache takes for its own."""
    folders = []
    for folder in kernel_cache.package_folders():
        copy = tmp_path / folder.name
        shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("__pycache__"))
        folders.append(copy)
    assert [folder.name for folder in folders] == list(kernel_cache.PACKAGES)
    monkeypatch.setattr(kernel_cache, "package_folders", lambda: iter(folders))
    monkeypatch.setattr(kernel_cache, "HOME", tmp_path / "sojourn_machine" / "__pycache__")
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    return tmp_path


def test_the_digest_follows_every_kernel_file(packages: Path) -> None:
    first = kernel_cache.sources_digest()
    assert kernel_cache.sources_digest() == first
    (packages / "sojourn_machine" / "errors.py").write_text("# no kernel in here\n", encoding="utf-8")
    assert kernel_cache.sources_digest() == first
    seen = {first}
    for name in (
        "sojourn_physics/contact/wheel_on_soil.py",
        "sojourn_flight/odometry/odometry_kernels.py",
        "sojourn_machine/power/battery_kernels.py",
        "sojourn_machine/contact_report.py",  # columns are compiled into kernels as numbers
        "sojourn_physics/soil/params.py",
        "sojourn_physics/contact/hysteresis.py",  # it has small kernels alone
        "sojourn_physics/soil/bearing.py",  # a constant of it is compiled into one
    ):
        file = packages / name
        file.write_text(file.read_text(encoding="utf-8") + "\n# another version\n", encoding="utf-8")
        seen.add(kernel_cache.sources_digest())
    assert len(seen) == 8


def test_no_constant_of_a_file_that_does_not_count_is_compiled_into_a_kernel() -> None:
    files = {
        ".".join(path.relative_to(package.parent).with_suffix("").parts): path.read_text(encoding="utf-8")
        for package in kernel_cache.package_folders()
        for path in package.rglob("*.py")
    }
    counted = {name for name, text in files.items() if any(mark in text.encode() for mark in kernel_cache.MARKS)}
    for name in counted:
        if "sojourn_machine.kernels" not in files[name]:
            continue
        tree = ast.parse(files[name])
        kernels = [
            function
            for function in ast.walk(tree)
            if isinstance(function, ast.FunctionDef)
            and any("kernel" in ast.unparse(mark) or "njit" in ast.unparse(mark) for mark in function.decorator_list)
        ]
        used = {node.id for kernel in kernels for node in ast.walk(kernel) if isinstance(node, ast.Name)}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module in files and node.module not in counted:
                constants = {alias.asname or alias.name for alias in node.names} & used
                assert not {constant for constant in constants if constant.isupper()}, f"{name} from {node.module}"


def test_the_set_up_asks_for_the_same_files() -> None:
    said = (Path(__file__).parents[3] / "scripts" / "lib" / "environment.sh").read_text(encoding="utf-8")
    assert "|".join(mark.decode().replace(".", r"\.") for mark in kernel_cache.MARKS) in said


def test_the_digest_follows_a_file_that_moves(packages: Path) -> None:
    first = kernel_cache.sources_digest()
    contact = packages / "sojourn_physics" / "contact"
    (contact / "wheel_on_soil.py").rename(contact / "wheel.py")
    assert kernel_cache.sources_digest() != first


def test_only_folders_that_nobody_uses_are_removed(packages: Path) -> None:
    home = packages / "sojourn_machine" / "__pycache__"
    folders = {name: home / f"{kernel_cache.PREFIX}{name}" for name in ("old", "fresh")}
    other = home / "something_else"
    for folder in (*folders.values(), other):
        folder.mkdir(parents=True)
    long_ago = time.time() - 2.0 * kernel_cache.KEPT_S
    for folder in (folders["old"], other):
        os.utime(folder, (long_ago, long_ago))
    assert kernel_cache.cache_folder() == home / (kernel_cache.PREFIX + kernel_cache.sources_digest())
    assert not folders["old"].exists()
    assert folders["fresh"].exists() and other.exists()


def test_the_choice_of_the_user_stands(packages: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", "elsewhere")
    assert kernel_cache.cache_folder() is None


def test_numba_keeps_our_kernels_in_the_folder_of_their_sources(tmp_path: Path) -> None:
    """Also where somebody has loaded numba before us, who would read the environment again at the next compilation."""
    program = """
import numba
from sojourn_machine import kernel_cache
from sojourn_machine.kernels import njit
njit(lambda x: x + 1)(1)
assert numba.config.CACHE_DIR == str(kernel_cache.cache_folder() or ""), numba.config.CACHE_DIR
"""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env=environment, check=True)
