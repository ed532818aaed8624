# The JSON of PARBAKE_materials_parallax, version 2: read and checked. A map that breaks a rule is
# left out as a whole.
@tool
extends RefCounted

const NAME := "PARBAKE_materials_parallax"
const VERSION := 2
const SHIFT_LAYERS := 2
const CUTOUT_LAYERS := 3
## What a file without a fade has: more than any pixel spans.
const NO_FADE := 1e10


## Why a map is to be left out; empty if it keeps all rules.
static func fault(json: Dictionary) -> String:
	if not _is_number(json.get("version")) or json.version != VERSION:
		return "its version is %s, and this reads version %d" % [json.get("version"), VERSION]
	var reason := _fault_of_part(json, SHIFT_LAYERS)
	if reason.is_empty() and json.has("cutout"):
		var cutout: Variant = json.cutout
		if not cutout is Dictionary:
			return "its cutout is no object"
		reason = _fault_of_part(cutout, CUTOUT_LAYERS)
	if not reason.is_empty():
		return reason
	var limit: Variant = json.get("limit", 0.25)
	if not _is_number(limit) or limit <= 0.0 or limit > 1.0:
		return "its limit is %s" % limit
	var footprint: Variant = json.get("fadeFootprint", NO_FADE)
	if not _is_number(footprint) or footprint <= 0.0:
		return "its fade begins at %s" % footprint
	return ""


## Gives a material the numbers of a map that keeps all rules.
static func set_numbers(material: ShaderMaterial, json: Dictionary) -> void:
	_set_ranges(material, "shift", json, SHIFT_LAYERS)
	if json.has("cutout"):
		_set_ranges(material, "cutout", json.cutout, CUTOUT_LAYERS)
	material.set_shader_parameter("limit", float(json.get("limit", 0.25)))
	material.set_shader_parameter("fade_footprint", float(json.get("fadeFootprint", NO_FADE)))


static func _set_ranges(
		material: ShaderMaterial, prefix: String, part: Dictionary, layers: int) -> void:
	for key: String in ["scale", "offset"]:
		for i in layers:
			var list: Array = part[key].slice(4 * i, 4 * i + 4)
			material.set_shader_parameter(
					"%s_%s_%d" % [prefix, key, i], Vector4(list[0], list[1], list[2], list[3]))


static func _fault_of_part(part: Dictionary, layers: int) -> String:
	var texture: Variant = part.get("texture")
	if not texture is Dictionary or not _is_number(texture.get("index")) or texture.index < 0:
		return "a texture of it is missing"
	for key: String in ["scale", "offset"]:
		var list: Variant = part.get(key)
		var wrong := "it has not %d scales and offsets" % (4 * layers)
		if not list is Array or list.size() != 4 * layers:
			return wrong
		for number: Variant in list:
			if not _is_number(number):
				return wrong
	return ""


static func _is_number(value: Variant) -> bool:
	return (value is float or value is int) and is_finite(value)
