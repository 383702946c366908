"""A graph network of one's own in PyG: the category of each thing, from its box, its pose and its neighbours.

unisg world living-room --count 40 --out rooms --format dataset --form sixd
python examples/own_network.py rooms
"""

import sys

import torch
from torch_geometric.nn import SAGEConv

from unisg_blender import UniSGDataset, UniSGError

if len(sys.argv) != 2:
    sys.exit(__doc__)
try:
    rooms = UniSGDataset(sys.argv[1])
except UniSGError as error:
    sys.exit(str(error))
train, test = rooms.split([0.8, 0.2], seed=0)
torch.manual_seed(0)
classes = len(rooms.vocabulary["categories"])
first, second, last = layers = torch.nn.ModuleList([SAGEConv(-1, 64), SAGEConv(64, 64), torch.nn.Linear(64, classes)])


def network(batch):
    """A number (N, C) for each thing and category: two rounds of messages between parents and children, an answer."""
    x, edges = torch.cat([batch["entity"].x, batch["trs"].x], dim=1), batch["entity", "parent_of", "entity"].edge_index
    both = torch.cat([edges, edges.flip(0)], dim=1)
    return last(second(first(x, both).relu(), both).relu())


network(next(iter(train.loader(batch_size=1))))  # PyG finds the width of what goes in
optimizer = torch.optim.Adam(layers.parameters(), 0.01)
for batch in (batch for epoch in range(30) for batch in train.loader(batch_size=8, shuffle=True, seed=epoch)):
    optimizer.zero_grad()
    torch.nn.functional.cross_entropy(network(batch), batch["entity"].category, ignore_index=-1).backward()
    optimizer.step()
right = [network(batch).argmax(1) == batch["entity"].category for batch in test.loader(batch_size=8)]
print(f"{torch.cat(right).float().mean():.0%} of the things in {len(test)} unseen rooms are told right")
