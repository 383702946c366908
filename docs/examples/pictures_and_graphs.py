"""Learn from pictures and scenegraphs together: what is each thing that a picture shows?

    unisg world living-room --count 40 --out rooms
    unisg render rooms --out pictures --views eye=4 --size 128 --engine workbench
    python docs/examples/pictures_and_graphs.py pictures

A small network looks at the pixels of each thing, cut out by its mask; then each hears from what it is related to in
the scenegraph what that looks like. It is trained twice, without the scenegraph and with it. Of the things in rooms
that were left out it says how many each has told right. A minute on one core.
"""

from __future__ import annotations

import argparse

import torch
from torch import Tensor, nn
from torch.nn import functional

from unisg_blender.dataset import PictureDataset

WIDTH, SIDE, TOGETHER = 64, 24, 8


class Network(nn.Module):
    """Cut-outs (E, 5, SIDE, SIDE) and relations (2, R) of so many kinds to scores of categories (E, C)."""

    def __init__(self, kinds: int, categories: int) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for before, after in ((5, 16), (16, 32), (32, WIDTH)):
            layers += [nn.Conv2d(before, after, 3, stride=2, padding=1), nn.BatchNorm2d(after), nn.ReLU()]
        self.looks = nn.Sequential(*layers, nn.Flatten(), nn.Linear(WIDTH * 9, WIDTH))
        self.told = nn.ModuleList(nn.Linear(WIDTH, WIDTH) for _ in range(kinds))
        self.scores = nn.Sequential(nn.Dropout(0.3), nn.Linear(2 * WIDTH, categories))

    def forward(self, cuts: Tensor, relations: Tensor, kind: Tensor) -> Tensor:
        """Each thing hears the most that any of its relations tells it."""
        looks = torch.relu(self.looks(cuts))
        heard = torch.zeros_like(looks)
        for number, told in enumerate(self.told):
            source, target = relations[:, kind == number]
            said = torch.relu(told(looks[source]))
            to = target[:, None].expand_as(said)
            heard = heard.scatter_reduce(0, to, said, "amax")
        return self.scores(torch.cat([looks, heard], dim=1))


def loaded(data: PictureDataset, kinds: list[str], place: int) -> list[Tensor]:
    """Of a picture the cut-outs, the categories, and the relations of its things both ways with their kinds."""
    record = data[place]
    graph, number, instance = record["graph"], record["number"], record["instance"]
    seen = torch.cat([record["picture"] / 255, (1 / record["depth"])[None].nan_to_num(posinf=0).clamp(0, 2)])
    cuts = []
    for each in number[number > 0]:
        mask = instance == each
        lines, columns = (torch.nonzero(mask.any(dim=axis)).flatten() for axis in (1, 0))
        cut = torch.cat([seen * mask, mask[None]])[:, lines[0] : lines[-1] + 1, columns[0] : columns[-1] + 1]
        cuts.append(functional.interpolate(cut[None], (SIDE, SIDE), mode="area")[0])
    pairs = [graph["entity", kind, "entity"].edge_index for kind in kinds]
    kind = torch.cat([torch.full((found.shape[1],), at) for at, found in enumerate(pairs)])
    relations, own = torch.cat(pairs, dim=1), (number > 0)
    kept, to = own[relations].all(dim=0), own.cumsum(0) - 1
    relations, kind = to[relations[:, kept]], kind[kept]
    both = torch.cat([relations, relations.flip(0)], dim=1)
    return [torch.stack(cuts), graph["entity"].category[own].long(), both, torch.cat([kind, kind + len(kinds)])]


def joined(pictures: list[list[Tensor]]) -> list[Tensor]:
    """Several pictures as one."""
    counts = torch.tensor([0, *(len(cuts) for cuts, *_ in pictures)]).cumsum(0)
    shifted = [relations + shift for (_, _, relations, _), shift in zip(pictures, counts, strict=False)]
    cuts, category, _, kind = zip(*pictures, strict=True)
    return [torch.cat(cuts), torch.cat(category), torch.cat(shifted, dim=1), torch.cat(kind)]


def share_right(train: list[list[Tensor]], test: list[Tensor], kinds: int, categories: int, rounds: int) -> float:
    """Train, and tell of how many things in other pictures the category is found."""
    torch.manual_seed(0)
    network = Network(kinds, categories)
    optimizer = torch.optim.AdamW(network.parameters(), 2e-3, weight_decay=1e-2)
    for _ in range(rounds):
        for some in torch.randperm(len(train)).split(TOGETHER):
            cuts, category, *relations = joined([train[place] for place in some])
            loss = functional.cross_entropy(network(cuts, *relations), category)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
    network.eval()
    cuts, category, *relations = test
    with torch.no_grad():
        return float((network(cuts, *relations).argmax(dim=1) == category).float().mean())


def main() -> None:
    """Train without the scenegraph and with it, and say how well each does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="what unisg render has made")
    parser.add_argument("--rounds", type=int, default=12, help="through all pictures")
    args = parser.parse_args()
    data = PictureDataset(args.folder)
    names, kinds = data.graphs.vocabulary["categories"], list(data.graphs.vocabulary["relations"])
    pictures = [loaded(data, kinds, place) for place in range(len(data))]
    first = len(pictures) * 4 // 5  # whole rooms are left out: their pictures follow one another
    train, test = pictures[:first], joined(pictures[first:])
    usual = torch.cat([category for _, category, *_ in train]).mode().values
    bare, none = torch.zeros(2, 0, dtype=torch.long), torch.zeros(0, dtype=torch.long)
    without = [[cuts, category, bare, none] for cuts, category, *_ in train]
    by_looks = share_right(without, [*test[:2], bare, none], 2 * len(kinds), len(names), args.rounds)
    by_both = share_right(train, test, 2 * len(kinds), len(names), args.rounds)
    print(f"of {len(test[1])} things in rooms left out, of {len(names)} categories, it tells right {by_looks:.0%} by "
          f"their looks, {by_both:.0%} with the scenegraph; {names[usual]} each time would be right for "
          f"{(test[1] == usual).float().mean():.0%}")  # fmt: skip


if __name__ == "__main__":
    main()
