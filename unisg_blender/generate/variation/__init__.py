"""What varies from room to room, and rooms that vary so."""

from __future__ import annotations
