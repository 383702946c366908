"""Proposals become places: plan, settle, check, and put into the scene."""
