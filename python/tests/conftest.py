"""What every test needs: the examples, and the command that the wheel installed."""

from __future__ import annotations

import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "fixtures" / "examples"
Command = Callable[..., subprocess.CompletedProcess[bytes]]


@pytest.fixture(autouse=True)
def at_one_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every result says that it was made at the same second."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")


@pytest.fixture
def command() -> Command:
    program = Path(sysconfig.get_path("scripts")) / "dropcheck"

    def run(*words: object, cwd: Path | None = None) -> subprocess.CompletedProcess[bytes]:
        return subprocess.run([program, *map(str, words)], capture_output=True, check=False, cwd=cwd)

    return run
