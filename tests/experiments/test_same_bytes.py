"""One command gives the same bytes on other processors, with a compiler and without."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from flightlog.file.reader import read_log
from tests.support.small_campaign import write_small_campaign


def regenerated(campaign: Path, folder: Path, **environment: str) -> tuple[bytes, str]:
    """Returns the library's bytes and the back-end of its flights."""
    words = ["regenerate", "--campaign", str(campaign), "--seed", "3", "--workers", "1"]
    words += ["--out", str(folder / "library.json"), "--logs", str(folder / "logs")]
    run = subprocess.run(
        [sys.executable, "-m", "maneuver", *words],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    log = read_log(min((folder / "logs").glob("*.mcap")))
    return (folder / "library.json").read_bytes(), log.header.backend


def dispatched_features() -> list[str]:
    """Returns the features of this processor that NumPy chooses code by."""
    known = np._core._multiarray_umath  # type: ignore[attr-defined]
    return [name for name in known.__cpu_dispatch__ if known.__cpu_features__.get(name)]


def test_a_library_has_the_same_bytes_without_cpu_features_and_without_a_compiler(tmp_path: Path) -> None:
    campaign = write_small_campaign(tmp_path, flights=3, nominal=3)
    nothing = tmp_path / "nothing"
    nothing.mkdir()
    usual, _ = regenerated(campaign, tmp_path / "usual")
    plain, _ = regenerated(
        campaign, tmp_path / "plain", NPY_DISABLE_CPU_FEATURES=" ".join(dispatched_features())
    )
    interpreted, backend = regenerated(
        campaign, tmp_path / "interpreted", PATH=str(nothing), XDG_CACHE_HOME=str(nothing)
    )
    assert usual == plain
    assert usual == interpreted
    assert backend.endswith("interpreted")
