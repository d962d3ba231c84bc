"""Plays a PC2 cache on an exported OBJ in Blender and compares one frame with the OBJ exported for that moment.

By hand, since Blender is no dependency:

    risorius export HEAD -o rest.obj
    risorius export HEAD --clip CLIP --at 1.6 -o moment.obj
    risorius render HEAD --clip CLIP -o clip.pc2
    blender -b -P tests/blender/check_cache.py -- rest.obj clip.pc2 96 moment.obj      # frame 96 = 1.6 s at 60 a second
"""
import os
import sys

import bpy

LIMIT_MM = 1e-4

rest, cache, frame, moment = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.obj(filepath=os.path.abspath(rest), axis_forward="Y", axis_up="Z", split_mode="OFF")
head = bpy.context.selected_objects[0]
modifier = head.modifiers.new("cache", "MESH_CACHE")
modifier.cache_format = "PC2"
modifier.filepath = os.path.abspath(cache)
modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"
modifier.frame_start = 0
bpy.context.scene.frame_start = 0


def positions(at):
    bpy.context.scene.frame_set(at)
    mesh = head.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    return [tuple(v.co) for v in mesh.vertices]


def distance(a, b):
    return max(abs(x - y) for p, q in zip(a, b) for x, y in zip(p, q))


with open(moment) as f:
    wanted = [tuple(map(float, line.split()[1:4])) for line in f if line.startswith("v ")]
start, played = positions(0), positions(int(frame))
difference, motion = distance(played, wanted), distance(played, start)
print(f"{len(played)} vertices of {len(wanted)}: {difference:.3g} mm from the exported moment, "
      f"{motion:.3g} mm from frame 0")
sys.exit(0 if len(played) == len(wanted) and difference < LIMIT_MM < motion else 1)
