"""Every thesis table, the simulated ones included, ends as recorded."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest


@pytest.mark.slow
def test_no_table_ends_otherwise_than_recorded(tmp_path, request):
    command = [sys.executable, "-m", "tactsim.cli", "validate", "--out", str(tmp_path / "report")]
    done = subprocess.run(command, cwd=request.config.rootpath, capture_output=True, text=True, timeout=2400)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr
    report = (tmp_path / "report" / "validation.json").read_text()
    assert json.loads(report)
    assert "table_3_2" in report
    assert "section_6_6" in report
