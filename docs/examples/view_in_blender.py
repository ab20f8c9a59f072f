# SPDX-License-Identifier: Apache-2.0
"""Saves a scene-linear picture with a view of the config.

    OCIO=my_config/config.ocio blender --background --python view_in_blender.py -- render.exr "Soft Reinhard" out.png
"""

import sys
from pathlib import Path

import bpy

picture, view, saved = sys.argv[-3:]
scene = bpy.context.scene
scene.view_settings.view_transform = view
scene.render.dither_intensity = 0
settings = scene.render.image_settings
settings.file_format, settings.color_mode = "PNG", "RGB"
bpy.data.images.load(str(Path(picture).resolve())).save_render(str(Path(saved).resolve()), scene=scene)
