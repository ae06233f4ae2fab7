"""A hand that presses a ball end mill into a block and slides it: forces of the whole tool, and their error."""

import numpy as np

import touchoff

part = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm", points=50_000)
tool = touchoff.Tool.library("D2Ball")

time = np.linspace(0.0, 1.0, 1_000)
poses = np.zeros((len(time), 6))
poses[:, 0] = 10 * np.sin(2 * np.pi * time)
poses[:, 2] = -0.3 * np.sin(np.pi * time) ** 2
poses[:, 5] = 1

found = touchoff.wrench(tool, part, poses, law="gradient")
proved = touchoff.certified_depth(tool, part, poses)
error = np.maximum(found.depth - proved.high, proved.low - found.depth)
print(f"force up to {found.force[:, 2].max():.3f}, depth up to {found.depth.max():.4f} mm")
print(f"sampled depth is off the proved one by up to {error.max():.1e} mm")
