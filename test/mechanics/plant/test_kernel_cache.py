"""Compiled kernels are kept by the version of all their sources together."""

import os
import shutil
import time
from pathlib import Path

import numba
import pytest

from sojourn_mechanics import kernel_cache


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the package's sources that the cache takes for its own; numba's setting is put back."""
    copy = tmp_path / "sojourn_mechanics"
    shutil.copytree(kernel_cache.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(kernel_cache, "PACKAGE", copy)
    monkeypatch.setattr(numba.config, "CACHE_DIR", numba.config.CACHE_DIR)
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    return copy


def test_the_digest_follows_every_kernel_file(package: Path) -> None:
    first = kernel_cache.sources_digest()
    assert kernel_cache.sources_digest() == first
    (package / "errors.py").write_text("# no kernel in here\n", encoding="utf-8")
    assert kernel_cache.sources_digest() == first
    seen = {first}
    for name in ("contact/wheel_on_soil.py", "soil/pressure_sinkage.py", "terrain/height_field.py"):
        file = package / name
        file.write_text(file.read_text(encoding="utf-8") + "\n# another version\n", encoding="utf-8")
        seen.add(kernel_cache.sources_digest())
    assert len(seen) == 4


def test_the_digest_follows_a_file_that_moves(package: Path) -> None:
    first = kernel_cache.sources_digest()
    (package / "contact" / "wheel_on_soil.py").rename(package / "contact" / "wheel.py")
    assert kernel_cache.sources_digest() != first


def test_only_folders_that_nobody_uses_are_removed(package: Path) -> None:
    home = package / "__pycache__"
    folders = {name: home / f"{kernel_cache.PREFIX}{name}" for name in ("old", "fresh")}
    other = home / "something_else"
    for folder in (*folders.values(), other):
        folder.mkdir(parents=True)
    long_ago = time.time() - 2.0 * kernel_cache.KEPT_S
    for folder in (folders["old"], other):
        os.utime(folder, (long_ago, long_ago))
    kernel_cache.use_versioned_cache()
    assert not folders["old"].exists()
    assert folders["fresh"].exists() and other.exists()
    assert Path(numba.config.CACHE_DIR) == home / (kernel_cache.PREFIX + kernel_cache.sources_digest())


def test_the_choice_of_the_user_stands(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", "elsewhere")
    before = numba.config.CACHE_DIR
    kernel_cache.use_versioned_cache()
    assert before == numba.config.CACHE_DIR
