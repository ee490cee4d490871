"""scripts/lib/environment.sh: is the set-up done? A quick look by times of change sees all that the full one sees."""

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ENVIRONMENT = Path(__file__).parents[2] / "scripts" / "lib" / "environment.sh"
STAMPS = ("dependencies", "packages", "kernels")
KERNEL = "src/one/one/kernel.py"


def holds(root: Path, condition: str) -> bool:
    """Whether a function of the file says yes there."""
    program = f"set -euo pipefail; . scripts/lib/environment.sh; {condition}"
    start = {"PATH": os.environ["PATH"], "HOME": str(root)}
    return subprocess.run(["bash", "-c", program], cwd=root, env=start, check=False).returncode == 0


def ready(root: Path) -> bool:
    return holds(root, "sojourn_ready || exit 1")


def unchanged(root: Path) -> bool:
    return holds(root, "sojourn_unchanged || exit 1")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A small project whose set-up is done, and marked as found so; what changes from now on is newer than the mark."""
    for name, text in {
        KERNEL: "@njit\n",
        "src/one/one/plain.py": "",
        "src/one/setup.py": "",
        "src/one/setup.cfg": "[metadata]\n",
        "requirements.lock": "numpy\n",
        ".venv/bin/python": "",
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / ".venv/bin/python").chmod(0o755)
    (tmp_path / ".venv/sojourn").mkdir()
    (tmp_path / "scripts/lib").mkdir(parents=True)
    shutil.copy(ENVIRONMENT, tmp_path / "scripts/lib")
    for stamp in STAMPS:
        assert holds(tmp_path, f'sojourn_fingerprint {stamp} >"$sojourn_venv/sojourn/{stamp}"')
    assert ready(tmp_path)
    mark, probe = tmp_path / ".venv/ready", tmp_path / "probe"
    probe.touch()
    os.utime(mark, ns=(probe.stat().st_ctime_ns,) * 2)
    while probe.stat().st_ctime_ns <= mark.stat().st_mtime_ns:  # times of change come in ticks
        probe.touch()
    assert unchanged(tmp_path)
    return tmp_path


def rewrite_and_set_back(root: Path) -> None:
    file = root / KERNEL
    before = file.stat()
    file.write_text("@njit \n", encoding="utf-8")
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))


CHANGES: dict[str, Callable[[Path], object]] = {
    "a kernel rewritten, its time set back": rewrite_and_set_back,
    "a kernel removed": lambda root: (root / KERNEL).unlink(),
    "a kernel moved": lambda root: (root / KERNEL).rename(root / "src/one/one/a_kernel.py"),
    "a kernel put in its place": lambda root: shutil.copy2(root / "src/one/one/plain.py", root / KERNEL),
    "a package added": lambda root: shutil.copytree(root / "src/one", root / "src/two"),
    "settings of a package": lambda root: (root / "src/one/setup.cfg").write_text("[options]\n", encoding="utf-8"),
    "a library": lambda root: (root / "requirements.lock").write_text("scipy\n", encoding="utf-8"),
    "a list of libraries more": lambda root: shutil.copy2(root / "requirements.lock", root / "requirements-ros.lock"),
    "a list of libraries less": lambda root: (root / "requirements.lock").unlink(),
    "a stamp removed": lambda root: (root / ".venv/sojourn/kernels").unlink(),
    "no interpreter": lambda root: (root / ".venv/bin/python").rename(root / ".venv/bin/python3.11"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_the_full_look_sees_the_quick_one_sees(project: Path, change: str) -> None:
    CHANGES[change](project)
    assert not unchanged(project)
    assert not ready(project)
    assert not unchanged(project), "nor is it marked as found up to date"


def test_what_does_not_matter_is_looked_at_once(project: Path) -> None:
    (project / "src/one/one/plain.py").write_text("# another comment\n", encoding="utf-8")
    assert not unchanged(project)
    assert ready(project)


def test_compiled_files_beside_the_sources_do_not_count(project: Path) -> None:
    (project / "src/one/one/__pycache__").mkdir()
    assert ready(project)
    mark = project / ".venv/ready"
    os.utime(mark, ns=((project / "src/one/one").stat().st_ctime_ns + 1,) * 2)
    (project / "src/one/one/__pycache__/kernel.cpython-311.pyc").touch()
    assert unchanged(project)


def test_a_project_that_was_moved_is_looked_at_again(project: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    moved = tmp_path_factory.mktemp("elsewhere") / "project"
    project.rename(moved)
    assert not unchanged(moved) and not ready(moved)
