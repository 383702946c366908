"""Models trained in seconds on small rooms, shared by the tests of generating and learning."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.generate.models import trained


@pytest.fixture(scope="session")
def dataset_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dataset of twelve small rooms, with assets."""
    from tests.generate.models import write_rooms

    return write_rooms(tmp_path_factory.mktemp("rooms") / "dataset", 12)


@pytest.fixture(scope="session", params=["cgvae", "anchors"])
def model_file(request: pytest.FixtureRequest, dataset_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model of each kind."""
    return trained(
        dataset_folder, tmp_path_factory.mktemp("models") / f"{request.param}.onnx", request.param == "cgvae"
    )
