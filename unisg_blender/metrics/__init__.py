"""Metrics, baselines and benchmark reports."""
