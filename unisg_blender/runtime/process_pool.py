"""Other Python processes to compute in."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context

from ..errors import UniSGError
from .process_end import end_with_parent

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def blender_program() -> str:
    """The Blender that this Python runs inside; "" outside of it, also with the module ``bpy``."""
    return getattr(getattr(sys.modules.get("bpy"), "app", None), "binary_path", "")


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def processes(asked: int | None) -> int:
    """Processes to use, by default one per processor; inside Blender one, whose program starts no other Python."""
    return 1 if blender_program() else asked or processors()


def limit_threads(most: int) -> None:
    """Let libraries that compute in this process use at most so many threads; those loaded later see it, and torch."""
    os.environ.update(dict.fromkeys(THREADS, str(most)))
    if "torch" in sys.modules:
        sys.modules["torch"].set_num_threads(most)


@contextmanager
def process_pool(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """New Python processes that compute on one thread each and end with this one, however it ends.

    What has not begun when the block is left is not done; when it is left by an error, what has begun neither.
    """
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), initializer=_begin)
    others = active_children()
    try:
        yield pool
    except BaseException as error:
        for process in active_children():
            if process not in others:
                process.kill()
        if isinstance(error, BrokenExecutor):
            raise UniSGError(
                "another Python process ended before its work was done (out of memory, or a script without "
                "'if __name__ == \"__main__\":'): use --jobs 1"
            ) from None
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        for name, value in before.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value


def _begin() -> None:
    """Leave Ctrl-C, which the terminal sends to all processes, to the one that began."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
