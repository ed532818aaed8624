#!/usr/bin/env python3
"""Whether two evaluators of the same pair agree.

    agree.py OURS.json OTHER.json

OURS is written by `parbake eval --json`, OTHER by the independent evaluator.
Allowed are 0.1 dB of PSNR and 0.003 of MS-SSIM. Prints both and exits 1 where
they differ by more.
"""

import json
import sys

ALLOWED = {"psnr": 0.1, "ms_ssim": 0.003}


def find(tree, name):
    """The first number of this name, nearest to the root."""
    level = [tree]
    while level:
        below = []
        for node in level:
            if isinstance(node, dict):
                if isinstance(node.get(name), (int, float)):
                    return float(node[name])
                below += node.values()
        level = below
    sys.exit(f"no {name} in the report")


def main(ours, other):
    with open(ours) as a, open(other) as b:
        ours, other = json.load(a)["mean"], json.load(b)
    agree = True
    for name, allowed in ALLOWED.items():
        mine, theirs = find(ours, name), find(other, name)
        fine = abs(mine - theirs) <= allowed
        agree &= fine
        print(f"{name}: {mine:.4f} here, {theirs:.4f} there, {allowed} allowed: {'ok' if fine else 'NOT EQUAL'}")
    return 0 if agree else 1


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
