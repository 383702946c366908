"""Benchmarks: what is measured, on what, and the reports. May use every room below."""
