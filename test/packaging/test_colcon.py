"""colcon sees every package as what it is. With a mistake in package.xml it would be plain Python, unsaid."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_colcon_lists_every_package_as_ament_python(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "colcon", "--log-base", str(tmp_path), "list", "--base-paths", "src"]
    listing = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=True)
    found = {tuple(line.split("\t")) for line in listing.stdout.splitlines()}
    packages = [path.parent.name for path in ROOT.glob("src/*/package.xml")]
    assert found == {(package, f"src/{package}", "(ros.ament_python)") for package in packages}
    assert listing.stderr == ""
