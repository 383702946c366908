"""A graph network of one's own in PyG: the category of each thing, from its box, its pose and its neighbours.

unisg world living-room --count 40 --out rooms --format dataset --form sixd
python examples/own_network.py rooms
"""

import sys

import torch
from torch_geometric.nn import HeteroConv, SAGEConv
from torch_geometric.transforms import ToUndirected

from unisg_blender import UniSGDataset

EDGES = [("entity", "parent_of", "entity"), ("entity", "rev_parent_of", "entity"), ("trs", "rev_has", "entity")]


class Network(torch.nn.Module):
    def __init__(self, categories: int) -> None:
        super().__init__()
        self.convs = torch.nn.ModuleList(
            HeteroConv({edge: SAGEConv((-1, -1), 64) for edge in EDGES}, aggr="sum") for _ in range(2)
        )
        self.head = torch.nn.Linear(64, categories)

    def forward(self, batch):
        x = {"entity": batch["entity"].x, "trs": batch["trs"].x}
        for conv in self.convs:
            new = conv(x, {edge: batch[edge].edge_index for edge in EDGES})
            x = x | {name: value.relu() for name, value in new.items()}
        return self.head(x["entity"])


torch.manual_seed(0)
rooms = UniSGDataset(sys.argv[1], transform=ToUndirected(merge=False))
train, test = rooms.split([0.8, 0.2], seed=0)
network = Network(len(rooms.vocabulary["categories"]))
network(next(iter(train.loader(batch_size=1))))  # PyG finds the widths
optimizer = torch.optim.Adam(network.parameters(), 0.01)
for epoch in range(20):
    for batch in train.loader(batch_size=8, shuffle=True, seed=epoch):
        loss = torch.nn.functional.cross_entropy(network(batch), batch["entity"].category, ignore_index=-1)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
right = [network(batch).argmax(1) == batch["entity"].category for batch in test.loader(batch_size=8)]
print(f"{torch.cat(right).float().mean():.0%} of the things in {len(test)} unseen rooms are told right")
