"""Scene files of any kind, behind one read and one write."""
