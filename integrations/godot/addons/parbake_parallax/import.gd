# Reads PARBAKE_materials_parallax while a glTF file is imported, and gives the meshes materials
# with the parallax shader. A game that loads files itself registers it as plugin.gd does.
@tool
extends GLTFDocumentExtension

const GltfBytes := preload("gltf_bytes.gd")
const ParallaxMap := preload("parallax_map.gd")
const ParallaxVertices := preload("parallax_vertices.gd")
const FOLDER := "res://addons/parbake_parallax"

var _shaders := {}


func _get_supported_extensions() -> PackedStringArray:
	return [ParallaxMap.NAME]


# Before Godot parses the file: what it is to read from other places than it would.
func _import_preflight(state: GLTFState, extensions: PackedStringArray) -> Error:
	if not extensions.has(ParallaxMap.NAME):
		return ERR_SKIP
	var maps := {}
	var described: Array = state.json.get("materials", [])
	for i in described.size():
		var json: Variant = described[i].get("extensions", {}).get(ParallaxMap.NAME)
		if json is Dictionary:
			var map: Variant = _map(state, described[i], json)
			if map is Dictionary:
				maps[i] = map
				_put_textures(described[i], json)
			else:
				push_warning("The parallax map of material \"%s\" was left out: %s."
						% [described[i].get("name", ""), map])
	# Without its map a material's primitives stay where they are.
	ParallaxVertices.move(state, maps)
	state.set_additional_data(ParallaxMap.NAME, maps)
	return OK


func _import_post_parse(state: GLTFState) -> Error:
	var maps: Dictionary = state.get_additional_data(ParallaxMap.NAME)
	var materials: Array[Material] = state.get_materials()
	var made := {}
	for i: int in maps:
		if i >= materials.size():
			# Godot was told to import no materials.
			break
		var from := materials[i] as BaseMaterial3D
		if from == null:
			push_warning("The parallax map of material \"%s\" was left out: it is not one of Godot's own."
					% materials[i].resource_name)
			continue
		made[from] = _made(maps[i], from)
		materials[i] = made[from]
	state.set_materials(materials)
	# Meshes have their materials by now.
	for gltf_mesh: GLTFMesh in state.get_meshes():
		var mesh := gltf_mesh.mesh
		for surface in mesh.get_surface_count():
			var before := mesh.get_surface_material(surface)
			if made.has(before):
				mesh.set_surface_material(surface, made[before])
		var instance_materials: Array[Material] = []
		for before: Material in gltf_mesh.instance_materials:
			instance_materials.append(made.get(before, before))
		gltf_mesh.instance_materials = instance_materials
	return OK


# The map's JSON and textures, or a sentence that says why there is none.
func _map(state: GLTFState, described: Dictionary, json: Dictionary) -> Variant:
	var reason := ParallaxMap.fault(json)
	if not reason.is_empty():
		return reason
	if described.get("extensions", {}).has("KHR_materials_unlit"):
		return "the material is not lit, and this reads lit ones"
	var has_color: bool = described.get("pbrMetallicRoughness", {}).has("baseColorTexture")
	var has_any: bool = has_color or described.has("normalTexture")
	if not has_any and not json.has("baseColorTexture") and not json.has("normalTexture"):
		return "there is neither a base colour nor a normal texture to shift"
	var textures := {"shift_map": _data_texture(state, json.texture, ParallaxMap.SHIFT_LAYERS)}
	if json.has("cutout"):
		textures["cutout_map"] = _data_texture(state, json.cutout.texture, ParallaxMap.CUTOUT_LAYERS)
	if textures.values().has(null):
		return "an image of it cannot be read"
	return {"json": json, "textures": textures}


# The extension's textures take the place of the material's, which are for viewers that do not know
# it: so Godot reads them, as colours and as normals.
func _put_textures(described: Dictionary, json: Dictionary) -> void:
	if json.has("baseColorTexture"):
		if not described.has("pbrMetallicRoughness"):
			described["pbrMetallicRoughness"] = {}
		described.pbrMetallicRoughness["baseColorTexture"] = json.baseColorTexture
	if json.has("normalTexture"):
		var normal: Dictionary = json.normalTexture.duplicate()
		# The strength stays that of the material.
		normal["scale"] = described.get("normalTexture", {}).get("scale", 1.0)
		described["normalTexture"] = normal


func _made(map: Dictionary, from: BaseMaterial3D) -> ShaderMaterial:
	var json: Dictionary = map.json
	var material := ShaderMaterial.new()
	material.resource_name = from.resource_name
	material.shader = _shader(from, json.has("cutout"))
	material.render_priority = from.render_priority
	ParallaxMap.set_numbers(material, json)
	for parameter: String in map.textures:
		material.set_shader_parameter(parameter, map.textures[parameter])
	_set_material(material, from)
	return material


# What glTF's material says, as Godot's own importer has read it.
func _set_material(material: ShaderMaterial, from: BaseMaterial3D) -> void:
	var is_mask := from.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
	var parameters := {
		"uv_scale": Vector2(from.uv1_scale.x, from.uv1_scale.y),
		"uv_offset": Vector2(from.uv1_offset.x, from.uv1_offset.y),
		"albedo": from.albedo_color,
		"albedo_texture": from.albedo_texture,
		"normal_texture": from.normal_texture,
		"normal_scale": from.normal_scale if from.normal_texture else 0.0,
		"alpha_cutoff": from.alpha_scissor_threshold if is_mask else 0.0,
		"metallic": from.metallic,
		"metallic_texture": from.metallic_texture,
		"roughness": from.roughness,
		"roughness_texture": from.roughness_texture,
		"emission": from.emission if from.emission_enabled else Color.BLACK,
		"emission_energy": from.emission_energy_multiplier,
		"emission_texture": from.emission_texture,
		"occlusion_texture": from.ao_texture if from.ao_enabled else null,
	}
	for parameter: String in parameters:
		material.set_shader_parameter(parameter, parameters[parameter])


# parallax.gdshader, for this kind of material.
func _shader(from: BaseMaterial3D, has_cutout: bool) -> Shader:
	var is_blend := from.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA
	var culls := from.cull_mode != BaseMaterial3D.CULL_DISABLED
	var key := [is_blend, culls, has_cutout]
	if not _shaders.has(key):
		var mode := "cull_back" if culls else "cull_disabled"
		var lines := ["shader_type spatial;", "render_mode %s;" % mode]
		if is_blend:
			lines.append("#define PARALLAX_BLEND")
		if has_cutout:
			lines.append("#define PARALLAX_CUTOUT")
		lines.append("#include \"%s/parallax_material.gdshaderinc\"" % FOLDER)
		var shader := Shader.new()
		shader.code = "\n".join(lines) + "\n"
		_shaders[key] = shader
	return _shaders[key]


# An image of numbers. It is read from the file, since Godot's importer may compress what it takes
# for a picture.
func _data_texture(state: GLTFState, info: Dictionary, layers: int) -> ImageTexture:
	var image := GltfBytes.image(state, int(info.index))
	if image == null or image.get_height() % layers != 0:
		return null
	image.convert(Image.FORMAT_RGBA8)
	return ImageTexture.create_from_image(image)
