#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whose detail a transfer shows: transfer_detail.py SAMPLE_SET PICTURE RESULT_SET NNF.npy

Detail is the difference to the 5x5 mean, of Diffuse. Correlations of it at five times: of the result with the picture
("kept") and with the sample's patches pasted there ("foreign"); the same of Gu's scaling (each texel of the picture times
what the sample's texel there has changed by, at most 1000); and of the sample with itself at 0 ("own"): what this
material keeps of its own ground. Results are clipped to [0,1]; "clipped" is the share of samples that were outside. Sample and picture of one size; the transfer's time is 0.
"""
import os
import sys

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
import cv2
import numpy as np
import scipy.ndimage as nd

sample_set, picture, result_set, nnf = sys.argv[1:]


def diffuse(folder, time):
    powers = [f for f in os.listdir(folder) if f.startswith("Diffuse-")]
    read = lambda k: cv2.imread(f"{folder}/Diffuse-{k}.exr", -1).astype(np.float64)
    return sum(read(k) * time**k for k in range(len(powers)))


def pasted(image):
    total, count = np.zeros_like(image), np.zeros(image.shape[:2] + (1,))
    height, width = image.shape[:2]
    y, x = np.mgrid[:height, :width]
    for dy in range(-2, 3):
        for dx in range(-2, 3):
            there = (y + dy >= 0) & (y + dy < height) & (x + dx >= 0) & (x + dx < width)
            centre = centres[np.clip(y + dy, 0, height - 1), np.clip(x + dx, 0, width - 1)]
            total += image[centre[..., 1] - dy, centre[..., 0] - dx] * there[..., None]
            count += there[..., None]
    return total / count


def alike(a, b):
    a, b = (i - nd.uniform_filter(i, (5, 5, 1), mode="nearest") for i in (a, b))
    return (a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum())


centres = np.load(nnf)
encoded = cv2.imread(picture)[: centres.shape[0], : centres.shape[1]] / 255.0
wanted = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
first = diffuse(sample_set, 0)
print("time   kept foreign clipped   Gu: kept foreign clipped    own")
for time in (0, 0.25, 0.5, 0.75, 1):
    sample, result = diffuse(sample_set, time), diffuse(result_set, time)
    gu = wanted * np.clip(sample / np.maximum(first, 1e-3), 0, 1000)
    outside = [(np.clip(i, 0, 1) != i).mean() for i in (result, gu)]
    result, gu = np.clip(result, 0, 1), np.clip(gu, 0, 1)
    print(f"{time:4}  {alike(result, wanted):5.3f}  {alike(result, pasted(sample)):6.3f}   {outside[0]:5.3f}"
          f"      {alike(gu, wanted):5.3f}  {alike(gu, sample):6.3f}   {outside[1]:5.3f}  {alike(sample, first):5.3f}")
