"""Runs one export for the tests of faults, and dies at the N-th file that it writes if it is told to.

``driver.py IN OUT JOBS RESUME DIE_AT``; DIE_AT counts from 1, 0 is never.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset
from unisg_blender.errors import UniSGError
from unisg_blender.runtime import atomic_files

replace = os.replace
written = 0


def main() -> int:
    source, out, jobs, resume, die_at = sys.argv[1:]

    def dying_replace(old: os.PathLike[str], new: os.PathLike[str]) -> None:
        global written
        written += 1
        if written == int(die_at):
            if written % 2:  # sometimes before the file is in place, sometimes after
                replace(old, new)
            os.kill(os.getpid(), signal.SIGKILL)
        replace(old, new)

    atomic_files.os.replace = dying_replace
    options = ExportOptions(reader="fake_reader:read", timeout=60)
    try:
        export_dataset([Path(source)], Path(out), options, jobs=int(jobs), resume=resume == "resume")
    except UniSGError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
