"""A final picture in ten lines: a fisheye's, lit from all around and with shadows, the mean of 8 samples; and one that
is larger than memory should be, written strip by strip. Usage: final_picture.py SCENE FOLDER"""

import sys

import conic

scene, folder = conic.open(sys.argv[1]), sys.argv[2]
picture = conic.render(scene, size=(200, 200), projection="fisheye", fov=150, ao=8, shadow=True, accumulate=8)
picture.save(f"{folder}/final.exr")
again = conic.render(scene, picture.shot)  # the same numbers, the same bits
assert again.statistics["hash"] == picture.statistics["hash"]
conic.render(scene, size=(1200, 900), samples=1, output=f"{folder}/strips.exr", in_memory=False, memory=16)
print(picture.hash())
