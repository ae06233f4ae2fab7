"""Sweep all parts of a folder (`parts/*.stl`, in mm) with the built-in tools that are named, on a cluster of Ray:
python sweep.py FOLDER [TOOL …]"""

import sys
from pathlib import Path

import ray
import touchoff
import touchoff.distributed


def main(folder: str, *names: str) -> None:
    root = Path(folder)
    ray.init()
    parts = {file.stem: touchoff.Part.read(file, unit="mm") for file in sorted((root / "parts").glob("*.stl"))}
    if not parts:
        raise SystemExit(f"{root / 'parts'} has no .stl file")
    tools = [touchoff.Tool.library(name) for name in names or ("D2Ball", "BallEr16")]
    touchoff.distributed.sweep(
        parts,
        tools,
        folder=root / "tables",
        directions=50,
        progress=lambda done, total: print(f"{done} of {total} shards", flush=True),
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
