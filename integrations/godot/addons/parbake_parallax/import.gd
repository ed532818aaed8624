# Reads PARBAKE_materials_parallax while a glTF file is imported, and gives the meshes materials
# with the parallax shader. A game that loads files itself registers it as plugin.gd does.
@tool
extends GLTFDocumentExtension

const ParallaxMap := preload("parallax_map.gd")
const FOLDER := "res://addons/parbake_parallax"

var _shaders := {}


func _import_preflight(_state: GLTFState, extensions: PackedStringArray) -> Error:
	return OK if extensions.has(ParallaxMap.NAME) else ERR_SKIP


func _get_supported_extensions() -> PackedStringArray:
	return [ParallaxMap.NAME]


func _import_post_parse(state: GLTFState) -> Error:
	var materials: Array[Material] = state.get_materials()
	var made := {}
	var described: Array = state.json.get("materials", [])
	for i in mini(described.size(), materials.size()):
		var json: Variant = described[i].get("extensions", {}).get(ParallaxMap.NAME)
		if json is Dictionary:
			var reason := ParallaxMap.fault(json)
			var result: Variant = reason
			if reason.is_empty():
				result = _made(state, json, materials[i] as BaseMaterial3D)
			if result is Material:
				made[materials[i]] = result
				materials[i] = result
			else:
				push_warning("The parallax map of material \"%s\" was left out: %s."
						% [described[i].get("name", ""), result])
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


# The material with the map, or a sentence that says why there is none.
func _made(state: GLTFState, json: Dictionary, from: BaseMaterial3D) -> Variant:
	if from == null:
		return "the material is not one of Godot's own"
	if from.shading_mode == BaseMaterial3D.SHADING_MODE_UNSHADED:
		return "the material is not lit, and this reads lit ones"
	var albedo_texture := _texture(state, json.get("baseColorTexture"), from.albedo_texture)
	var normal_texture := _texture(state, json.get("normalTexture"), from.normal_texture)
	if albedo_texture == null and normal_texture == null:
		return "there is neither a base colour nor a normal texture to shift"
	var images := {"shift_map": _data_texture(state, json.texture, ParallaxMap.SHIFT_LAYERS)}
	if json.has("cutout"):
		images["cutout_map"] = _data_texture(state, json.cutout.texture, ParallaxMap.CUTOUT_LAYERS)
	if images.values().has(null):
		return "an image of it cannot be read"

	var material := ShaderMaterial.new()
	material.resource_name = from.resource_name
	material.shader = _shader(from, json.has("cutout"))
	material.render_priority = from.render_priority
	ParallaxMap.set_numbers(material, json)
	for parameter: String in images:
		material.set_shader_parameter(parameter, images[parameter])
	_set_material(material, from)
	material.set_shader_parameter("albedo_texture", albedo_texture)
	material.set_shader_parameter("normal_texture", normal_texture)
	material.set_shader_parameter("normal_scale", from.normal_scale if normal_texture else 0.0)
	return material


# What glTF's material says, as Godot's own importer has read it.
func _set_material(material: ShaderMaterial, from: BaseMaterial3D) -> void:
	var is_mask := from.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
	var parameters := {
		"uv_scale": Vector2(from.uv1_scale.x, from.uv1_scale.y),
		"uv_offset": Vector2(from.uv1_offset.x, from.uv1_offset.y),
		"albedo": from.albedo_color,
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


# A texture of the extension's own, instead of the material's.
func _texture(state: GLTFState, info: Variant, otherwise: Texture2D) -> Texture2D:
	if not info is Dictionary or not info.has("index"):
		return otherwise
	var textures := state.get_textures()
	var images := state.get_images()
	var index := int(info.index)
	if index < 0 or index >= textures.size():
		return otherwise
	var image: int = textures[index].src_image
	return images[image] if image >= 0 and image < images.size() else otherwise


# An image of numbers. It is read from the file, since Godot's importer may compress what it takes
# for a picture.
func _data_texture(state: GLTFState, info: Dictionary, layers: int) -> ImageTexture:
	var textures: Array = state.json.get("textures", [])
	var described: Array = state.json.get("images", [])
	var index := int(info.index)
	if index >= textures.size() or not textures[index].has("source"):
		return null
	var source := int(textures[index].source)
	if source < 0 or source >= described.size():
		return null
	var image := _decoded(_bytes(state, described[source]))
	if image == null or image.get_height() % layers != 0:
		return null
	image.convert(Image.FORMAT_RGBA8)
	return ImageTexture.create_from_image(image)


func _bytes(state: GLTFState, described: Dictionary) -> PackedByteArray:
	if described.has("bufferView"):
		var view: GLTFBufferView = state.get_buffer_views()[int(described.bufferView)]
		var buffer: PackedByteArray = state.get_buffers()[view.buffer]
		return buffer.slice(view.byte_offset, view.byte_offset + view.byte_length)
	var uri: String = described.get("uri", "")
	if uri.begins_with("data:"):
		return Marshalls.base64_to_raw(uri.get_slice(",", 1))
	return FileAccess.get_file_as_bytes(state.base_path.path_join(uri.uri_decode()))


# PNG, JPEG or WebP, told apart by their first bytes.
func _decoded(bytes: PackedByteArray) -> Image:
	if bytes.size() < 12:
		return null
	var image := Image.new()
	var error := ERR_FILE_UNRECOGNIZED
	if bytes[0] == 0x89:
		error = image.load_png_from_buffer(bytes)
	elif bytes[0] == 0xff:
		error = image.load_jpg_from_buffer(bytes)
	elif bytes[0] == 0x52:
		error = image.load_webp_from_buffer(bytes)
	return image if error == OK else null
