"""An action type of one's own, "Lift": the target is at least ``distance`` metres high, for ``hold`` seconds.

    unisg simulate scene.blend --rehearse --types examples/own_action_type.py

The file imports nothing of UniSG's, so that Blender loads it too: the button with the script in the panel *Actions*.
"""


def lift(batch, moment):
    """Which of K actions hold, bool (K,): ``moment.world`` (N, 4, 4) are the world matrices, metres."""
    return moment.world[batch.target, 2, 3] >= batch.distance


def raise_it(hand, batch):
    """How a rehearsal performs one: it raises the target and waits."""
    row = int(batch.target[0])
    goal = hand.world[row]
    goal[2, 3] = batch.distance[0]
    hand.move(row, goal)
    hand.wait(batch.hold[0] + 2 / hand.rate)


CONDITIONS = {"Lift": lift}
GESTURES = {"Lift": raise_it}
