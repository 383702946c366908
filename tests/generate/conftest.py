"""Models trained in seconds on small rooms, shared by the tests of generating and learning."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.generate.models import KINDS, shared_dataset, shared_model


@pytest.fixture(scope="session")
def dataset_folder() -> Path:
    """A dataset of twelve small rooms, with assets."""
    return shared_dataset()


@pytest.fixture(scope="session", params=KINDS)
def model_file(request: pytest.FixtureRequest) -> Path:
    """A model of each kind."""
    return shared_model(request.param)
