"""Learn pictures and scenegraphs together: which graph is of which picture?

    unisg world living-room --count 40 --out rooms
    unisg render rooms --out pictures --views eye=4 --size 128 --engine workbench
    python docs/examples/pictures_and_graphs.py pictures

One small network looks at pictures with their depth, another at graphs; both give a direction, and learn that those of
a pair point the same way (Radford et al. 2021, CLIP). Pictures that were left out say how well: how often the right
graph is the nearest of all. A minute on one core.
"""

from __future__ import annotations

import argparse
import time

import torch
from torch import Tensor, nn
from torch.nn import functional

from unisg_blender.dataset import PictureDataset

WIDTH, SIDE, SHARPNESS = 64, 64, 10.0


class PictureNetwork(nn.Module):
    """Pictures with depth (B, 4, SIDE, SIDE) to directions (B, WIDTH)."""

    def __init__(self) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for before, after in ((4, 16), (16, 32), (32, 64)):
            layers += [nn.Conv2d(before, after, 5, stride=2, padding=2), nn.BatchNorm2d(after), nn.ReLU()]
        self.layers = nn.Sequential(*layers, nn.AdaptiveAvgPool2d(2), nn.Flatten(), nn.Linear(256, WIDTH))

    def forward(self, pictures: Tensor) -> Tensor:
        """Directions of length 1."""
        return functional.normalize(self.layers(pictures), dim=1)


class GraphNetwork(nn.Module):
    """Graphs to directions (B, WIDTH): entities hear of what they are related to, and are averaged."""

    def __init__(self, categories: int) -> None:
        super().__init__()
        self.kinds = nn.Embedding(categories + 1, WIDTH)
        self.own, self.others = nn.Linear(WIDTH, WIDTH), nn.Linear(WIDTH, WIDTH)
        self.out = nn.Sequential(nn.ReLU(), nn.Dropout(0.2), nn.Linear(2 * WIDTH, WIDTH))

    def forward(self, graphs: list[tuple[Tensor, Tensor]]) -> Tensor:
        """Directions of length 1."""
        found = []
        for category, edges in graphs:
            kinds = self.kinds(category + 1)
            heard = torch.zeros_like(kinds).index_add(0, edges[1], kinds[edges[0]])
            heard = heard / torch.bincount(edges[1], minlength=len(kinds)).clamp(min=1)[:, None]
            entities = torch.relu(self.own(kinds) + self.others(heard))
            found.append(torch.cat([entities.mean(0), entities.max(0).values]))
        return functional.normalize(self.out(torch.stack(found)), dim=1)


def loaded(folder: str) -> tuple[Tensor, list[tuple[Tensor, Tensor]], int]:
    """All pictures with their depth (N, 4, SIDE, SIDE); of each graph categories (E,) and relations (2, R)."""
    data = PictureDataset(folder)
    pictures, graphs = [], []
    for record in (data[place] for place in range(len(data))):
        depth = torch.nan_to_num(1 / record["depth"], posinf=0.0)[None]
        seen = torch.cat([record["picture"] / 255, depth.clamp(0, 2)])
        pictures.append(functional.interpolate(seen[None], (SIDE, SIDE), mode="area")[0])
        graph = record["graph"]
        related = [graph[kind].edge_index for kind in graph.edge_types if kind[0] == kind[2] == "entity"]
        graphs.append((graph["entity"].category.long(), torch.cat(related, dim=1)))
    return torch.stack(pictures), graphs, len(data.graphs.columns.categories)


def main() -> None:
    """Train for some seconds and say how often the right graph is found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="what unisg render has made")
    parser.add_argument("--seconds", type=float, default=60.0)
    args = parser.parse_args()
    torch.manual_seed(0)
    pictures, graphs, categories = loaded(args.folder)
    first = len(pictures) * 4 // 5  # whole rooms are left out: their pictures follow one another
    looks, reads = PictureNetwork(), GraphNetwork(categories)
    optimizer = torch.optim.AdamW([*looks.parameters(), *reads.parameters()], 2e-3, weight_decay=1e-2)
    end, steps = time.monotonic() + args.seconds, 0
    while time.monotonic() < end:
        batch = torch.randperm(first)[:64]
        likeness = SHARPNESS * looks(pictures[batch]) @ reads([graphs[place] for place in batch]).T
        pairs = torch.arange(len(batch))
        loss = functional.cross_entropy(likeness, pairs) + functional.cross_entropy(likeness.T, pairs)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        steps += 1
    looks.eval()
    reads.eval()
    with torch.no_grad():
        likeness = looks(pictures[first:]) @ reads(graphs[first:]).T
    right = (likeness.argmax(dim=1) == torch.arange(len(likeness))).float().mean()
    near = (likeness.topk(min(5, len(likeness)), dim=1).indices == torch.arange(len(likeness))[:, None]).any(dim=1)
    print(f"{steps} steps, loss {loss.item():.2f}; of {len(likeness)} graphs the right one is found for "
          f"{right:.0%} of the pictures left out, among the nearest five for {near.float().mean():.0%} "
          f"(by chance {1 / len(likeness):.0%} and {min(5, len(likeness)) / len(likeness):.0%})")  # fmt: skip


if __name__ == "__main__":
    main()
