# SPDX-License-Identifier: Apache-2.0
"""The script that `tonewright shader --for godot` writes, in Godot's renderer Forward+ on a virtual screen.

    TONEWRIGHT_GODOT=/path/to/godot python3 -m pytest tests/shader/test_godot.py --tonewright build/release/bin/tonewright

TONEWRIGHT_GODOT is Godot 4.4 or later, with a driver of Vulkan; a program `godot4` serves, too.
"""

import os
import shutil
import subprocess

import numpy as np
from executed import bound_in_application, reference
from pictures import need_program, skip

# Script -> operator and options: ACES 2.0 with its tables as arrays, and in a texture of 32-bit floats.
SCRIPTS = {operator: (operator, []) for operator in ("agx_blender", "aces_20", "aces_13", "khronos_neutral", "gt7")}
SCRIPTS["aces_20_texture"] = "aces_20", ["--tables", "texture"]
SIZE = 64
STOPS = 0.5
PROJECT = """config_version=5
[application]
run/main_scene="res://main.tscn"
[rendering]
renderer/rendering_method="forward_plus"
"""
SCENE = """[gd_scene load_steps=2 format=3]
[ext_resource type="Script" path="res://main.gd" id="1"]
[node name="Main" type="Node3D"]
script = ExtResource("1")
"""
# Without a script for the light itself, as Godot's buffer has it; then with each.
MAIN = """extends Node3D
func _ready() -> void:
	var image := Image.create_from_data(SIZE, SIZE, false, Image.FORMAT_RGBAF, FileAccess.get_file_as_bytes("res://light.bin"))
	var viewport := SubViewport.new()
	viewport.size = Vector2i(SIZE, SIZE)
	viewport.use_hdr_2d = true
	viewport.own_world_3d = true
	viewport.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	add_child(viewport)
	var camera := Camera3D.new()
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL
	camera.size = 2.0
	camera.position.z = 1.0
	viewport.add_child(camera)
	var quad := MeshInstance3D.new()
	quad.mesh = QuadMesh.new()
	quad.mesh.size = Vector2(2, 2)
	var shader := Shader.new()
	shader.code = "shader_type spatial; render_mode unshaded; uniform sampler2D light : filter_nearest;" + \\
			"void fragment() { ALBEDO = texelFetch(light, ivec2(FRAGCOORD.xy), 0).rgb; }"
	quad.material_override = ShaderMaterial.new()
	quad.material_override.shader = shader
	quad.material_override.set_shader_parameter("light", ImageTexture.create_from_image(image))
	viewport.add_child(quad)
	var world := WorldEnvironment.new()
	world.environment = Environment.new()
	viewport.add_child(world)
	for name in NAMES:
		if name != "light":
			var effect = load("res://%s.gd" % name).new()
			effect.exposure = STOPS
			camera.compositor = Compositor.new()
			camera.compositor.compositor_effects = [effect]
		for i in 4:
			await RenderingServer.frame_post_draw
		var shown := viewport.get_texture().get_image()
		shown.convert(Image.FORMAT_RGBAF)
		FileAccess.open("res://%s.out" % name, FileAccess.WRITE).store_buffer(shown.get_data())
	get_tree().quit()
"""


def encoded(light: np.ndarray) -> np.ndarray:
    light = np.clip(light, 0, 1)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def test_godot(report, command, scratch):
    godot = os.environ.get("TONEWRIGHT_GODOT") or shutil.which("godot4")
    if not godot:
        skip("Godot 4 is missing; TONEWRIGHT_GODOT is not set")
    need_program("xvfb-run", "xvfb")
    light = np.ones((SIZE * SIZE, 4), "<f4")
    light[:, :3] = 2.0 ** np.random.default_rng(3).uniform(-10, 8, (SIZE * SIZE, 3))
    light[:SIZE, :3] = (0.18 * 2.0 ** np.linspace(-10, 10, SIZE))[:, None]
    light[SIZE:2 * SIZE, 1:3] = 0
    light.tofile(scratch / "light.bin")
    (scratch / "project.godot").write_text(PROJECT)
    (scratch / "main.tscn").write_text(SCENE)
    text = MAIN.replace("SIZE", str(SIZE)).replace("STOPS", str(STOPS)).replace("NAMES", str(["light", *SCRIPTS]))
    (scratch / "main.gd").write_text(text)
    for script, (operator, options) in SCRIPTS.items():
        subprocess.run([command, "shader", operator, "--for", "godot", "--uniforms", "exposure", "-o",
                        str(scratch / f"{script}.gd"), "-q", *options], check=True)
    done = subprocess.run(["xvfb-run", "-a", godot, "--path", str(scratch), "--rendering-driver", "vulkan", "--audio-driver", "Dummy"],
                          capture_output=True, text=True, timeout=300, check=False)
    if not report.check("Godot runs without an error", done.returncode == 0 and "ERROR" not in done.stderr, done.stderr):
        return
    print(done.stdout.splitlines()[0])
    pixels = {name: np.fromfile(scratch / f"{name}.out", "<f4").reshape(-1, 4)[:, :3] for name in ["light", *SCRIPTS]}
    report.check("the light is in Godot's buffer", np.allclose(pixels["light"], light[:, :3], rtol=2**-10))
    for script, (operator, _) in SCRIPTS.items():
        right = reference(command, operator, pixels["light"], "--display", "linear", "--exposure", str(STOPS))
        error = np.abs(encoded(pixels[script]) - encoded(right)).max()
        # Godot's buffer has half floats: 2^-11 of the light at most, of which sRGB's curve takes less than a half.
        report.bound(script, error, bound_in_application(operator) + 2**-11)
