"""Rooms by many machines: a Dask scheduler gives them out. Here processes on this machine stand for the machines.

python examples/dask_farm.py out 8
python examples/dask_farm.py out 1000 tcp://10.0.0.1:8786     # a scheduler whose workers see the same folder
"""

import sys

try:
    from distributed import Client, LocalCluster
except ImportError:
    sys.exit('Dask is missing: pip install "unisg-blender[cluster]"')
from unisg_blender.batches import BatchOptions, make_batch, plan_rooms
from unisg_blender.batches.room_makers import WORLD

if __name__ == "__main__":  # workers import this file
    if len(sys.argv) not in (3, 4) or not sys.argv[2].isdecimal():
        sys.exit(__doc__)
    out, count = sys.argv[1], int(sys.argv[2])
    farm = sys.argv[3] if len(sys.argv) > 3 else LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with Client(farm) as client:
        options = BatchOptions(WORLD, {"world": "living-room", "function": ""}, "dataset")
        records = make_batch(plan_rooms([], count, 0, "room"), out, options, executor=client.get_executor(pure=False))
    failed = [record for record in records if record["status"] != "ok"]
    print(f"{out}: {len(records) - len(failed)} rooms with {sum(record['entities'] for record in records)} entities")
