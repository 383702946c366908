"""The one way to open a trained network: an ONNX file whose metadata say what it is for."""

from __future__ import annotations

import json
import math
import os
import threading
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from .json_records import parse_json
from .onnx_graph import part_for, unsafe_part

KEY = "unisg"
"""Name of the entry in a file's metadata that says what the network is."""

MOST_MEMORY = 2**32
"""Bytes that all networks of this process may compute in."""

MOST_SECONDS = 60.0
"""How long a network may compute at a time."""

LARGEST_INPUT = 2**24

OFTEN = 16
"""Runs from which on opening the part that they need again pays."""


_running: dict[int, tuple[float, Any]] = {}
"""When each run that is under way has to be done, and its options."""

_any_running = threading.Event()
_watch: threading.Thread | None = None


@contextmanager
def _limited(options: Any) -> Iterator[None]:
    """Let a run be ended when it is not done in time, by one thread for all runs: a thread each costs more than many
    a network. A process that was divided has none yet."""
    global _watch
    _running[id(options)] = time.monotonic() + MOST_SECONDS, options
    _any_running.set()
    if _watch is None or not _watch.is_alive():
        _watch = threading.Thread(target=_end_late_runs, name="unisg-onnx-limit", daemon=True)
        _watch.start()
    try:
        yield
    finally:
        del _running[id(options)]


def _end_late_runs() -> None:
    while _any_running.wait():
        now = time.monotonic()
        for until, options in list(_running.values()):
            if now >= until:
                options.terminate = True
        if not _running:
            _any_running.clear()
        time.sleep(min(1.0, MOST_SECONDS))


class OnnxModel:
    """An opened network: its ``path``, its ``metadata``, and the version of the ``contract`` that they follow.

    What gives outputs that are often asked for is opened once more on its own: among all the nodes of a large network
    onnxruntime looks for those that it has to run at each run anew, which takes longer than to run them.
    """

    def __init__(
        self, path: Path, metadata: dict[str, Any], contract: int, session: Any, opened: Callable[[Sequence[str]], Any]
    ) -> None:
        """``session`` runs the whole network, ``opened`` gives one that runs what some outputs need."""
        self.path, self.metadata, self.contract, self._whole, self._opened = path, metadata, contract, session, opened
        self._blank = {item.name: _blank(item, path) for item in session.get_inputs()}
        self._outputs = {item.name: item.shape for item in session.get_outputs()}
        self._asked: Counter[tuple[str, ...]] = Counter()
        self._parts: dict[tuple[str, ...], tuple[Any, dict[str, NDArray[Any]]]] = {}

    def run(self, outputs: Sequence[str] | None = None, /, **inputs: NDArray[Any]) -> list[NDArray[np.float32]]:
        """The named outputs, all if omitted, for the given inputs.

        What the network does not use is left out; what the outputs do not depend on may be missing.

        Raises
        ------
        UniSGError
            If the network has no such outputs, takes too much time or memory, or an output is not a number.
        """
        import onnxruntime

        missing = set(outputs or ()) - set(self._outputs)
        if missing:
            raise UniSGError(f"{self.path} has no output {min(missing)!r}: the model is damaged; train it again")
        options = onnxruntime.RunOptions()
        options.only_execute_path_to_fetches = True
        try:
            session, blank = self._session_for(tuple(outputs or self._outputs))
            known = {name: inputs.get(name, value) for name, value in blank.items()}
            with _limited(options):
                found: list[NDArray[np.float32]] = session.run(outputs, known, options)
        except Exception as error:  # onnxruntime has no common base class for its errors
            why = f"not done after {MOST_SECONDS:g} s" if options.terminate else _reason(error)
            raise UniSGError(f"{self.path} cannot be run ({why}): the model is damaged; train it again") from None
        if any(np.isnan(values).any() for values in found):
            raise UniSGError(f"{self.path} gives no finite numbers: the model is damaged; train it again")
        return found

    def _session_for(self, outputs: tuple[str, ...]) -> tuple[Any, dict[str, NDArray[Any]]]:
        """What runs some outputs, and blanks for what it wants to be given."""
        self._asked[outputs] += 1
        if outputs not in self._parts and len(outputs) < len(self._outputs) and self._asked[outputs] > OFTEN:
            part = self._opened(outputs)
            self._parts[outputs] = part, {item.name: self._blank[item.name] for item in part.get_inputs()}
        return self._parts.get(outputs, (self._whole, self._blank))

    def expect(self, name: str, *sizes: int | None) -> None:
        """UniSGError unless the input or output of that name has these last dimensions, as far as they are told."""
        shape = self._blank[name].shape if name in self._blank else self._outputs.get(name, ())
        last = shape[len(shape) - len(sizes) :] if len(shape) >= len(sizes) else ()
        wrong = any(
            isinstance(found, int) and size not in (None, found) for size, found in zip(sizes, last, strict=False)
        )
        if wrong or len(last) != len(sizes):
            raise damaged(self.path)


def _reason(error: Exception) -> str:
    return " ".join(str(error).split())[:160]


def _blank(item: Any, path: Path) -> NDArray[Any]:
    """The smallest input of an ONNX input's kind."""
    shape = [size if isinstance(size, int) else 1 for size in item.shape]
    known = item.type in ("tensor(float)", "tensor(int64)")
    if not known or min(shape, default=1) < 0 or math.prod(shape) > LARGEST_INPUT:
        raise UniSGError(f"{path} wants inputs that nothing here has ({item.name[:40]!r}): give another model")
    return np.zeros(shape, np.int64 if "int64" in item.type else np.float32)


def open_model(
    path: str | os.PathLike[str], task: str, contracts: Collection[int], job: str, threads: int = 1
) -> OnnxModel:
    """Open a network for a task.

    Parameters
    ----------
    contracts
        Versions of the task's metadata that this software knows.
    job
        The training that makes such a network: ``unisg train JOB``.
    threads
        Cores that it computes on.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX model, has what :func:`~.onnx_graph.unsafe_part` finds, or has no metadata of a
        known version for that task. Operators that onnxruntime does not bring along are refused by onnxruntime.
    """
    file = Path(path)
    if not file.is_file():
        raise UniSGError(f"there is no model {file}: train one with 'unisg train {job}', or give another path")
    data = file.read_bytes()
    try:
        unsafe = unsafe_part(data)
    except ValueError:
        raise UniSGError(f"{file} is no ONNX model: give another file") from None
    if unsafe:
        raise UniSGError(f"{file} has {unsafe}, which are not run: give a model from 'unisg train {job}'")
    try:
        session = _session(data, threads)
    except Exception as error:  # onnxruntime has no common base class for its errors
        raise UniSGError(f"{file} is no ONNX model that can be run ({_reason(error)}): give another file") from None
    try:
        text = session.get_modelmeta().custom_metadata_map.get(KEY)
    except UnicodeDecodeError:
        raise damaged(file) from None
    if text is None:
        raise UniSGError(f"{file} is another ONNX model, it has no UniSG metadata: give one from 'unisg train {job}'")
    known = read_metadata(text, file, task, contracts, job)
    return OnnxModel(file, *known, session, lambda outputs: _session(part_for(data, outputs), threads))


def _session(data: bytes, threads: int) -> Any:
    """What runs a network."""
    import onnxruntime

    _limit_memory()
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 4
    options.add_session_config_entry("session.use_env_allocators", "1")
    return onnxruntime.InferenceSession(  # folding would compute without a limit
        data, options, providers=["CPUExecutionProvider"], disabled_optimizers=["ConstantFolding"]
    )


@cache
def _limit_memory() -> None:
    """Give all networks one store of memory, which refuses to grow beyond a limit."""
    import onnxruntime

    where = onnxruntime.OrtMemoryInfo(
        "Cpu", onnxruntime.OrtAllocatorType.ORT_ARENA_ALLOCATOR, 0, onnxruntime.OrtMemType.DEFAULT
    )
    onnxruntime.create_and_register_allocator(where, onnxruntime.OrtArenaCfg({"max_mem": MOST_MEMORY}))


def metadata_text(task: str, contract: int, **entries: Any) -> str:
    """The entry for the metadata of a network, JSON."""
    return json.dumps({"contract": contract, "task": task, **entries}, ensure_ascii=False, sort_keys=True)


def read_metadata(text: str, path: Path, task: str, contracts: Collection[int], job: str) -> tuple[dict[str, Any], int]:
    """The entries and the contract that :func:`metadata_text` was given.

    Raises
    ------
    UniSGError
        If they are damaged, for another task or of another version.
    """
    try:
        record = dict(parse_json(text, str(path)))
        version, found = record.pop("contract"), record.pop("task")
    except (UniSGError, ValueError, KeyError, TypeError):
        raise damaged(path) from None
    if found != task:
        raise UniSGError(f"{path} is a model for {found!r}: give one from 'unisg train {job}'")
    if version not in contracts:
        known = max(contracts)
        raise UniSGError(f"{path} has contract {version}, this software knows {known}: update it or train again")
    return record, version


def damaged(path: Path) -> UniSGError:
    """The error for metadata without what belongs there."""
    return UniSGError(f"{path}: the model's metadata is damaged: train it again")
