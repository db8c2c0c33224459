#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""polyfit_numpy.py: what BM_FitPolynomials of stbrdf_bench.cpp does, in one call of numpy.polyfit a degree."""

import time

import numpy

times = numpy.linspace(0, 1, 33)
samples = numpy.random.default_rng(1).random((33, 512 * 512 * 5), dtype=numpy.float32)
for degree in (3, 4, 5):
    began = time.perf_counter()
    used = time.process_time()
    numpy.polyfit(times, samples, degree)
    print(f"degree {degree}: {time.perf_counter() - began:.3f} s, {time.process_time() - used:.3f} s of CPU")
