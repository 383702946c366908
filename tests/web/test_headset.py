"""An emulated headset plays a lesson to its end with its hands: `make test-web`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.web.browser_runs import looked_at, needs_browser
from unisg_blender.web import write_site
from unisg_blender.worlds import living_room


@pytest.mark.slow
@needs_browser
def test_hands_grab_place_and_use(tmp_path: Path) -> None:
    write_site(living_room(0), tmp_path)
    assert '"finished":true' in looked_at("headset_test.mjs", tmp_path)
