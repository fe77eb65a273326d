#!/usr/bin/env python3
"""End states of scenes by the native library: native.py NAME PARAMETERS ...; prints a JSON list (see scenes.mjs)."""
import json
import sys
import time

try:
    import supercircle as sc
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

ends = []
for name, parameters in zip(sys.argv[1::2], sys.argv[2::2]):
    start = time.process_time()
    with sc.World.for_scene(name) as world, world.load(name, **json.loads(parameters)) as scene:
        steps = 0
        while not scene.finished and steps < 100000:
            scene.step(1 / 60)
            steps += 1
        bodies = [float(x) for body in world.bodies() for x in (*body.state.centre, body.state.angle)]
        ends.append({"hash": format(world.hash, "x"), "steps": steps, "bodies": bodies,
                     "cpu_s": time.process_time() - start})
print(json.dumps(ends))
