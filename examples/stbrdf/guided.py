#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What guides, --gradient, --tile and --mask do to an enlargement: guided.py SAMPLE_SET SIDE PICTURE [FOLDER]

The result is SIDE texels wide and high. Guide: rings; of the sample the rank of its mean colour at t = 0.5. Prints, of each
way to lead the result, the correlation of the guide at what is shown with the target's; the side of the copied region a
patch lies in (a square's, median over patches) and the largest one over the sample; how near cells of the sample of 16 and
of 4 texels are shown again, by copies(); also of a transfer to PICTURE's upper left SIDE x SIDE pixels. Then, across the
join of --tile, the mean step of Diffuse over that inside; and how many patches show a texel that --mask hides.
Run from the repository's root after make; PATINA names another program.
"""
import json
import os
import shutil
import subprocess
import sys

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
import cv2
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import pdist

sample_set, side, picture = sys.argv[1], int(sys.argv[2]), sys.argv[3]
folder = sys.argv[4] if len(sys.argv) > 4 else "out/stbrdf/guided"
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)
name = lambda file: f"{folder}/{file}"


def run(verb, arguments):
    """The verb's answer, Diffuse of the result [power][h][w][3], and the centres that are shown [h][w] (x, y)."""
    for old in (name("set"), name("nnf.npy")):
        shutil.rmtree(old, ignore_errors=True) if os.path.isdir(old) else os.path.exists(old) and os.remove(old)
    command = [os.environ.get("PATINA", "build/patina"), "stbrdf", verb, sample_set, *arguments, "--nnf", name("nnf.npy")]
    answer = json.loads(subprocess.run(command + ["--json"], check=True, capture_output=True).stdout)["items"][0]
    return answer, diffuse(name("set")), np.load(name("nnf.npy"))


def diffuse(of):
    count = sum(f.startswith("Diffuse-") for f in os.listdir(of))
    return [cv2.imread(f"{of}/Diffuse-{k}.exr", -1) for k in range(count)]


def enlarge(*options, size=side):
    return run("enlarge", [name("set"), "--size", f"{size}x{size}", *options])


colour = sum(c * 0.5**k for k, c in enumerate(diffuse(sample_set))).mean(-1)
rank = (colour.ravel().argsort().argsort() / colour.size).reshape(colour.shape).astype(np.float32)
y, x = np.mgrid[:side, :side]
rings = (0.5 + 0.5 * np.sin(np.hypot(x - side / 2, y - side / 2) * (2 * np.pi / 100))).astype(np.float32)
cv2.imwrite(name("rank.exr"), rank)
cv2.imwrite(name("rings.exr"), rings)


def regions(centres):
    """Which copied region each patch belongs to: connected, and the sample without a break."""
    height, width = centres.shape[:2]
    at = np.arange(height * width).reshape(height, width)
    across = (centres[:, 1:] - centres[:, :-1] == (1, 0)).all(-1)
    down = (centres[1:] - centres[:-1] == (0, 1)).all(-1)
    one, other = np.r_[at[:, 1:][across], at[1:][down]], np.r_[at[:, :-1][across], at[:-1][down]]
    return connected_components(coo_matrix((np.ones(len(one), bool), (one, other)), shape=(at.size, at.size)), directed=False)[1]


def copies(centres, cell):
    """Of cells of the sample that two copied regions or more show, three quarters of it each: their share, and over the
    sample's side the median distance of the nearest two and what a twentieth fall below."""
    of = regions(centres)
    place = (centres[..., 1] // cell * 4096 + centres[..., 0] // cell).astype(np.int64)
    keys, key, count = np.unique(place.ravel() * of.size + of, return_inverse=True, return_counts=True)
    y, x = np.mgrid[: centres.shape[0], : centres.shape[1]]
    middle = np.stack([np.bincount(key, a.ravel()) / count for a in (x, y)], -1)[count >= 0.75 * cell * cell]
    cells = keys[count >= 0.75 * cell * cell] // of.size
    groups = np.split(middle, np.flatnonzero(np.diff(cells)) + 1)
    near = [pdist(group).min() / colour.shape[0] for group in groups if len(group) > 1]
    share = len(near) / np.prod([-(-n // cell) for n in colour.shape])
    return f"{share:.2f} {np.median(near):.2f} {np.quantile(near, 0.05):.2f}" if near else "0.00    -    -"


def told(text, centres):
    size = np.bincount(regions(centres))
    there = np.corrcoef(rank[centres[..., 1], centres[..., 0]].ravel(), rings.ravel())[0, 1]
    typical = np.sqrt(np.median(np.repeat(size, size)))
    print(f"{text:23} {there:6.3f}  {typical:4.0f}  {size.max() / rank.size:6.3f}   {copies(centres, 16)}   {copies(centres, 4)}")


print("led by                  guide  copy: side, largest   cells of 16: share, apart   cells of 4")
for text, options in [("nothing", [])] + [
    (f"guide, weight {w}", ["--guide", f"{name('rank.exr')}:{name('rings.exr')}:{w}"]) for w in (0.01, 0.1, 1, 10)
] + [(f"--gradient {w}", ["--gradient", w]) for w in ("0.01", "0.1", "1")]:
    told(text, enlarge(*options)[2])
cv2.imwrite(name("picture.png"), cv2.imread(picture)[:side, :side])
for brightness in ("0.1", "4"):
    told(f"transfer, brightness {brightness}", run("transfer", [name("picture.png"), name("set"), "--brightness", brightness])[2])

_, result, _ = enlarge("--tile", size=side - 12)
step = lambda image, axis: np.abs(np.diff(image, axis=axis)).mean()
join = lambda image, axis: np.abs(image.take(0, axis) - image.take(-1, axis)).mean()
for text, axis in (("across", 1), ("down", 0)):
    ratios = [join(c, axis) / step(c, axis) for c in result]
    print(f"--tile: steps {text} the join over those inside, of each power of t:", "  ".join(f"{r:.2f}" for r in ratios))

hidden = np.zeros(rank.shape, np.uint8)
hidden[40:70, 90:150] = 1
cv2.imwrite(name("mask.png"), 255 * (1 - hidden))
_, _, centres = enlarge("--mask", name("mask.png"))
covered = cv2.dilate(hidden, np.ones((5, 5), np.uint8))
print("--mask:", int(covered[centres[..., 1], centres[..., 0]].sum()), "of", centres[..., 0].size, "patches show a texel of it")
