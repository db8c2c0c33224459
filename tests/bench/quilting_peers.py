#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""quilting_peers.py [BENCH]: quilting's search and decomposition beside their peers, in one run of patina_bench and one of
numpy's linalg.svd on the same matrices; prints PASS or FAIL for each limit. Needs numpy and 400 MB in the temporary folder."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

TEXELS, FRAMES, RANK, SHARE = 65536, 500, 15, 64


def judged(ok):
    return "PASS" if ok else "FAIL"


def main():
    bench = sys.argv[1] if len(sys.argv) > 1 else "build/patina_bench"
    with tempfile.TemporaryDirectory() as folder:
        out = subprocess.run(
            [bench, "--benchmark_filter=BM_Placement|BM_SpecimenSvd", "--benchmark_format=json"],
            env=dict(os.environ, PATINA_BENCH_MATRICES=folder), stdout=subprocess.PIPE, check=True)
        rows = {}
        for row in json.loads(out.stdout)["benchmarks"]:
            rows.setdefault(row["label"], {})[row["name"].split("/")[0]] = row
        failed = False
        for specimen, found in rows.items():
            ours = found["BM_Placement"]["real_time"]
            template = found["BM_PlacementByMatchTemplate"]["real_time"]
            sequences = found["BM_PlacementBySequencesOfOneCornerIn64"]["real_time"] * SHARE
            ok = ours <= 0.5 and template >= 50 * ours and sequences >= 1000 * ours
            print(f"{specimen}: placement {ours:.3f} ms; matchTemplate {template:.1f} ms = {template / ours:.0f}x; "
                  f"500 frames {sequences:.0f} ms (from 1 corner in {SHARE}) = {sequences / ours:.0f}x {judged(ok)}")
            failed |= not ok

            svd = found["BM_SpecimenSvd"]
            matrix = numpy.fromfile(pathlib.Path(folder, specimen + ".f32"), numpy.float32).reshape(FRAMES, TEXELS).T
            began = time.perf_counter()
            peer = numpy.linalg.svd(matrix, full_matrices=False)[1]
            peer_ms = 1e3 * (time.perf_counter() - began)
            exact = numpy.sqrt(numpy.linalg.eigvalsh(matrix.T.astype(float) @ matrix.astype(float))[::-1][:RANK])
            error = max(abs(svd[f"s{k}"] - exact[k]) for k in range(RANK)) / exact[0]
            ms = svd["real_time"]
            ok = error <= 1e-4 and (ms <= 100 or peer_ms >= 30 * ms)
            print(f"{specimen}: decomposition {ms:.1f} ms; numpy {peer_ms:.0f} ms = {peer_ms / ms:.0f}x; error of singular "
                  f"values {error:.1e} of the first (numpy's {abs(peer[:RANK] - exact).max() / exact[0]:.1e}) {judged(ok)}")
            failed |= not ok
    return failed


if __name__ == "__main__":
    sys.exit(main())
