# Switches the import of parallax maps on and off with the plug-in.
@tool
extends EditorPlugin

var _import: GLTFDocumentExtension


func _enter_tree() -> void:
	_import = preload("import.gd").new()
	GLTFDocument.register_gltf_document_extension(_import)


func _exit_tree() -> void:
	GLTFDocument.unregister_gltf_document_extension(_import)
	_import = null
