"""A benchmark that measures on how many threads this process computes."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any


def write_threads(args: argparse.Namespace, folder: Path, progress: Callable[[str], None]) -> dict[str, Any]:
    """Threads of torch and of numpy's linear algebra."""
    import numpy as np
    import torch
    from threadpoolctl import threadpool_info

    np.ones((200, 200)) @ np.ones((200, 200))
    pools = {pool["user_api"]: pool["num_threads"] for pool in threadpool_info()}
    (folder / "threads.txt").write_text("measured")
    return {"torch": torch.get_num_threads(), **pools}
