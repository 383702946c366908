"""Where geometric algebra helps networks over rooms, and where less of it does as well: ``unisg benchmark algebra``."""
