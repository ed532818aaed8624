# Bytes of a glTF file, read and added before Godot's importer parses it.
@tool
extends RefCounted

## Bytes of one number of an accessor, by its componentType.
const SIZES := {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5126: 4}
const FLOAT := 5126
const ARRAY_BUFFER := 34962


## The bytes of a buffer view.
static func view(state: GLTFState, index: int) -> PackedByteArray:
	var described: Dictionary = state.json.bufferViews[index]
	var start := int(described.get("byteOffset", 0))
	return _buffer(state, int(described.buffer)).slice(start, start + int(described.byteLength))


## The image of a texture; null if it cannot be read.
static func image(state: GLTFState, texture: int) -> Image:
	var textures: Array = state.json.get("textures", [])
	var images: Array = state.json.get("images", [])
	if texture < 0 or texture >= textures.size():
		return null
	var source := int(textures[texture].get("source", -1))
	if source < 0 or source >= images.size():
		return null
	if images[source].has("bufferView"):
		return _decoded(view(state, int(images[source].bufferView)))
	return _decoded(_file(state, images[source].get("uri", "")))


## The vectors of an accessor; none if they cannot be read.
static func vectors(state: GLTFState, index: int) -> PackedVector3Array:
	var accessor: Dictionary = state.json.accessors[index]
	var result := PackedVector3Array()
	var type := int(accessor.componentType)
	var can_read: bool = accessor.has("bufferView") and not accessor.has("sparse")
	if not can_read or accessor.type != "VEC3" or not SIZES.has(type):
		return result
	var described: Dictionary = state.json.bufferViews[int(accessor.bufferView)]
	var size: int = SIZES[type]
	var stride := int(described.get("byteStride", 3 * size))
	var start := int(accessor.get("byteOffset", 0))
	var count := int(accessor.count)
	var bytes := view(state, int(accessor.bufferView))
	if described.has("extensions") or start + (count - 1) * stride + 3 * size > bytes.size():
		return result
	var is_normalized: bool = accessor.get("normalized", false)
	for i in count:
		var at := start + i * stride
		result.append(Vector3(
				_number(bytes, at, type, is_normalized),
				_number(bytes, at + size, type, is_normalized),
				_number(bytes, at + 2 * size, type, is_normalized)))
	return result


## Adds an accessor of these vectors to the file, and returns its index. It has a buffer of its own,
## so that all other bytes stay as they are.
static func append(state: GLTFState, added: PackedVector3Array) -> int:
	# A PackedVector3Array has doubles in some builds of Godot.
	var numbers := PackedFloat32Array()
	for vector in added:
		for axis in 3:
			numbers.append(vector[axis])
	var bytes := numbers.to_byte_array()
	var json := state.json
	var uri := "data:application/octet-stream;base64," + Marshalls.raw_to_base64(bytes)
	json.buffers.append({"byteLength": bytes.size(), "uri": uri})
	json.bufferViews.append({
		"buffer": json.buffers.size() - 1,
		"byteLength": bytes.size(),
		"target": ARRAY_BUFFER,
	})
	json.accessors.append({
		"bufferView": json.bufferViews.size() - 1,
		"componentType": FLOAT,
		"count": added.size(),
		"type": "VEC3",
	})
	return json.accessors.size() - 1


static func _number(bytes: PackedByteArray, at: int, type: int, is_normalized: bool) -> float:
	var number := 0.0
	var greatest := 1.0
	match type:
		5120:
			number = bytes.decode_s8(at)
			greatest = 127.0
		5121:
			number = bytes.decode_u8(at)
			greatest = 255.0
		5122:
			number = bytes.decode_s16(at)
			greatest = 32767.0
		5123:
			number = bytes.decode_u16(at)
			greatest = 65535.0
		FLOAT:
			return bytes.decode_float(at)
	return maxf(number / greatest, -1.0) if is_normalized else number


static func _buffer(state: GLTFState, index: int) -> PackedByteArray:
	var uri: String = state.json.buffers[index].get("uri", "")
	return state.glb_data if uri.is_empty() else _file(state, uri)


static func _file(state: GLTFState, uri: String) -> PackedByteArray:
	if uri.begins_with("data:"):
		return Marshalls.base64_to_raw(uri.get_slice(",", 1))
	return FileAccess.get_file_as_bytes(state.base_path.path_join(uri.uri_decode()))


# PNG, JPEG or WebP, told apart by their first bytes.
static func _decoded(bytes: PackedByteArray) -> Image:
	if bytes.size() < 12:
		return null
	var decoded := Image.new()
	var error := ERR_FILE_UNRECOGNIZED
	if bytes[0] == 0x89:
		error = decoded.load_png_from_buffer(bytes)
	elif bytes[0] == 0xff:
		error = decoded.load_jpg_from_buffer(bytes)
	elif bytes[0] == 0x52:
		error = decoded.load_webp_from_buffer(bytes)
	return decoded if error == OK else null
